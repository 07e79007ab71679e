#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace hvp::draw {

// A line through many samples as a picture needs it: of the samples in each of `columns` equal
// parts of [from, to] the first, the least, the largest and the last, in their order. So what
// swings within a column stays as high as it is (M4: Jugel, Jerzak, Hackenbroich and Markl,
// Proc. VLDB Endowment 7, 2014). A value that is not finite ends a stroke. `x` ascends and has the
// size of `y`; from < to.
std::vector<std::vector<Eigen::Vector2d>> strokes(std::span<const double> x,
                                                  std::span<const double> y, double from, double to,
                                                  int columns);

// A stretch of the x axis.
struct Stretch {
  double from = 0.0;
  double to = 0.0;
};

// Where y < level: from each such sample to the one after it. Two of them that are less than `gap`
// apart are one.
std::vector<Stretch> stretches_below(std::span<const double> x, std::span<const double> y,
                                     double level, double gap);

}  // namespace hvp::draw
