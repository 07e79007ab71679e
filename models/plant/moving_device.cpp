#include "models/plant/moving_device.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "models/config/input_error.h"
#include "models/plant/linear_axis.h"

namespace hvp::plant {

namespace {

// Longest time that is carried on in one piece.
constexpr Picoseconds kPiece = 1'000'000'000;
constexpr Picoseconds kNever = std::numeric_limits<Picoseconds>::max();

Eigen::Index component(std::size_t i) { return static_cast<Eigen::Index>(i); }

}  // namespace

MovingDevice::MovingDevice(const Plant& plant)
    : friction_(plant.friction),
      weight_(plant.weight()),
      push_(plant.push),
      handle_share_(plant.structure ? plant.structure->handle_share : 0),
      pose_(plant.pose_of_mass()),
      joints_(plant.dynamics.joints),
      intended_(plant.intended),
      lets_go_(kNever),
      held_(plant.hand.has_value()) {
  if (held_ && plant.hand->lets_go_s > 0) lets_go_ = to_picoseconds(plant.hand->lets_go_s);
  std::array<LinearAxis::State, 3> states;
  for (std::size_t i = 0; i < 3; ++i) {
    axes_[i] = plant.axis(static_cast<int>(i));
    try {
      AxisSeries::steps(axes_[i], to_seconds(kPiece));
    } catch (const std::length_error& e) {
      throw InputError(pose_ ? "device.dynamics.inertia" : "device.dynamics.mass",
                       std::string("is too small: ") + e.what());
    }
    states[i].hand_x = intended_.start[component(i)];
    states[i].x = states[i].hand_x + plant.displaced[component(i)];
    states[i].handle_x = states[i].x;
  }
  carry_on(states);
  for (std::size_t i = 0; i < 3; ++i) {
    const Energy first = stored(i, anchor_.axes[i].at(0), anchor_.axes[i].drive_at(0));
    anchor_.energy.at_start += first.kinetic + first.springs;
  }
}

void MovingDevice::advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) {
  if (force != command_) {
    while (anchor_.until <= from) move_anchor(anchor_.until);
    command_ = force;
    move_anchor(from);
  }
  while (anchor_.until <= to) move_anchor(anchor_.until);
  reached_ = to;
}

TipState MovingDevice::state() const {
  TipState tip;
  const std::array<LinearAxis::State, 3> now = states(reached_);
  for (std::size_t i = 0; i < 3; ++i) {
    tip.position[component(i)] = now[i].x;
    tip.velocity[component(i)] = now[i].v;
  }
  return tip;
}

std::array<LinearAxis::State, 3> MovingDevice::states(Picoseconds time) const {
  std::array<LinearAxis::State, 3> states;
  for (std::size_t i = 0; i < 3; ++i) states[i] = anchor_.axes[i].at(since_anchor(time));
  return states;
}

PlantState MovingDevice::mechanics() const {
  PlantState now{.tip = state()};
  const std::array<LinearAxis::State, 3> axes = states(reached_);
  now.energy = flowed(reached_, axes);
  for (std::size_t i = 0; i < 3; ++i) {
    const LinearAxis::Drive drive = anchor_.axes[i].drive_at(since_anchor(reached_));
    now.motor_force[component(i)] = axes[i].force;
    now.handle.position[component(i)] = axes[i].handle_x;
    now.handle.velocity[component(i)] = axes[i].handle_v;
    now.hand_force[component(i)] = axes_[i].hand_force(axes[i], drive);
    now.energy += stored(i, axes[i], drive);
  }
  return now;
}

Energy MovingDevice::stored(std::size_t i, const LinearAxis::State& state,
                            const LinearAxis::Drive& drive) const {
  Energy e;
  e.kinetic = axes_[i].kinetic_energy(state);
  e.springs = axes_[i].spring_energy(state, drive);
  return e;
}

