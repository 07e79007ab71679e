#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <ceres/cost_function.h>

#include "models/fit/problem.h"

namespace hvp::fit {

enum class Loss { squares, huber, cauchy };

// A loss that gives outliers less weight. Residuals r are multiplied by a weight, and `scale` is
// the size beyond which they are outliers.
struct RobustLoss {
  Loss loss = Loss::squares;
  double scale = 1;

  struct Value {
    double root;        // √ρ with r's sign, which replaces the residual in the sum of squares
    double root_slope;  // the derivative of root
    double score;       // ψ = ½·dρ/dr
    double score_slope;
  };
  Value at(double r) const;
};

// The coordinates of the search: the parameters that are not fixed, each as it is or in its
// logarithm.
class Coordinates {
 public:
  // Throws InputError: an unknown name, a value out of bounds, nothing left to search.
  Coordinates(const std::vector<Parameter>& parameters, const std::map<std::string, double>& fixed);

  std::size_t size() const { return free_.size(); }
  std::size_t parameter(std::size_t coordinate) const { return free_[coordinate]; }
  const Parameter& operator[](std::size_t coordinate) const {
    return parameters_[free_[coordinate]];
  }
  bool is_fixed(std::size_t parameter) const { return fixed_[parameter]; }

  double inner(std::size_t coordinate,
               double value) const;  // the coordinate of a parameter's value
  double outer(std::size_t coordinate, double inner) const;  // the parameter's value
  double low(std::size_t coordinate) const;                  // bounds of the coordinate
  double high(std::size_t coordinate) const;
  // All parameters in their units, at the coordinates `z`.
  std::vector<double> values(const double* z) const;
  // The derivative of a parameter's value by its coordinate, at these values.
  double slope(std::size_t coordinate, const std::vector<double>& values) const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> free_;
  std::vector<bool> fixed_;
  std::vector<double> given_;
};

// The residuals of a stretch as a function of the coordinates and the stretch's own unknowns. Those
// at `rows` and beyond are zero, and all are divided by `scale`. `weights` are Problem::weights().
class StretchCost : public ceres::CostFunction {
 public:
  StretchCost(std::unique_ptr<ceres::CostFunction> model, const std::vector<double>& weights,
              const Coordinates& coordinates, int rows, double scale, RobustLoss loss);
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> model_;
  const Coordinates& coordinates_;
  Eigen::VectorXd roots_;  // square roots of the weights
  int rows_;
  double scale_;
  RobustLoss loss_;
};

// The square roots of the weights of `rows` residuals.
Eigen::VectorXd roots_of(const std::vector<double>& weights, Eigen::Index rows);

}  // namespace hvp::fit
