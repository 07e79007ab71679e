#include "models/fit/uncertainty.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace hvp::fit {

namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A change of the parameters along such a direction changes the residuals 10⁹ times less than along
// others: rounding alone.
constexpr double kNoEffect = 1e-9;

// Residuals beyond unknowns from which on their squares say where the noise is larger.
constexpr double kEnoughForUneven = 50;

// Each variance becomes the larger of two, correlations stay.
void widen(Eigen::MatrixXd& covariance, const Eigen::MatrixXd& other) {
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(covariance.rows());
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    if (other(k, k) > covariance(k, k) && covariance(k, k) > 0) {
      factor[k] = std::sqrt(other(k, k) / covariance(k, k));
    }
  }
  covariance = factor.asDiagonal() * covariance * factor.asDiagonal();
}

struct Evaluation {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd by_z;
  Eigen::MatrixXd by_own;
};

Evaluation evaluate(const Problem& problem, const Coordinates& coordinates, std::size_t stretch,
                    int rows, const Point& at) {
  const std::unique_ptr<ceres::CostFunction> cost = problem.cost(stretch);
  const std::vector<double> values = coordinates.values(at.z.data());
  const bool has_own = cost->parameter_block_sizes().size() > 1;
  const int all = cost->num_residuals();
  Eigen::VectorXd residuals(all);
  Rows by_values(all, cost->parameter_block_sizes()[0]);
  Rows by_own(all, has_own ? cost->parameter_block_sizes()[1] : 0);
  std::vector<const double*> blocks{values.data()};
  if (has_own) blocks.push_back(at.own[stretch].data());
  std::vector<double*> jacobians{by_values.data()};
  if (has_own) jacobians.push_back(by_own.data());
  cost->Evaluate(blocks.data(), residuals.data(), jacobians.data());
  Evaluation result{residuals.head(rows), {}, by_own.topRows(rows)};
  result.by_z.resize(rows, static_cast<Eigen::Index>(coordinates.size()));
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    result.by_z.col(static_cast<Eigen::Index>(k)) =
        coordinates.slope(k, values) *
        by_values.topRows(rows).col(static_cast<Eigen::Index>(coordinates.parameter(k)));
  }
  return result;
}

void score(Linear& linear, const RobustLoss& loss) {
  double slopes = 0;
  for (const Eigen::VectorXd& r : linear.weighted) {
    Eigen::VectorXd e(r.size());
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const RobustLoss::Value value = loss.at(r[i]);
      e[i] = value.score;
      slopes += value.score_slope;
    }
    linear.scores.push_back(std::move(e));
  }
  linear.slope = std::max(slopes / std::max(1, linear.rows), 1e-3);
  for (Eigen::VectorXd& e : linear.scores) e /= linear.slope;
}

}  // namespace

Linear linearise(const Problem& problem, const Coordinates& coordinates,
                 const std::vector<int>& rows, const Point& at, const RobustLoss& loss) {
  Linear linear;
  for (std::size_t s = 0; s < rows.size(); ++s) {
    if (rows[s] == 0) continue;
    Evaluation e = evaluate(problem, coordinates, s, rows[s], at);
    linear.rows += rows[s];
    const Eigen::VectorXd roots =
        roots_of(problem.weights(s), static_cast<Eigen::Index>(problem.stretch(s).residuals))
            .head(rows[s]);
    e.by_z = roots.asDiagonal() * e.by_z;
    e.by_own = roots.asDiagonal() * e.by_own;
    Eigen::MatrixXd follows = Eigen::MatrixXd::Zero(e.by_own.cols(), e.by_z.cols());
    if (e.by_own.cols() > 0) {
      linear.own += static_cast<int>(e.by_own.cols());
      follows = -e.by_own.colPivHouseholderQr().solve(e.by_z);
      e.by_z += e.by_own * follows;
    }
    linear.weighted.emplace_back(roots.cwiseProduct(e.residuals));
    linear.residuals.push_back(std::move(e.residuals));
    linear.jacobian.push_back(std::move(e.by_z));
    linear.follows.push_back(std::move(follows));
  }
  score(linear, loss);
  return linear;
}

double Uncertainty::deviation(std::size_t coordinate) const {
  const auto k = static_cast<Eigen::Index>(coordinate);
  return std::sqrt(std::max(0.0, covariance(k, k)));
}

Uncertainty uncertainty_of(const Linear& linear) {
  const Eigen::Index n = linear.jacobian.front().cols();
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(n);
  for (const Eigen::MatrixXd& j : linear.jacobian) scale += j.colwise().squaredNorm().transpose();
  scale = scale.cwiseSqrt();
  for (double& s : scale) s = s > 0 ? 1 / s : 0;

  // R of all stretches' Jacobians, so that no precision is lost to JᵀJ.
  Eigen::MatrixXd stacked(0, n);
  for (const Eigen::MatrixXd& j : linear.jacobian) {
    Eigen::MatrixXd both(stacked.rows() + j.rows(), n);
    both << stacked, j * scale.asDiagonal();
    if (both.rows() > n) {
      const Eigen::HouseholderQR<Eigen::MatrixXd> qr(both);
      both = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>().toDenseMatrix();
    }
    stacked = std::move(both);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(stacked, Eigen::ComputeFullV);
  Uncertainty result;
  result.singular.assign(static_cast<std::size_t>(n), false);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd direction = svd.matrixV().col(i);
    const double effect = i < svd.singularValues().size() ? svd.singularValues()[i] : 0;
    if (effect > kNoEffect * svd.singularValues()[0]) {
      inverse += direction * direction.transpose() / (effect * effect);
      continue;
    }
    for (Eigen::Index k = 0; k < n; ++k) {
      if (std::abs(direction[k]) > 1e-3) result.singular[static_cast<std::size_t>(k)] = true;
    }
  }
  result.unit = scale.asDiagonal() * inverse * scale.asDiagonal();

  const auto unknowns = static_cast<int>(n) + linear.own;
  result.noise = noise_of(linear.scores, unknowns);
  result.t = t_95(linear.rows - unknowns);
  Eigen::MatrixXd even = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd uneven = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t s = 0; s < linear.jacobian.size(); ++s) {
    even += result.noise.between(linear.jacobian[s]);
    uneven += result.noise.between(linear.jacobian[s], linear.scores[s]);
  }
  const double freedom = linear.rows - unknowns;
  uneven *= linear.rows / std::max(1.0, freedom);
  result.covariance = result.unit * even * result.unit;
  if (freedom >= kEnoughForUneven) widen(result.covariance, result.unit * uneven * result.unit);
  double squares = 0;
  for (const Eigen::VectorXd& e : linear.scores) squares += e.squaredNorm();
  const double white = squares / std::max(1, linear.rows - unknowns);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double plain = white * result.unit(k, k);
    if (plain > 0) {
      result.widened = std::max(result.widened, std::sqrt(result.covariance(k, k) / plain));
    }
  }
  return result;
}

