#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <ceres/problem.h>

#include "models/fit/coordinates.h"

namespace hvp::fit {

// A point of the search: where one ended, or is to begin.
struct Point {
  std::vector<double> z;                 // the coordinates
  std::vector<std::vector<double>> own;  // the own unknowns of each stretch
};

struct Optimum {
  Point at;
  double sum = 0;  // Σρ of the residuals, in their unit squared
  bool found = false;
  bool converged = false;
  bool interrupted = false;
};

// Least squares of a problem's first rows by Ceres' trust region.
class Search {
 public:
  struct Range {
    std::vector<int> rows;  // the number of rows of each stretch that are fitted
    double scale = 1;       // divides the residuals, so that sums are near one
    int most_iterations = 200;
    double tolerance = 1e-14;  // relative change of the sum from one iteration to the next
  };
  // Called after each iteration with its number and Σρ so far. A return of false stops the search.
  using Progress = std::function<bool(int, double)>;

  // Keeps references to the problem and its coordinates. `progress` is called in every search.
  Search(const Problem& problem, const Coordinates& coordinates, Range range, RobustLoss loss,
         Progress progress = {});

  Optimum from(const Point& start);
  // Searches with the coordinate `held` fixed.
  Optimum with(std::size_t held, const Point& start);
  // Searches for the own unknowns only, with all coordinates fixed.
  Optimum own_alone(const Point& start);

  // Σρ at a point; empty where the model has no value.
  std::optional<double> sum(const Point& at);
  const Range& range() const { return range_; }
  int residuals() const;

 private:
  void put(const Point& at);
  Optimum solve();
  Optimum solve_with(const std::vector<int>& held);

  const Coordinates& coordinates_;
  Range range_;
  Progress progress_;
  bool rough_ = false;
  std::vector<double> z_;
  std::vector<std::vector<double>> own_;
  ceres::Problem problem_;
};

}  // namespace hvp::fit
