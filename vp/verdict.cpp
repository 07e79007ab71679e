#include "vp/verdict.h"

#include <algorithm>
#include <cmath>

namespace hvp::vp {

namespace {
Picoseconds time_in(const Frame& frame, const std::vector<SpanId>& path, Phase phase) {
  Picoseconds time = 0;
  for (const SpanId id : path) {
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    if (span.phase == phase) time += span.end - span.start;
  }
  return time;
}
}  // namespace

void Verdict::take(const Frame& frame, const std::vector<SpanId>& path) {
  ++frames_;
  const Picoseconds latency = frame.latency();
  count(latency);
  if (latency > budget_) lateness_.add(latency - budget_);
  // A force that was held from an earlier frame is not this frame's, however early it is there.
  if (!frame.solved) {
    ++unsolved_;
  } else if (latency > budget_) {
    ++late_;
  }
  release_.add(time_in(frame, path, Phase::release));
  wake_up_.add(time_in(frame, path, Phase::wake_up));
  const Picoseconds load = frame.work_done - frame.born;
  worst_load_ = std::max(worst_load_, load);
  if (load > period_) ++overloads_;
  if (latency <= worst_) return;
  worst_ = latency;
  worst_frame_ = frame.number;
  attribution_.clear();
  for (const SpanId id : path) {
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    const auto same = std::find_if(attribution_.begin(), attribution_.end(), [&](const auto& a) {
      return a.part == span.part && a.phase == span.phase;
    });
    if (same != attribution_.end()) {
      same->time += span.end - span.start;
    } else {
      attribution_.push_back({span.part, span.phase, span.end - span.start});
    }
  }
}

void Verdict::count(Picoseconds latency) {
  all_latencies_.add(latency);
  if (!exact_) return;
  ++latencies_[latency];
  if (latencies_.size() <= kMostLatencies) return;
  exact_ = false;
  latencies_.clear();
}

Picoseconds Verdict::percentile(double share) const {
  if (!exact_) return all_latencies_.percentile(share);
  const auto wanted = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(frames_)));
  std::int64_t seen = 0;
  for (const auto& [latency, count] : latencies_) {
    seen += count;
    if (seen >= wanted) return latency;
  }
  return 0;
}

}  // namespace hvp::vp
