#include "models/plant/wall_stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hvp::plant {

namespace {

// What a unit of a state, or of a constant force, becomes after so many seconds.
struct Response {
  Eigen::Matrix2d of_state;
  Eigen::Vector2d of_force;
};

Response response(const DrivenMass& mass, double seconds) {
  const auto column = [&](const DrivenMass::State& from, double force) {
    const DrivenMass::State s = mass.after(seconds, from, {force});
    return Eigen::Vector2d(s.x, s.v);
  };
  Response r;
  r.of_state.col(0) = column({1, 0}, 0);
  r.of_state.col(1) = column({0, 1}, 0);
  r.of_force = column({0, 0}, 1);
  return r;
}

// The state is x, v and the positions read before, the last one first: a force that is `age`
// samples old needs two of them.
Eigen::MatrixXd loop_map(const WallLoop& loop, double stiffness) {
  const double samples = std::floor(loop.delay_s / loop.period_s);
  const double rest = std::max(0.0, loop.delay_s - samples * loop.period_s);
  const auto age = static_cast<Eigen::Index>(samples);
  const Eigen::Index size = age + 4;
  const Response before = response(loop.device, rest);
  const Response after = response(loop.device, loop.period_s - rest);

  // Position n − k in the state.
  const auto read = [](Eigen::Index k) { return k == 0 ? Eigen::Index{0} : k + 1; };
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
  const auto add_force = [&](const Eigen::Vector2d& response_to_it, Eigen::Index old) {
    const double slope = loop.damping / loop.period_s;
    map.block<2, 1>(0, read(old)) -= (stiffness + slope) * response_to_it;
    map.block<2, 1>(0, read(old + 1)) += slope * response_to_it;
  };
  map.topLeftCorner<2, 2>() = after.of_state * before.of_state;
  add_force(after.of_state * before.of_force, age + 1);
  add_force(after.of_force, age);
  map(2, 0) = 1;
  for (Eigen::Index i = 3; i < size; ++i) map(i, i - 1) = 1;
  return map;
}

}  // namespace

double spectral_radius(const WallLoop& loop, double stiffness) {
  return loop_map(loop, stiffness).eigenvalues().cwiseAbs().maxCoeff();
}

double largest_stable_stiffness(const WallLoop& loop) {
  // A free device has an eigenvalue of one without a wall: stability begins above none.
  const auto stable = [&loop](double stiffness) {
    return spectral_radius(loop, stiffness) < 1 + 1e-13;
  };
  // From below, in steps that a stable range does not lie between.
  double below = 0;
  double above = 1e-3;
  if (!stable(above)) return 0;
  while (stable(above)) {
    below = above;
    above *= 1.1;
    if (above > 1e12) return above;
  }
  while (above - below > 1e-9 * above) {
    const double middle = 0.5 * (below + above);
    (stable(middle) ? below : above) = middle;
  }
  return below;
}

double passive_stiffness(const WallLoop& loop, double device_damping) {
  const double left = device_damping - std::abs(loop.damping);
  return std::max(0.0, left / (0.5 * loop.period_s + loop.delay_s));
}

}  // namespace hvp::plant