namespace {

constexpr double kLinear = 0.2;  // of the rise
constexpr int kMostProfilePoints = 8;
constexpr double kNear = 0.02;  // of the root of the rise

}  // namespace

Intervals::Intervals(Search& search, const Coordinates& coordinates, const Linear& linear,
                     const Uncertainty& uncertainty, const Optimum& optimum)
    : search_(search),
      coordinates_(coordinates),
      linear_(linear),
      uncertainty_(uncertainty),
      optimum_(optimum) {}

double Intervals::limited(std::size_t coordinate, double z) const {
  return std::clamp(z, coordinates_.low(coordinate), coordinates_.high(coordinate));
}

// The point at which the other coordinates of a linear problem would be if this coordinate were off
// by `step`.
Point Intervals::moved(std::size_t coordinate, double step) const {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const Eigen::VectorXd steps = uncertainty_.unit.col(k) * (step / uncertainty_.unit(k, k));
  Point point = optimum_.at;
  for (std::size_t j = 0; j < coordinates_.size(); ++j) {
    point.z[j] = limited(j, point.z[j] + steps[static_cast<Eigen::Index>(j)]);
  }
  std::size_t fitted = 0;
  for (std::size_t s = 0; s < point.own.size(); ++s) {
    if (search_.range().rows[s] == 0) continue;
    const Eigen::VectorXd own = linear_.follows[fitted++] * steps;
    for (std::size_t i = 0; i < point.own[s].size(); ++i) {
      point.own[s][i] += own[static_cast<Eigen::Index>(i)];
    }
  }
  return point;
}

Interval Intervals::plain(std::size_t coordinate) const {
  const double z = optimum_.at.z[coordinate];
  const double step = uncertainty_.t * uncertainty_.deviation(coordinate);
  return {limited(coordinate, z - step), limited(coordinate, z + step)};
}

Interval Intervals::of(std::size_t coordinate) {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const double z = optimum_.at.z[coordinate];
  const double step = uncertainty_.t * uncertainty_.deviation(coordinate);
  if (!(step > 0) || !std::isfinite(step)) return {z, z};
  const double expected = linear_.slope * step * step / uncertainty_.unit(k, k);
  const auto ratio = [&](double by) {
    const double at = limited(coordinate, z + by) - z;
    if (at == 0) return 1.0;
    const std::optional<double> sum = search_.sum(moved(coordinate, at));
    return sum ? (*sum - optimum_.sum) / (expected * (at / step) * (at / step)) : 1e6;
  };
  const double below = ratio(-step);
  const double above = ratio(step);
  if (std::abs(below - 1) <= kLinear && std::abs(above - 1) <= kLinear) {
    return {limited(coordinate, z - step), limited(coordinate, z + step)};
  }
  return {end(coordinate, -step, below), end(coordinate, step, above), true};
}

// The root of √rise − √expected, by secants from z, where the rise is zero.
double Intervals::end(std::size_t coordinate, double step, double ratio) {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const double z = optimum_.at.z[coordinate];
  const double wanted = std::sqrt(linear_.slope / uncertainty_.unit(k, k)) * std::abs(step);
  double inside = 0;  // of the step: the rise is less than wanted
  double inside_root = 0;
  double outside = 0;  // likewise, more; 0: none found
  double outside_root = 0;
  double at = 1 / std::sqrt(std::clamp(ratio, 0.25, 4.0));
  Point start = optimum_.at;
  for (int i = 0; i < kMostProfilePoints; ++i) {
    const double place = limited(coordinate, z + at * step);
    const bool at_bound = place != z + at * step;
    at = (place - z) / step;
    if (at <= inside) return place;  // the bound
    start.z[coordinate] = place;
    const Optimum least = search_.with(coordinate, start);
    if (least.interrupted) return place;
    const double root =
        least.found ? std::sqrt(std::max(0.0, least.sum - optimum_.sum)) : 10 * wanted;
    if (least.found) start = least.at;
    if (std::abs(root - wanted) <= kNear * wanted) return place;
    if (root < wanted) {
      if (at_bound) return place;
      inside = at;
      inside_root = root;
    } else {
      outside = at;
      outside_root = root;
    }
    if (outside == 0) {
      at = root > 0.1 * wanted ? std::min(2 * at, at * wanted / root * 1.05) : 2 * at;
    } else {
      const double share = (wanted - inside_root) / (outside_root - inside_root);
      at = inside + (outside - inside) * std::clamp(share, 0.1, 0.9);
    }
  }
  return limited(coordinate, z + (outside > 0 ? at : inside) * step);
}

}  // namespace hvp::fit
