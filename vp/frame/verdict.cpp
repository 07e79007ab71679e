#include "vp/frame/verdict.h"

#include <algorithm>
#include <cmath>

#include "models/statistics/histogram.h"

namespace hvp::vp {

void Verdict::closed(const Frame& frame, const CriticalPath& path) {
  ++frames_;
  const Picoseconds latency = frame.latency();
  count(latency);
  if (latency > budget_) lateness_.add(latency - budget_);
  // A force that was held from an earlier frame is not this frame's, however early it is there.
  if (!frame.solved()) {
    ++unsolved_;
  } else if (latency > budget_) {
    ++late_;
  }
  release_.add(path.time(Phase::release));
  wake_up_.add(path.time(Phase::wake_up));
  const Picoseconds load = frame.work_done - frame.born;
  worst_load_ = std::max(worst_load_, load);
  if (load > period_) ++overloads_;
  if (latency <= worst_) return;
  worst_ = latency;
  worst_frame_ = frame.number;
  attribution_ = path.attribution();
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

statistics::Proportion Verdict::miss_share() const {
  const std::int64_t ticks = frames_ + skipped_;
  return ticks > 0 ? statistics::proportion_of(misses(), ticks) : statistics::Proportion{};
}

void Verdict::report_deadline(config::Figures& f) const {
  f.time("period_us", period_, "from tick to tick");
  f.time("budget_us", budget_, "from a tick until its force is due");
  f.time("worst_us", worst_, "of all frames");
  f.time("p50_us", percentile(0.50), "half of the frames are within it");
  f.time("p99_us", percentile(0.99), "99 % of the frames are within it");
  f.time("p999_us", percentile(0.999), "99.9 % of the frames are within it");
  f.count("misses", misses(), "late forces, skipped ticks, and frames whose solve failed");
  f.count("frames", frames_, "ticks that had a frame");
  f.count("skipped_ticks", skipped_, "ticks that had none");
  f.table("miss_share", "Misses over ticks.", miss_share());
  f.count("worst_frame", worst_frame_, "number of the frame with the worst latency");
}

void Verdict::report_lateness(config::Figures& f) const {
  std::optional<statistics::Spread> spread;
  if (lateness_.count() > 0) spread = statistics::spread_of(lateness_);
  f.table_or_null(
      "lateness",
      "of late forces only, held ones too: by how much they were late; null where none "
      "was. Percentiles are right within one part in 64, the worst and the mean exactly",
      spread, [&](const statistics::Spread& late) {
        late.report(f);
        statistics::report_octaves(f, lateness_.octaves(), "frames");
      });
}

void Verdict::report_load(config::Figures& f) const {
  f.time("worst_us", worst_load_, "of all frames");
  f.count("misses", overloads(), "frames beyond the period, and skipped ticks");
  f.truth("held", load_held(), "there are none");
}

void Verdict::report_attribution(config::Figures& f) const {
  f.list("attribution",
         "The worst frame's critical path, by part and phase; sums to `deadline.worst_us`.",
         attribution_, [&](const Attribution& a) {
           f.text("part", name(a.part), "who took the time");
           f.text("phase", name(a.phase), "what for");
           f.time("us", a.time, "how long");
         });
}

}  // namespace hvp::vp
