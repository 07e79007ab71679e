#include "models/fit/noise.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace hvp::fit {

namespace {

constexpr Eigen::Index kHighestOrder = 20;

Eigen::Index count_of(const Series& residuals) {
  return std::accumulate(residuals.begin(), residuals.end(), Eigen::Index{0},
                         [](Eigen::Index n, const Eigen::VectorXd& r) { return n + r.size(); });
}

// Σ r_t·r_{t+k}, within stretches, for lags 0 to `most`.
std::vector<double> products(const Series& residuals, Eigen::Index most) {
  std::vector<double> sums(static_cast<std::size_t>(most) + 1, 0.0);
  for (const Eigen::VectorXd& r : residuals) {
    for (Eigen::Index k = 0; k <= std::min(most, r.size() - 1); ++k) {
      const Eigen::Index n = r.size() - k;
      sums[static_cast<std::size_t>(k)] += r.head(n).dot(r.tail(n));
    }
  }
  return sums;
}

}  // namespace

Noise noise_of(const Series& residuals, int unknowns) {
  const Eigen::Index count = count_of(residuals);
  const Eigen::Index most = std::min(kHighestOrder, count / 10);
  const std::vector<double> sums = products(residuals, most);
  const auto n = static_cast<double>(count);
  const double freedom = std::max(1.0, n - unknowns);
  Noise best{{}, sums[0] / freedom};
  if (sums[0] <= 0) return best;

  // Levinson and Durbin's recursion; the prediction's error falls with the order.
  std::vector<double> phi;
  double error = 1;
  double best_score = 0;
  for (std::size_t order = 1; order <= static_cast<std::size_t>(most); ++order) {
    double correlation = sums[order] / sums[0];
    for (std::size_t j = 0; j < phi.size(); ++j) {
      correlation -= phi[j] * sums[order - 1 - j] / sums[0];
    }
    const double reflection = correlation / error;
    if (!(std::abs(reflection) < 1)) break;
    std::vector<double> next = phi;
    for (std::size_t j = 0; j < phi.size(); ++j) {
      next[j] -= reflection * phi[phi.size() - 1 - j];
    }
    next.push_back(reflection);
    phi = std::move(next);
    error *= 1 - reflection * reflection;
    const double score = n * std::log(error) + static_cast<double>(order) * std::log(n);
    if (score < best_score) {
      best_score = score;
      best = {phi, error * sums[0] / freedom};
    }
  }
  return best;
}

// r = A⁻¹·e, so Jᵀ·Γ·J = σ²·‖A⁻ᵀ·J‖²: the recursion runs backwards through the stretch and on
// before its beginning until it has died away, as the noise did not begin there.
Eigen::MatrixXd Noise::between(const Eigen::MatrixXd& jacobian) const {
  if (coefficients.empty()) return innovation * jacobian.transpose() * jacobian;
  const auto order = static_cast<Eigen::Index>(coefficients.size());
  const Eigen::Index columns = jacobian.cols();
  Eigen::MatrixXd later = Eigen::MatrixXd::Zero(order, columns);  // row k: y at t + 1 + k
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, columns);
  const Eigen::Map<const Eigen::RowVectorXd> phi(coefficients.data(), order);
  const Eigen::Index earliest = -50 * std::max<Eigen::Index>(jacobian.rows(), 100);
  for (Eigen::Index t = jacobian.rows() - 1; t > earliest; --t) {
    Eigen::RowVectorXd y = phi * later;
    if (t >= 0) y += jacobian.row(t);
    sum += y.transpose() * y;
    for (Eigen::Index k = order - 1; k > 0; --k) later.row(k) = later.row(k - 1);
    later.row(0) = y;
    if (t < 0 && later.squaredNorm() <= 1e-12 * sum.trace()) break;
  }
  return innovation * sum;
}

Eigen::MatrixXd Noise::between(const Eigen::MatrixXd& jacobian,
                               const Eigen::VectorXd& residuals) const {
  const auto order = static_cast<Eigen::Index>(coefficients.size());
  const Eigen::Index columns = jacobian.cols();
  Eigen::MatrixXd y = jacobian;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, columns);
  for (Eigen::Index t = jacobian.rows() - 1; t >= 0; --t) {
    double e = residuals[t];
    for (Eigen::Index k = 0; k < order; ++k) {
      const double phi = coefficients[static_cast<std::size_t>(k)];
      if (t + 1 + k < jacobian.rows()) y.row(t) += phi * y.row(t + 1 + k);
      if (t - 1 - k >= 0) e -= phi * residuals[t - 1 - k];
    }
    sum += e * e * y.row(t).transpose() * y.row(t);
  }
  return sum;
}

Whiteness whiteness_of(const Series& residuals) {
  const Eigen::Index count = count_of(residuals);
  const Eigen::Index lags = std::min(kHighestOrder, count / 5);
  const std::vector<double> sums = products(residuals, lags);
  Whiteness result;
  if (lags < 1 || sums[0] <= 0) return result;
  result.lags = static_cast<int>(lags);
  const auto n = static_cast<double>(count);
  for (std::size_t k = 1; k < sums.size(); ++k) {
    const double correlation = sums[k] / sums[0];
    result.statistic += n * (n + 2) * correlation * correlation / (n - static_cast<double>(k));
  }
  const boost::math::chi_squared distribution(static_cast<double>(lags));
  result.probability = boost::math::cdf(boost::math::complement(distribution, result.statistic));
  return result;
}

double t_95(double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(std::max(1.0, degrees_of_freedom)), 0.975);
}

}  // namespace hvp::fit
