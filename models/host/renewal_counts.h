#pragma once

#include <cstdint>

namespace hvp::host {

// What became of the renewals of a matrix.
struct RenewalCounts {
  std::int64_t renewed = 0;
  std::int64_t undefined = 0;     // not made: an element had no tangent, or the matrix no factors
  std::int64_t beyond = 0;        // not made: entries did not fit their words
  std::int64_t words_beyond = 0;  // those entries, of all renewals
  std::int64_t projected = 0;     // elements that were indefinite, the most in a renewal
  double growth = 0;              // largest entry of any, over that of the body at rest
};

}  // namespace hvp::host
