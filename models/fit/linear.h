#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/fit/noise.h"
#include "models/fit/search.h"

namespace hvp::fit {

// A problem near an optimum, as a linear one with noise.
struct Linear {
  Series residuals;  // of each stretch, rows that were fitted
  Series weighted;   // by the roots of their weights
  Series scores;  // what a robust loss makes of them: ψ/mean ψ'; the residuals themselves without
  std::vector<Eigen::MatrixXd> jacobian;  // d weighted/d z, without what own unknowns take up
  std::vector<Eigen::MatrixXd> follows;   // d own/d z, where the sum of squares stays least
  double slope = 1;                       // mean ψ'
  int rows = 0;
  int own = 0;  // unknowns
};
Linear linearise(const Problem& problem, const Coordinates& coordinates,
                 const std::vector<int>& rows, const Point& at, const RobustLoss& loss);

// How far the coordinates may be off.
struct Uncertainty {
  Noise noise;
  double t = 2;                // of Student's distribution, 95 %
  Eigen::MatrixXd unit;        // (JᵀJ)⁻¹, without directions that have no effect
  Eigen::MatrixXd covariance;  // (JᵀJ)⁻¹·JᵀΓJ·(JᵀJ)⁻¹
  std::vector<bool> singular;  // coordinates that such a direction has
  double widened = 1;          // largest ratio of a standard deviation to that of white noise

  double deviation(std::size_t coordinate) const;
};
Uncertainty uncertainty_of(const Linear& linear);

}  // namespace hvp::fit