Energy MovingDevice::flowed(Picoseconds time, const std::array<LinearAxis::State, 3>& then) const {
  Energy sum = anchor_.energy;
  for (std::size_t i = 0; i < 3; ++i) {
    sum += anchor_.axes[i].flowed(since_anchor(time));
    const LinearAxis::State before = anchor_.axes[i].at(0);
    double way = then[i].x - before.x;
    double way_of_push = way;
    if (axes_[i].has_structure()) {
      way_of_push = then[i].handle_x - before.handle_x;
      way += handle_share_ * (way_of_push - way);
    }
    sum.by_gravity += weight_[component(i)] * way;
    sum.by_push += push_[component(i)] * way_of_push;
  }
  return sum;
}

double MovingDevice::on_handle(std::size_t i) const {
  if (!axes_[i].has_structure()) return 0;
  return handle_share_ * weight_[component(i)] + push_[component(i)];
}

void MovingDevice::move_anchor(Picoseconds time) {
  std::array<LinearAxis::State, 3> then = states(time);
  anchor_.energy = flowed(time, then);
  if (held_ && time >= lets_go_) let_go(then);
  if (pose_ && time % kPiece == 0) follow_pose(then);
  anchor_.time = time;
  carry_on(then);
}

// Its springs and its mass leave as they are; the device keeps its velocity.
void MovingDevice::let_go(std::array<LinearAxis::State, 3>& states) {
  for (std::size_t i = 0; i < 3; ++i) {
    const LinearAxis::Drive drive = anchor_.axes[i].drive_at(since_anchor(lets_go_));
    const Energy before = stored(i, states[i], drive);
    Hand{0, 0, 0}.hold(axes_[i]);
    states[i] = axes_[i].settled(states[i], drive);
    const Energy after = stored(i, states[i], drive);
    anchor_.energy.let_go += before.kinetic + before.springs - after.kinetic - after.springs;
  }
  held_ = false;
}

void MovingDevice::follow_pose(std::array<LinearAxis::State, 3>& states) {
  const auto masses = joints_.apparent_mass(*pose_, {states[0].x, states[1].x, states[2].x});
  if (!masses) return;
  const auto kept = [](double before, double after) { return std::sqrt(before / after); };
  for (std::size_t i = 0; i < 3; ++i) {
    LinearAxis& axis = axes_[i];
    LinearAxis::State& state = states[i];
    const LinearAxis before = axis;
    axis.handle_mass = handle_share_ * (*masses)[component(i)];
    axis.mass = (*masses)[component(i)] - axis.handle_mass;
    const double rides = axis.grip_is_rigid() ? axis.hand_mass : 0;  // with what the hand holds
    if (axis.has_structure()) {
      state.v *= kept(before.mass, axis.mass);
      state.handle_v *= kept(before.handle_mass + rides, axis.handle_mass + rides);
    } else {
      state.v *= kept(before.mass + rides, axis.mass + rides);
      state.handle_v = state.v;
    }
    if (axis.grip_is_rigid()) state.hand_v = state.handle_v;
  }
}

void MovingDevice::carry_on(const std::array<LinearAxis::State, 3>& states) {
  const Picoseconds time = anchor_.time;
  Picoseconds until = (time / kPiece + 1) * kPiece;
  if (held_) {
    if (time >= stroke_.until) {  // at its end, to the picosecond: it bounds `until`
      stroke_ = intended_.piece(time);
      stroke_begins_ = time;
    }
    until = std::min({until, stroke_.until, lets_go_});
  }
  anchor_.until = until;
  for (std::size_t i = 0; i < 3; ++i) {
    LinearAxis::Drive drive;
    if (held_) {
      drive.intended = shifted(stroke_.position[i], to_seconds(time - stroke_begins_));
    }
    drive.on_handle = on_handle(i);
    drive.external[0] = weight_[component(i)] + push_[component(i)] - drive.on_handle;
    drive.command = command_[component(i)];
    const double length = to_seconds(until - time);
    const double known = anchor_.axes[i].begin(axes_[i], friction_, states[i], drive, length);
    if (known >= length) continue;
    const auto whole = static_cast<Picoseconds>(known * kPicosecondsPerSecond);
    anchor_.until = std::min(anchor_.until, time + whole);
  }
  if (anchor_.until > time) return;
  throw std::logic_error("friction of a device changes without end at " + std::to_string(time) +
                         " ps");
}

}  // namespace hvp::plant
