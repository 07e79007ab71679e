#include "models/plant/wall_stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hvp::plant {

namespace {

// The state of an axis: five members, and two more with a structure.
constexpr Eigen::Index kPlain = 5;
constexpr Eigen::Index kStructured = 7;

// The response of a unit of a state, or of a constant command, after so many seconds.
template <Eigen::Index Size>
struct Response {
  Eigen::Matrix<double, Size, Size> of_state;
  Eigen::Matrix<double, Size, 1> of_command;
};

template <Eigen::Index Size>
Response<Size> response(const LinearAxis& device, double seconds) {
  using Vector = Eigen::Matrix<double, kStructured, 1>;
  const auto column = [&](const LinearAxis::State& from, double command) {
    LinearAxis::Drive drive;
    drive.command = command;
    const LinearAxis::State s = device.after(seconds, from, drive);
    const Vector all{{s.x, s.v, s.hand_x, s.hand_v, s.force, s.handle_x, s.handle_v}};
    return Eigen::Matrix<double, Size, 1>(all.head<Size>());
  };
  Response<Size> r;
  for (Eigen::Index i = 0; i < Size; ++i) {
    const Vector u = Vector::Unit(i);
    r.of_state.col(i) = column({u[0], u[1], u[2], u[3], u[4], u[5], u[6]}, 0);
  }
  r.of_command = column({}, 1);
  return r;
}

// The loop's map from one sample to the next, for any stiffness of the wall. The responses take
// nearly all of the time, and no stiffness changes them: they are formed once.
template <Eigen::Index Size>
class LoopMap {
 public:
  explicit LoopMap(const WallLoop& loop)
      : slope_(loop.damping / loop.period_s),
        age_(static_cast<Eigen::Index>(std::floor(loop.delay_s / loop.period_s))) {
    const double samples = static_cast<double>(age_);
    const double rest = std::max(0.0, loop.delay_s - samples * loop.period_s);
    before_ = response<Size>(loop.device, rest);
    after_ = response<Size>(loop.device, loop.period_s - rest);
  }

  double spectral_radius(double stiffness) const {
    return map(stiffness).eigenvalues().cwiseAbs().maxCoeff();
  }

 private:
  // The state is the axis' and the positions read before, the last one first: a force that is `age`
  // samples old needs two of them.
  Eigen::MatrixXd map(double stiffness) const {
    const Eigen::Index size = Size + age_ + 2;
    // Position n − k in the state.
    const auto read = [](Eigen::Index k) { return k == 0 ? Eigen::Index{0} : Size + k - 1; };
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
    const auto add_force = [&](const Eigen::Matrix<double, Size, 1>& response_to_it,
                               Eigen::Index old) {
      map.block<Size, 1>(0, read(old)) -= (stiffness + slope_) * response_to_it;
      map.block<Size, 1>(0, read(old + 1)) += slope_ * response_to_it;
    };
    map.topLeftCorner<Size, Size>() = after_.of_state * before_.of_state;
    add_force(after_.of_state * before_.of_command, age_ + 1);
    add_force(after_.of_command, age_);
    map(Size, 0) = 1;
    for (Eigen::Index i = Size + 1; i < size; ++i) map(i, i - 1) = 1;
    return map;
  }

  double slope_;             // N/m, of the wall's damping between two samples
  Eigen::Index age_;         // of a force, in whole samples
  Response<Size> before_{};  // until the force that is computed now acts
  Response<Size> after_{};   // from then to the next sample
};

template <Eigen::Index Size>
double largest_stable(const LoopMap<Size>& map) {
  // A free device has an eigenvalue of one without a wall: stability begins above none.
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

}  // namespace

double spectral_radius(const WallLoop& loop, double stiffness) {
  return loop.device.has_structure() ? LoopMap<kStructured>(loop).spectral_radius(stiffness)
                                     : LoopMap<kPlain>(loop).spectral_radius(stiffness);
}

double largest_stable_stiffness(const WallLoop& loop) {
  return loop.device.has_structure() ? largest_stable(LoopMap<kStructured>(loop))
                                     : largest_stable(LoopMap<kPlain>(loop));
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
