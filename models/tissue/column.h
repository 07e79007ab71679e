#pragma once

#include <optional>
#include <span>
#include <vector>

#include "models/tissue/law.h"
#include "models/tissue/prony.h"

namespace hvp::tissue {

// A specimen in one dimension: a column between two plates that do not hold its sides, so that it
// is strained alike everywhere. It is what a law says of a test in compression without a mesh.
class Column {
 public:
  // Throws InputError naming "area" or "height" for one that is not above zero and finite.
  Column(const Law& law, double area_m2, double height_m);

  // The force (N) on a plate that has gone down by `depth_m`, without relaxation, above zero where
  // the column is pressed; 0 where the plate is off it. Nothing where the law is not defined or the
  // column has no height left.
  std::optional<double> force(double depth_m) const;

 private:
  std::optional<double> stress(double stretch) const;

  Law law_;
  double area_m2_;
  double height_m_;
};

// The forces (N) at the end of each frame of `series` for the depths (m) at the end of each; what
// the first depth presses has relaxed. Nothing where Column::force() has nothing.
std::optional<std::vector<double>> forces_over_time(const Column& column, const PronySeries& series,
                                                    std::span<const double> depth);

}  // namespace hvp::tissue
