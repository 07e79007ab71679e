#include "models/fit/hand_regression.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "models/fit/low_pass.h"

namespace hvp::fit {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 4>;  // x″, x′, x, F

// Of all samples; positions and velocities are those less the intended ones, where known.
Columns columns_of(const HandLog& log) {
  constexpr double kHighest = 40;  // Hz
  constexpr double kOfSampling = 0.1;
  const double cutoff = std::min(kHighest * log.period, kOfSampling);
  const std::size_t n = log.position.size();
  std::vector<double> x(n), stretched(n);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = log.position[i] - log.position[0];
    stretched[i] = log.intended.empty() ? x[i] : log.position[i] - log.intended[i];
  }
  x = low_passed(x, cutoff);
  stretched = low_passed(stretched, cutoff);
  const std::vector<double> force = low_passed(log.force, cutoff);
  Columns columns = Columns::Zero(static_cast<Eigen::Index>(n), 4);
  const double h = log.period;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    columns.row(static_cast<Eigen::Index>(i)) << (x[i + 1] - 2 * x[i] + x[i - 1]) / (h * h),
        (stretched[i + 1] - stretched[i - 1]) / (2 * h), stretched[i], force[i];
  }
  return columns;
}

// Without what polynomials explain of them.
Columns without_polynomials(const Columns& columns, std::size_t degree) {
  const Eigen::Index rows = columns.rows();
  Eigen::MatrixXd basis(rows, static_cast<Eigen::Index>(degree) + 1);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::vector<double> row =
        legendre(degree, 2 * static_cast<double>(i) / static_cast<double>(rows - 1) - 1);
    basis.row(i) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), basis.cols());
  }
  return columns - basis * basis.householderQr().solve(columns);
}

}  // namespace

HandRegression hand_regression(const HandLog& log, std::size_t degree,
                               const std::vector<std::size_t>& begins) {
  const Columns all = columns_of(log);
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  double rows = 0;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    // The filter is settled on what is not so at the ends of the log.
    const auto first = static_cast<Eigen::Index>(std::max<std::size_t>(begins[i], 1));
    const auto last = static_cast<Eigen::Index>(std::min(begins[i + 1], log.position.size() - 1));
    Columns window = all.middleRows(first, last - first);
    if (log.intended.empty()) window = without_polynomials(window, degree);
    gram += window.transpose() * window;
    rows += static_cast<double>(last - first);
  }
  const Eigen::Vector4d rms = (gram.diagonal() / rows).cwiseSqrt();
  const Eigen::Vector3d scale = rms.head<3>().cwiseMax(1e-300).cwiseInverse();
  const Eigen::Matrix3d left = scale.asDiagonal() * gram.topLeftCorner<3, 3>() * scale.asDiagonal();
  const Eigen::Vector3d right = scale.asDiagonal() * gram.topRightCorner<3, 1>();
  const Eigen::Vector3d values = scale.asDiagonal() * left.fullPivLu().solve(right);
  return {values[0], values[2], values[1], rms[3], rms[2], rms[1], rms[0]};
}

}  // namespace hvp::fit
