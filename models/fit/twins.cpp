#include "models/fit/twins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>

#include "models/fem/direct_solver.h"
#include "models/fem/tissue.h"
#include "models/plant/axis_motion.h"
#include "models/plant/linear_axis.h"
#include "models/plant/plant.h"
#include "models/random/draws.h"

namespace hvp::fit {

namespace {

double noise_of(const random::Draws& draws, std::size_t counter, double deviation) {
  return gaussian(draws.uniform(static_cast<std::int64_t>(counter)), deviation);
}

}  // namespace

double gaussian(const random::Draws::Pair& uniform, double deviation) {
  return deviation * std::sqrt(-2 * std::log(uniform.first)) *
         std::cos(DeviceTwin::kTwoPi * uniform.second);
}

DeviceLog DeviceTwin::follow(const std::vector<double>& command) const {
  plant::LinearAxis axis;
  axis.mass = mass;
  axis.damping = damping;
  axis.lag_rate = kTwoPi * bandwidth;
  std::optional<plant::Friction> friction;
  if (coulomb > 0) friction = plant::Friction{coulomb, 0};

  DeviceLog log{period, command, {}};
  plant::LinearAxis::State state;
  state.force = motor_constant * command[0];
  const auto whole = static_cast<std::ptrdiff_t>(std::floor(delay / period));
  const double part = delay - static_cast<double>(whole) * period;
  const auto go = [&](std::ptrdiff_t at, double seconds) {
    plant::LinearAxis::Drive drive;
    drive.external[0] = offset;
    drive.command = motor_constant * command[static_cast<std::size_t>(at < 0 ? 0 : at)];
    double left = seconds;
    while (left > 0) {
      plant::AxisMotion motion;
      const double lasts = motion.begin(axis, friction, state, drive, left);
      state = motion.at(lasts);
      left -= lasts;
    }
  };
  const random::Draws draws(seed, "device twin");
  for (std::size_t i = 0; i < command.size(); ++i) {
    double seen = state.x;
    if (noise > 0) seen += noise_of(draws, i, noise);
    if (step > 0) seen = std::floor(seen / step) * step;
    log.position.push_back(seen);
    const auto at = static_cast<std::ptrdiff_t>(i) - whole;
    go(at - 1, part);
    go(at, period - part);
  }
  return log;
}

std::vector<double> busy_command(std::size_t samples, double period, double size,
                                 std::int64_t seed) {
  const random::Draws draws(seed, "busy command");
  std::vector<double> command;
  for (std::int64_t level = 0; command.size() < samples; ++level) {
    const random::Draws::Pair u = draws.uniform(level);
    const double height = size * (2 * u.first - 1);
    const auto held = static_cast<std::size_t>(std::ceil((0.005 + 0.035 * u.second) / period));
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t i = 0; i < held && command.size() < samples; ++i) {
        const double t = static_cast<double>(command.size()) * period;
        command.push_back(sign * height + 0.3 * size * std::sin(DeviceTwin::kTwoPi * 1.7 * t));
      }
    }
  }
  return command;
}

IndentationLog press(const RampAndHold& motion, const QlvSettings& settings,
                     const std::vector<double>& values, double noise, std::int64_t seed) {
  const double seconds = motion.rest + motion.stroke / motion.rate + motion.hold;
  const auto samples = static_cast<std::size_t>(std::floor(seconds / motion.step)) + 1;
  PressedLog log{
      .time = {}, .depth = {}, .force = {}, .direction = 1, .step = motion.step, .warnings = {}};
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * motion.step;
    log.time.push_back(t);
    log.depth.push_back(std::clamp((t - motion.rest) * motion.rate, 0.0, motion.stroke));
  }
  std::vector<double> force = qlv_force(settings, log, values);
  const random::Draws draws(seed, "indentation");
  for (std::size_t i = 0; i < samples; ++i) {
    force[i] += noise_of(draws, i, noise);
  }
  return {.time = log.time, .travel = log.depth, .force = force};
}

std::vector<double> press_and_sweep(const PressAndSweep& motion, double period_s) {
  const auto frames = static_cast<std::size_t>(std::llround(motion.duration / period_s));
  std::vector<double> displacement;
  displacement.reserve(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) * period_s;
    const double risen = std::min(t / motion.rise, 1.0);
    const double since = std::max(0.0, t - motion.rise);
    displacement.push_back(motion.press / 2 * (1 - std::cos(std::numbers::pi * risen)) +
                           motion.sweep *
                               std::sin(std::numbers::pi * motion.quickens * since * since));
  }
  return displacement;
}

TissueLog touch(const TissueBody& body, const TissueValues& values, const std::vector<int>& nodes,
                const Eigen::Vector3d& direction, const std::vector<double>& displacement,
                double noise, std::int64_t seed) {
  const fem::Body solid(body.mesh,
                        fem::Material{.young_modulus_pa = values.young_modulus,
                                      .poisson_ratio = values.poisson_ratio,
                                      .density_kg_m3 = body.density_kg_m3},
                        body.anchored, fem::AnchorTreatment::removed);
  std::optional<fem::Dynamics> dynamics = body.dynamics;
  if (dynamics) {
    dynamics->rayleigh_mass = values.mass_damping;
    dynamics->rayleigh_stiffness = values.stiffness_damping;
  }
  fem::LinearTissue tissue(solid, fem::ContactDiagonal::average, dynamics, body.period_s,
                           fem::Effort::computed);
  fem::DirectSolver solver(tissue.system());
  const std::span<const double> rest = tissue.initial_displacement();
  std::vector<double> u(rest.begin(), rest.end());
  std::vector<int> active;
  active.reserve(nodes.size());
  for (const int node : nodes) active.push_back(solid.active_index(node));
  const Eigen::Vector3d along = direction.normalized();
  const double elapsed = body.velocity_of_way ? body.period_s : 0;
  const random::Draws draws(seed, "touch");
  TissueLog log{nodes, direction, {}, displacement, {}};
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const std::vector<Eigen::Vector3d> place(nodes.size(), displacement[i] * along);
    tissue.hold({.nodes = active, .displacement = place, .let_go = {}, .elapsed_s = elapsed});
    solver.solve_with_contact(tissue.load(), active, place, u);
    std::array<Eigen::Vector3d, 1> force;
    tissue.forces(u, force);
    tissue.advance(u);
    log.time.push_back(static_cast<double>(i) * body.period_s);
    log.force.push_back(force[0].dot(along) + noise * noise_of(draws, i, 1));
  }
  return log;
}

}  // namespace hvp::fit
