#include "models/plant/wall_stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hvp::plant {

namespace {

constexpr Eigen::Index kSize = 5;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;

// The response of a unit of a state, or of a constant command, after so many seconds.
struct Response {
  Matrix of_state;
  Vector of_command;
};

Response response(const LinearAxis& device, double seconds) {
  const auto column = [&](const LinearAxis::State& from, double command) {
    LinearAxis::Drive drive;
    drive.command = command;
    const LinearAxis::State s = device.after(seconds, from, drive);
    return Vector(s.x, s.v, s.hand_x, s.hand_v, s.force);
  };
  Response r;
  for (Eigen::Index i = 0; i < kSize; ++i) {
    const Vector unit = Vector::Unit(i);
    r.of_state.col(i) = column({unit[0], unit[1], unit[2], unit[3], unit[4]}, 0);
  }
  r.of_command = column({}, 1);
  return r;
}

// The loop's map from one sample to the next, for any stiffness of the wall. The responses take
// nearly all of the time, and no stiffness changes them: they are formed once.
class LoopMap {
 public:
  explicit LoopMap(const WallLoop& loop)
      : slope_(loop.damping / loop.period_s),
        age_(static_cast<Eigen::Index>(std::floor(loop.delay_s / loop.period_s))) {
    const double samples = static_cast<double>(age_);
    const double rest = std::max(0.0, loop.delay_s - samples * loop.period_s);
    before_ = response(loop.device, rest);
    after_ = response(loop.device, loop.period_s - rest);
  }

  double spectral_radius(double stiffness) const {
    return map(stiffness).eigenvalues().cwiseAbs().maxCoeff();
  }

 private:
  // The state is the axis' and the positions read before, the last one first: a force that is `age`
  // samples old needs two of them.
  Eigen::MatrixXd map(double stiffness) const {
    const Eigen::Index size = kSize + age_ + 2;
    // Position n − k in the state.
    const auto read = [](Eigen::Index k) { return k == 0 ? Eigen::Index{0} : kSize + k - 1; };
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
    const auto add_force = [&](const Vector& response_to_it, Eigen::Index old) {
      map.block<kSize, 1>(0, read(old)) -= (stiffness + slope_) * response_to_it;
      map.block<kSize, 1>(0, read(old + 1)) += slope_ * response_to_it;
    };
    map.topLeftCorner<kSize, kSize>() = after_.of_state * before_.of_state;
    add_force(after_.of_state * before_.of_command, age_ + 1);
    add_force(after_.of_command, age_);
    map(kSize, 0) = 1;
    for (Eigen::Index i = kSize + 1; i < size; ++i) map(i, i - 1) = 1;
    return map;
  }

  double slope_;       // N/m, of the wall's damping between two samples
  Eigen::Index age_;   // of a force, in whole samples
  Response before_{};  // until the force that is computed now acts
  Response after_{};   // from then to the next sample
};

}  // namespace

double spectral_radius(const WallLoop& loop, double stiffness) {
  return LoopMap(loop).spectral_radius(stiffness);
}

double largest_stable_stiffness(const WallLoop& loop) {
  // A free device has an eigenvalue of one without a wall: stability begins above none.
  const LoopMap map(loop);
  const auto stable = [&map](double stiffness) {
    return map.spectral_radius(stiffness) < 1 + 1e-13;
  };
  // The search goes upwards in small steps, so that it ends at the first instability.
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

double stiffness_cost(const WallLoop& loop, double part_s) {
  WallLoop faster = loop;
  faster.delay_s = std::max(0.0, loop.delay_s - part_s);
  return largest_stable_stiffness(faster) - largest_stable_stiffness(loop);
}

double passive_stiffness(const WallLoop& loop, double device_damping) {
  const double left = device_damping - std::abs(loop.damping);
  const double lag = loop.device.lag_rate > 0 ? 1 / loop.device.lag_rate : 0;
  return std::max(0.0, left / (0.5 * loop.period_s + loop.delay_s + lag));
}

}  // namespace hvp::plant
