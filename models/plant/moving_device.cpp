#include "models/plant/moving_device.h"

#include <algorithm>

namespace hvp::plant {

namespace {

// Longest time that is carried on in one piece.
constexpr Picoseconds kPiece = 1'000'000'000;

std::size_t axis(int i) { return static_cast<std::size_t>(i); }

}  // namespace

void DeviceDynamics::declare(config::Visitor& v) {
  v.quantity("mass", mass_kg, config::Dimension::mass, {.min = 1e-6, .max = 1e3},
             {"apparent mass at the tip, the same along each axis",
              "data sheets: a PHANTOM Premium 1.5 has less than 75 g, an Omni 45 g"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e4),
             {"viscous damping of the device",
              "assumed; CHAI3D lets a Premium 1.5 be damped with 5 N s/m"});
}

void Hand::declare(config::Visitor& v) {
  v.quantity("mass", mass_kg, config::Dimension::mass, config::between(0, 1e3),
             {"what of the hand moves with the device", "0: of a fingertip grip, small"});
  v.quantity("stiffness", stiffness_N_m, config::Dimension::stiffness, config::between(0, 1e6),
             {"of the spring between the intended motion and the device",
              "Speich, Shao & Goldfarb 2005: 375 N/m of an arm"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e4),
             {"of the damper beside it", "the same: 4.5 N s/m"});
}

MovingDevice::MovingDevice(const DeviceDynamics& dynamics, const std::optional<Hand>& hand,
                           const Trajectory& intended)
    : held_(hand.has_value()), intended_(intended) {
  axis_.mass = dynamics.mass_kg;
  axis_.damping = dynamics.damping_N_s_m;
  if (hand) {
    axis_.hand_mass = hand->mass_kg;
    axis_.hand_stiffness = hand->stiffness_N_m;
    axis_.hand_damping = hand->damping_N_s_m;
  }
  for (int i = 0; i < 3; ++i) anchor_.state[axis(i)].x = intended_.start[i];
  move_anchor(0, force_);
}

void MovingDevice::advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) {
  if (force != force_) {
    while (anchor_.until <= from) move_anchor(anchor_.until, force_);
    move_anchor(from, force);
    force_ = force;
  }
  while (anchor_.until <= to) move_anchor(anchor_.until, force_);
  reached_ = to;
}

TipState MovingDevice::state() const {
  const std::array<LinearAxis::State, 3> now = moved_to(reached_);
  TipState tip;
  for (int i = 0; i < 3; ++i) {
    tip.position[i] = now[axis(i)].x;
    tip.velocity[i] = now[axis(i)].v;
  }
  return tip;
}

std::array<LinearAxis::State, 3> MovingDevice::moved_to(Picoseconds time) const {
  std::array<LinearAxis::State, 3> now;
  for (std::size_t i = 0; i < 3; ++i) {
    now[i] = axis_.after(to_seconds(time - anchor_.time), anchor_.state[i], anchor_.drive[i]);
  }
  return now;
}

void MovingDevice::move_anchor(Picoseconds time, const Eigen::Vector3d& force) {
  if (time > anchor_.time) anchor_.state = moved_to(time);
  anchor_.time = time;
  anchor_.until = (time / kPiece + 1) * kPiece;
  Trajectory::Piece piece{};
  if (held_) {
    piece = intended_.piece(time);
    anchor_.until = std::min(anchor_.until, piece.until);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    anchor_.drive[i].intended = piece.position[i];
    anchor_.drive[i].command = force[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace hvp::plant
