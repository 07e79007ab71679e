#include "models/fit/hand_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/config/input_error.h"
#include "models/fit/log_columns.h"

namespace hvp::fit {

namespace {

// The result of a least-squares regression of the force on filtered derivatives of the position.
// Where the intended motion is not known, each window by itself is freed of polynomials up to
// `degree`. `begins` is the first samples of windows, and the end. Values may be negative.
struct HandRegression {
  double mass = 0;       // kg
  double stiffness = 0;  // N/m
  double damping = 0;    // N·s/m
  // Rms in the windows.
  double force = 0, position = 0, velocity = 0, acceleration = 0;
};

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 4>;  // x″, x′, x, F

// The motion at all samples; positions and velocities are those less the intended ones, where
// known.
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

// The columns without the part that polynomials explain.
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

HandRegression hand_regression(const HandLog& log, std::size_t degree,
                               const std::vector<std::size_t>& begins) {
  const Columns all = columns_of(log);
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  double rows = 0;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    // The ends of the log are left out: the filter assumes rest there.
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

constexpr const char* kRemedy =
    "a force with frequencies around the hand's natural one (1 to 10 Hz), that changes faster than "
    "the intended motion";

Parameter factor(const char* name, const char* unit, double start, double low, double high,
                 const char* because) {
  Parameter p;
  p.name = name;
  p.unit = unit;
  p.start = std::clamp(start, low, high);
  p.low = low;
  p.high = high;
  p.because = because;
  p.logarithmic = true;
  p.draw_low = std::max(low, p.start / kDrawFactor);
  p.draw_high = std::min(high, p.start * kDrawFactor);
  p.remedy = kRemedy;
  return p;
}

std::vector<Parameter> hand_parameters(const HandRegression& found) {
  const double mass = found.force / found.acceleration;  // that alone would explain the force
  const double stiffness = found.force / found.position;
  const double damping = found.force / found.velocity;
  std::vector<Parameter> parameters{
      factor("mass", "kg", found.mass > 0 ? found.mass : 0.1 * mass, 1e-4, 100,
             "between a fingertip and more than an arm"),
      factor("stiffness", "N/m", found.stiffness > 0 ? found.stiffness : 0.1 * stiffness, 0.1, 1e6,
             "a hand that holds, softer than steel")};
  parameters[0].matters = 0.1 * mass;
  parameters[1].matters = 0.1 * stiffness;
  Parameter p;
  p.name = "damping";
  p.unit = "N·s/m";
  p.low = 0;
  p.high = 1e4;
  p.because = "it takes energy, and is less than a wall's";
  p.start = std::clamp(found.damping, 0.01 * damping, p.high);
  p.draw_low = 0;
  p.draw_high = std::min(2 * damping, p.high);
  p.matters = 0.1 * damping;
  p.remedy = kRemedy;
  parameters.push_back(p);
  return parameters;
}

}  // namespace

HandProblem::HandProblem(HandLog log, const HandOptions& options) : log_(std::move(log)) {
  std::vector<LogColumn> columns{
      {"force (N)", log_.force, "nothing tells how the hand gives way"},
      {"position (m)", log_.position, "a log of a hand that moves is needed"}};
  // A hand may mean to stay where it is.
  if (!log_.intended.empty()) columns.push_back({"intended position (m)", log_.intended, ""});
  check_columns(log_.period, columns);
  if (!(options.window > 0)) throw InputError("a window must last longer than 0 s");
  if (!(options.bandwidth >= 0)) throw InputError("a bandwidth must not be below 0 Hz");

  constexpr std::size_t kBeyond = 3;
  constexpr double kMost = 30;
  const double freedom = std::ceil(2 * options.bandwidth * options.window);
  if (!(freedom <= kMost)) {
    throw InputError(
        "an intended motion of that bandwidth has more than 30 unknowns in a window: "
        "a shorter window or a lower bandwidth is needed");
  }
  degree_ = static_cast<std::size_t>(freedom) + kBeyond;
  const std::size_t samples = log_.position.size();
  const double fewest = 4.0 * static_cast<double>(degree_ + 3);
  const auto length =
      static_cast<std::size_t>(std::clamp(std::round(options.window / log_.period), fewest,
                                          std::max(fewest, static_cast<double>(samples))));
  for (std::size_t first = 0; first == 0 || first + length / 2 < samples; first += length) {
    begins_.push_back(first);
  }
  begins_.push_back(samples);

  const HandRegression found = hand_regression(log_, degree_, begins_);
  if (found.mass <= 0 && found.stiffness <= 0) {
    throw InputError(
        "the hand moves against the force (N): that on the hand is expected, not that "
        "on the device; or are the columns swapped?");
  }
  parameters_ = hand_parameters(found);
}

Problem::Stretch HandProblem::stretch(std::size_t index) const {
  return {begins_[index + 1] - begins_[index], {}};
}

std::unique_ptr<ceres::CostFunction> HandProblem::cost(std::size_t stretch) const {
  return hand_cost(log_, degree_, begins_[stretch], begins_[stretch + 1]);
}

}  // namespace hvp::fit
