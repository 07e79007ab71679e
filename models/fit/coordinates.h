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

// Less weight for outliers: the residual r counts as r·weight, with a scale beyond which it is one.
struct RobustLoss {
  Loss loss = Loss::squares;
  double scale = 1;

  struct Value {
    double root;  // √ρ, with r's sign: what takes the residual's place in the sum of squares
    double root_slope;  // its derivative
    double score;       // ψ = ½·dρ/dr
    double score_slope;
  };
  Value at(double r) const;
};

// What is searched: the parameters that are not fixed, each as it is or in its logarithm.
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

  double inner(std::size_t coordinate, double value) const;  // of a parameter's value
  double outer(std::size_t coordinate, double inner) const;  // and back
  double low(std::size_t coordinate) const;                  // of the coordinate
  double high(std::size_t coordinate) const;
  // All parameters in their units; `z`: of the coordinates.
  std::vector<double> values(const double* z) const;
  // d value/d coordinate at these values.
  double slope(std::size_t coordinate, const std::vector<double>& values) const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> free_;
  std::vector<bool> fixed_;
  std::vector<double> given_;
};

// A stretch's residuals as a function of the coordinates and its own unknowns; those at `rows` and
// beyond are zero, and all are divided by `scale`. `weights` as Problem's.
class StretchCost : public ceres::CostFunction {
 public:
  StretchCost(std::unique_ptr<ceres::CostFunction> model, const std::vector<double>& weights,
              const Coordinates& coordinates, int rows, double scale, RobustLoss loss);
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> model_;
  const Coordinates& coordinates_;
  Eigen::VectorXd roots_;  // of the weights
  int rows_;
  double scale_;
  RobustLoss loss_;
};

// Of the weights of `rows` residuals.
Eigen::VectorXd roots_of(const std::vector<double>& weights, Eigen::Index rows);

}  // namespace hvp::fit
