#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include <ceres/jet.h>

#include "models/fit/device_motion.h"
#include "models/fit/hand_problem.h"

namespace hvp::fit {

// The motion of a mass on a spring and a damper over a step h under a force that is linear in time,
//
//   m·x″ + b·x′ + k·x = g₀ + g₁·t:
//
//   (x, v)(h) = Φ·(x, v) + c·g₀ + d·g₁.
//
// With y the solution that begins at 0 with velocity 1: Φ = [1 − k/m·∫y, y; −k/m·y, y′], c = [∫y,
// y]/m and d = [∬y, ∫y]/m. y is a power series over a fraction of h, which is then doubled.
template <typename T>
struct HandStep {
  struct Pair {
    T x{0}, v{0};
  };
  T xx{1}, xv{0}, vx{0}, vv{1};  // Φ
  Pair constant;                 // c
  Pair ramp;                     // d

  // `seconds` positive; mass positive, the others not negative.
  static HandStep over(double seconds, const T& mass, const T& stiffness, const T& damping);

  Pair apply(const Pair& state) const {
    return {xx * state.x + xv * state.v, vx * state.x + vv * state.v};
  }

 private:
  void twice(double seconds);
};

template <typename T>
HandStep<T> HandStep<T>::over(double seconds, const T& mass, const T& stiffness, const T& damping) {
  constexpr double kFastest = 0.5;
  constexpr int kTerms = 16;
  const double rate =
      2 * std::max(plain(damping) / plain(mass), std::sqrt(plain(stiffness) / plain(mass)));
  int doublings = 0;
  double h = seconds;
  for (; rate * h > kFastest && doublings < 60; ++doublings) h /= 2;

  const T damped = damping * h / mass;
  const T stiff = stiffness * (h * h) / mass;
  T before{0};  // coefficients of (t/h)ⁿ
  T here{h};
  T slope{1}, y{0}, once{0}, twice_{0};
  y = here;
  once = here * (h / 2);
  twice_ = here * (h * h / 6);
  for (int n = 0; n < kTerms; ++n) {
    const T next = -(damped * here * static_cast<double>(n + 1) + stiff * before) /
                   static_cast<double>((n + 2) * (n + 1));
    const double p = n + 2;
    slope += next * (p / h);
    y += next;
    once += next * (h / (p + 1));
    twice_ += next * (h * h / ((p + 1) * (p + 2)));
    before = here;
    here = next;
  }
  const T lightness = 1.0 / mass;
  const T spring = stiffness * lightness;
  HandStep step;
  step.xx = 1.0 - spring * once;
  step.xv = y;
  step.vx = -spring * y;
  step.vv = slope;
  step.constant = {once * lightness, y * lightness};
  step.ramp = {twice_ * lightness, once * lightness};
  for (; doublings > 0; --doublings, h *= 2) step.twice(h);
  return step;
}

template <typename T>
void HandStep<T>::twice(double seconds) {
  const Pair later = apply(ramp);
  ramp = {later.x + constant.x * seconds + ramp.x, later.v + constant.v * seconds + ramp.v};
  const Pair after = apply(constant);
  constant = {after.x + constant.x, after.v + constant.v};
  const T xx2 = xx * xx + xv * vx;
  const T xv2 = xx * xv + xv * vv;
  const T vx2 = vx * xx + vv * vx;
  vv = vx * xv + vv * vv;
  xx = xx2;
  xv = xv2;
  vx = vx2;
}

namespace {

enum Index : int { kMass, kStiffness, kDamping, kHandParameters };
using HandJet = ceres::Jet<double, kHandParameters>;

// A signal over the window, its value and its derivatives in columns.
using Signal = Eigen::Matrix<double, Eigen::Dynamic, 1 + kHandParameters>;

HandJet dot(const Signal& a, const Signal& b) {
  HandJet product(a.col(0).dot(b.col(0)));
  for (int k = 0; k < kHandParameters; ++k) {
    product.v[k] = a.col(1 + k).dot(b.col(0)) + a.col(0).dot(b.col(1 + k));
  }
  return product;
}

// Takes from `signal` what lies along `other`.
void remove(const Signal& other, Signal& signal) {
  const HandJet share = dot(other, signal) / dot(other, other);
  for (int k = 0; k < kHandParameters; ++k) {
    signal.col(1 + k) -= share.v[k] * other.col(0) + share.a * other.col(1 + k);
  }
  signal.col(0) -= share.a * other.col(0);
}

struct Hand {
  HandJet mass, stiffness, damping;
};

class HandCost final : public ceres::CostFunction {
 public:
  HandCost(const HandLog& log, std::size_t degree, std::size_t first, std::size_t last)
      : log_(log), first_(first), samples_(static_cast<Eigen::Index>(last - first)) {
    set_num_residuals(static_cast<int>(samples_));
    *mutable_parameter_block_sizes() = {kHandParameters};
    if (!log.intended.empty()) return;
    // The motion that follows a polynomial is, but for how it begins, a polynomial of its degree
    // whatever the hand, and any such polynomial follows one.
    Eigen::MatrixXd polynomials(samples_, static_cast<Eigen::Index>(degree) + 1);
    for (Eigen::Index i = 0; i < samples_; ++i) {
      const double s = 2 * static_cast<double>(i) / static_cast<double>(samples_ - 1) - 1;
      const std::vector<double> row = legendre(degree, s);
      polynomials.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), polynomials.cols());
    }
    slow_ = Eigen::HouseholderQR<Eigen::MatrixXd>(polynomials).householderQ() *
            Eigen::MatrixXd::Identity(samples_, polynomials.cols());
  }

  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    const double* const p = blocks[0];
    for (int k = 0; k < kHandParameters; ++k) {
      if (!std::isfinite(p[k]) || p[k] < 0) return false;
    }
    if (p[kMass] == 0) return false;
    const Hand hand{HandJet(p[kMass], kMass), HandJet(p[kStiffness], kStiffness),
                    HandJet(p[kDamping], kDamping)};
    const Signal left = unexplained(hand);
    if (!left.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, samples_) = left.col(0);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kHandParameters, Eigen::RowMajor>>(
          jacobians[0], samples_, kHandParameters) = left.rightCols<kHandParameters>();
    }
    return true;
  }

 private:
  using Step = HandStep<HandJet>;

  Signal unexplained(const Hand& hand) const {
    const Step step = Step::over(log_.period, hand.mass, hand.stiffness, hand.damping);
    Step::Pair forced;  // from rest, by the force and the known intended motion
    Step::Pair placed{HandJet(1), HandJet(0)};
    Step::Pair thrown{HandJet(0), HandJet(1)};
    Signal left(samples_, 1 + kHandParameters), from_place(left), from_speed(left);
    const auto put = [](const HandJet& x, Eigen::Index i, Signal& signal) {
      signal.row(i) << x.a, x.v.transpose();
    };
    for (Eigen::Index i = 0; i < samples_; ++i) {
      const std::size_t sample = first_ + static_cast<std::size_t>(i);
      put(log_.position[sample] - forced.x, i, left);
      put(placed.x, i, from_place);
      put(thrown.x, i, from_speed);
      if (i + 1 == samples_) break;
      forced = pushed(step, hand, sample, forced);
      placed = step.apply(placed);
      thrown = step.apply(thrown);
    }
    eliminate(left, from_place, from_speed);
    return left;
  }

  void eliminate(Signal& left, Signal& from_place, Signal& from_speed) const {
    // A signal that is a polynomial but for rounding has nothing to give.
    constexpr double kRounding = 1e-10;
    const double place = from_place.col(0).norm();
    const double speed = from_speed.col(0).norm();
    if (slow_.size() > 0) {
      for (Signal* signal : {&left, &from_place, &from_speed}) {
        const Eigen::MatrixXd shares = slow_.transpose() * *signal;
        *signal -= slow_ * shares;
      }
    }
    if (from_place.col(0).norm() > kRounding * place) {
      remove(from_place, from_speed);
      remove(from_place, left);
    }
    if (from_speed.col(0).norm() > kRounding * speed) remove(from_speed, left);
  }

  Step::Pair pushed(const Step& step, const Hand& hand, std::size_t sample,
                    const Step::Pair& from) const {
    HandJet begins(log_.force[sample]);
    HandJet slope((log_.force[sample + 1] - log_.force[sample]) / log_.period);
    if (!log_.intended.empty()) {
      const double u = log_.intended[sample];
      const double fast = (log_.intended[sample + 1] - u) / log_.period;
      begins += hand.stiffness * u + hand.damping * fast;
      slope += hand.stiffness * fast;
    }
    Step::Pair to = step.apply(from);
    to.x += step.constant.x * begins + step.ramp.x * slope;
    to.v += step.constant.v * begins + step.ramp.v * slope;
    return to;
  }

  const HandLog& log_;
  std::size_t first_;
  Eigen::Index samples_;
  Eigen::MatrixXd slow_;  // an orthonormal basis of polynomials, in columns
};

}  // namespace

std::vector<double> legendre(std::size_t degree, double s) {
  std::vector<double> p{1};
  if (degree > 0) p.push_back(s);
  for (std::size_t n = 1; n < degree; ++n) {  // Bonnet's recursion
    const auto order = static_cast<double>(n);
    p.push_back(((2 * order + 1) * s * p[n] - order * p[n - 1]) / (order + 1));
  }
  return p;
}

std::unique_ptr<ceres::CostFunction> hand_cost(const HandLog& log, std::size_t degree,
                                               std::size_t first, std::size_t last) {
  return std::make_unique<HandCost>(log, degree, first, last);
}

}  // namespace hvp::fit
