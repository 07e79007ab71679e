#include "vp/frame/rare_misses.h"

namespace hvp::vp {

void RareMisses::closed(const Frame& frame, const CriticalPath& /*path*/) {
  if (!frame.solved()) {
    ++left_out_;
    if (since_ < 0) since_ = frame.number;
    return;
  }
  const bool late = frame.latency() > budget_;
  ++frames_;
  if (!late && !frame.beyond_tick) {
    since_ = -1;
    return;
  }
  if (since_ < 0) since_ = frame.number;
  if (late) late_.push_back({since_, frame.number});
}

double RareMisses::late() const {
  double sum = 0;
  for (const Late& one : late_) sum += tilt_.weight(one.since - kBefore, one.frame + kAfter);
  return sum;
}

}  // namespace hvp::vp
