#pragma once

#include <cstdint>

#include "models/config/figures.h"

namespace hvp::statistics {

// A share that was found in so many independent trials, with its interval.
struct Proportion {
  double share = 0;
  double low = 0;
  double high = 1;

  void report(config::Figures& f) const;
};

// A share as far as it is told: in three digits, counted from the nearer end, up or down, so that
// the last bits of a library's functions do not show.
enum class Rounding { down, nearest, up };
double rounded_share(double share, Rounding rounding);

// The exact 95 % interval of a binomial share (Clopper & Pearson, Biometrika 26, 1934). Where
// nothing was found, or all, it is one-sided: of 1000 trials without a find at most 0.3 % are to be
// expected. Rounded outwards to three digits. `found` <= `trials`, `trials` > 0.
Proportion proportion_of(std::int64_t found, std::int64_t trials);

}  // namespace hvp::statistics
