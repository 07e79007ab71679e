#pragma once

#include <cstddef>

#include "models/fit/linear.h"
#include "models/fit/search.h"

namespace hvp::fit {

// Of a coordinate, 95 %.
struct Interval {
  double low = 0;
  double high = 0;
  bool profiled = false;
};

// Intervals around an optimum: value ± t·deviation while the sum of squares rises there as that of
// a linear problem does, within a fifth; otherwise out to where its profile, the least sum of
// squares with this coordinate held, has risen as far (Bates & Watts 1988, ch. 6). The rise asked
// for has the noise's colour in it by the same factor as the deviation.
class Intervals {
 public:
  // Keeps references to all of them.
  Intervals(Search& search, const Coordinates& coordinates, const Linear& linear,
            const Uncertainty& uncertainty, const Optimum& optimum);

  // Of a linear problem.
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
