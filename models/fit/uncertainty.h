#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/fit/noise.h"
#include "models/fit/search.h"

namespace hvp::fit {

// A problem linearised at an optimum, with its noise.
struct Linear {
  // The fitted rows of each stretch: the residuals, these times the roots of their
  // weights, and these again as a robust loss counts them, ψ/mean ψ' (unchanged without one).
  Series residuals;
  Series weighted;
  Series scores;
  // d weighted/d z, without the directions of the own unknowns.
  std::vector<Eigen::MatrixXd> jacobian;
  // d own/d z along which the sum of squares stays least.
  std::vector<Eigen::MatrixXd> follows;
  double slope = 1;  // mean ψ'
  int rows = 0;
  int own = 0;  // number of own unknowns
};
Linear linearise(const Problem& problem, const Coordinates& coordinates,
                 const std::vector<int>& rows, const Point& at, const RobustLoss& loss);

// The uncertainty of the coordinates.
struct Uncertainty {
  Noise noise;
  double t = 2;                // the two-sided 95 % point of Student's distribution
  Eigen::MatrixXd unit;        // (JᵀJ)⁻¹, without directions that have no effect
  Eigen::MatrixXd covariance;  // (JᵀJ)⁻¹·JᵀΓJ·(JᵀJ)⁻¹
  std::vector<bool> singular;  // coordinates that take part in such a direction
  double widened = 1;          // the largest ratio of a standard deviation to that for white noise

  double deviation(std::size_t coordinate) const;
};
Uncertainty uncertainty_of(const Linear& linear);

// The 95 % interval of a coordinate.
struct Interval {
  double low = 0;
  double high = 0;
  bool profiled = false;
};

// Intervals around an optimum. An interval is value ± t·deviation where the sum of squares at its
// ends rises as that of a linear problem does, within a fifth. Otherwise it ends where the profile,
// which is the least sum of squares with this coordinate fixed, has risen as far (Bates & Watts
// 1988, ch. 6). The required rise accounts for the noise's colour by the same factor as the
// deviation.
class Intervals {
 public:
  // Keeps references to all arguments.
  Intervals(Search& search, const Coordinates& coordinates, const Linear& linear,
            const Uncertainty& uncertainty, const Optimum& optimum);

  // The interval of a linear problem.
  Interval plain(std::size_t coordinate) const;
  Interval of(std::size_t coordinate);

 private:
  Point moved(std::size_t coordinate, double step) const;
  double end(std::size_t coordinate, double step, double ratio);
  double limited(std::size_t coordinate, double z) const;

  Search& search_;
  const Coordinates& coordinates_;
  const Linear& linear_;
  const Uncertainty& uncertainty_;
  const Optimum& optimum_;
};

}  // namespace hvp::fit
