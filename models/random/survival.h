#pragma once

#include <vector>

#include "models/random/distribution.h"

namespace hvp::random {

// The survival function of a distribution: the share of the times that Source draws that are longer
// than a given one. It is a formula, so that it reaches where no number of draws does.
class Survival {
 public:
  // A measured or published distribution has its samples or points.
  explicit Survival(const TimeDistribution& distribution);

  // From 1 below the shortest time to 0 at the longest; `seconds` is any number.
  double operator()(double seconds) const;
  // The shortest time, s, of which no larger share than this is longer: to a tenth of a picosecond.
  double quantile(double share) const;

 private:
  double before_cut(double seconds) const;
  double measured(double seconds) const;
  double published(double seconds) const;

  TimeDistribution distribution_;
  std::vector<double> times_;        // measured: ascending
  std::vector<double> share_above_;  // of the same place: the share of longer times
  double tail_share_ = 0;
  double low_ = 0;   // of the distribution before it is cut off: the share above its minimum
  double high_ = 0;  // and its maximum
};

}  // namespace hvp::random
