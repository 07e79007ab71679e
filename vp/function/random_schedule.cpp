#include "vp/function/random_schedule.h"

#include "models/random/distribution.h"

namespace hvp::vp {

RandomSchedule::RandomSchedule(std::int64_t seed, std::string_view stream, double longest_s)
    : draws_(seed, stream),
      log_shortest_(random::natural_log(kShortest)),
      log_ratio_(random::natural_log(longest_s / kShortest)) {}

Picoseconds RandomSchedule::next() {
  const random::Draws::Pair u = draws_.nth(drawn_++);
  if (u.first >= kShareDelayed) return 0;
  return to_picoseconds(random::exponential(log_shortest_ + u.second * log_ratio_));
}

}  // namespace hvp::vp
