#include "models/fit/coordinates.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::string names_of(const std::vector<Parameter>& parameters) {
  std::string names;
  for (const Parameter& p : parameters) names += (names.empty() ? "" : ", ") + p.name;
  return names;
}

}  // namespace

RobustLoss::Value RobustLoss::at(double r) const {
  const double s = r / scale;
  if (loss == Loss::huber && std::abs(s) > 1) {
    const double sign = s < 0 ? -1 : 1;
    const double root = std::sqrt(2 * std::abs(s) - 1);
    return {sign * scale * root, 1 / root, sign * scale, 0};
  }
  if (loss == Loss::cauchy) {
    const double square = s * s;
    const double weight = 1 / (1 + square);
    // √(ln(1 + s²)) ≈ s·(1 − s²/4) where the root's own slope would be 0/0.
    const double root =
        square < 1e-8 ? s * (1 - square / 4) : std::copysign(std::sqrt(std::log1p(square)), s);
    const double root_slope = square < 1e-8 ? 1 - 0.75 * square : s * weight / root;
    return {scale * root, root_slope, r * weight, (1 - square) * weight * weight};
  }
  return {r, 1, r, 1};
}

Coordinates::Coordinates(const std::vector<Parameter>& parameters,
                         const std::map<std::string, double>& fixed)
    : parameters_(parameters), fixed_(parameters.size(), false), given_(parameters.size(), 0.0) {
  for (const auto& one : fixed) {
    const std::string& name = one.first;
    const double value = one.second;
    const auto found = std::find_if(parameters_.begin(), parameters_.end(),
                                    [&](const Parameter& p) { return p.name == name; });
    if (found == parameters_.end()) {
      throw InputError(
          "fix", fmt::format("there is no parameter {}, only {}", name, names_of(parameters_)));
    }
    if (!(value >= found->low && value <= found->high)) {
      throw InputError("fix", fmt::format("{} = {:g} {}: expected {:g} to {:g}: {}", name, value,
                                          found->unit, found->low, found->high, found->because));
    }
    const auto index = static_cast<std::size_t>(found - parameters_.begin());
    fixed_[index] = true;
    given_[index] = value;
  }
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (!fixed_[i]) free_.push_back(i);
  }
  if (free_.empty()) throw InputError("fix", "every parameter is fixed: nothing is left to fit");
}

double Coordinates::inner(std::size_t coordinate, double value) const {
  return (*this)[coordinate].logarithmic ? std::log(value) : value;
}

double Coordinates::outer(std::size_t coordinate, double inner) const {
  return (*this)[coordinate].logarithmic ? std::exp(inner) : inner;
}

double Coordinates::low(std::size_t coordinate) const {
  return inner(coordinate, (*this)[coordinate].low);
}

double Coordinates::high(std::size_t coordinate) const {
  return inner(coordinate, (*this)[coordinate].high);
}

std::vector<double> Coordinates::values(const double* z) const {
  std::vector<double> values = given_;
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const Parameter& p = parameters_[free_[k]];
    // Rounding in exp(log(bound)) does not leave the bounds.
    values[free_[k]] = std::clamp(outer(k, z[k]), p.low, p.high);
  }
  return values;
}

double Coordinates::slope(std::size_t coordinate, const std::vector<double>& values) const {
  return (*this)[coordinate].logarithmic ? values[free_[coordinate]] : 1;
}

Eigen::VectorXd roots_of(const std::vector<double>& weights, Eigen::Index rows) {
  if (weights.empty()) return Eigen::VectorXd::Ones(rows);
  return Eigen::Map<const Eigen::VectorXd>(weights.data(), rows).cwiseSqrt();
}

StretchCost::StretchCost(std::unique_ptr<ceres::CostFunction> model,
                         const std::vector<double>& weights, const Coordinates& coordinates,
                         int rows, double scale, RobustLoss loss)
    : model_(std::move(model)),
      coordinates_(coordinates),
      roots_(roots_of(weights, model_->num_residuals())),
      rows_(rows),
      scale_(scale),
      loss_(loss) {
  set_num_residuals(model_->num_residuals());
  *mutable_parameter_block_sizes() = model_->parameter_block_sizes();
  mutable_parameter_block_sizes()->front() = static_cast<int>(coordinates.size());
}

bool StretchCost::Evaluate(const double* const* blocks, double* residuals,
                           double** jacobians) const {
  const std::vector<double> values = coordinates_.values(blocks[0]);
  const std::vector<std::int32_t>& sizes = model_->parameter_block_sizes();
  const auto rows = static_cast<Eigen::Index>(model_->num_residuals());
  const bool has_own = sizes.size() > 1;
  std::vector<const double*> inner{values.data()};
  if (has_own) inner.push_back(blocks[1]);
  const bool wanted = jacobians != nullptr;
  Rows by_values;
  std::vector<double*> slopes{nullptr, nullptr};
  if (wanted) {
    by_values.resize(rows, sizes.front());
    slopes = {by_values.data(), has_own ? jacobians[1] : nullptr};
  }
  if (!model_->Evaluate(inner.data(), residuals, wanted ? slopes.data() : nullptr)) return false;

  Eigen::VectorXd weight(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const RobustLoss::Value value = loss_.at(roots_[i] * residuals[i]);
    const bool fitted = i < rows_;
    residuals[i] = fitted ? value.root / scale_ : 0;
    weight[i] = fitted ? roots_[i] * value.root_slope / scale_ : 0;
  }
  if (!wanted) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Rows> by_coordinates(jacobians[0], rows,
                                    static_cast<Eigen::Index>(coordinates_.size()));
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      by_coordinates.col(static_cast<Eigen::Index>(k)) =
          coordinates_.slope(k, values) *
          weight.cwiseProduct(by_values.col(static_cast<Eigen::Index>(coordinates_.parameter(k))));
    }
  }
  if (has_own && jacobians[1] != nullptr) {
    Eigen::Map<Rows> by_own(jacobians[1], rows, sizes[1]);
    by_own.array().colwise() *= weight.array();
  }
  return true;
}

}  // namespace hvp::fit
