#include "app/results/latency.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/report.h"

namespace hvp::results {

using statistics::spread_of;

LatencyFigures latency_figures(const vp::Verdict& verdict, const vp::LatencyStatistics& statistics,
                               const host::Host& host) {
  LatencyFigures f;
  f.best = statistics.best();
  f.p50 = verdict.percentile(0.50);
  f.p90 = verdict.percentile(0.90);
  f.p99 = verdict.percentile(0.99);
  f.p99_9 = verdict.percentile(0.999);
  f.worst = verdict.worst_latency();
  f.mean = statistics.latency().mean();
  f.histogram = statistics.latency().parts();
  f.change = spread_of(statistics.change());
  if (host.jitter) f.release = spread_of(verdict.release());
  if (host.wake_up) f.wake_up = spread_of(verdict.wake_up());

  // At least 1 ps, so that the shares are zero where nothing takes time.
  const double whole = std::max(f.mean, 1.0);
  for (std::size_t i = 0; i < vp::kParts; ++i) {
    const auto part = static_cast<vp::Part>(i);
    const statistics::Histogram& times = statistics.part(part);
    if (times.largest() == 0) continue;
    f.by_part.push_back({name(part), {}, 0, spread_of(times), times.mean() / whole, times.parts()});
    for (const vp::LatencyStatistics::PathTime& p : statistics.on_path()) {
      if (p.part != part || p.frames == 0) continue;
      f.by_phase.push_back(
          {name(p.part), name(p.phase), p.frames, spread_of(p.times), p.times.mean() / whole});
    }
  }
  const auto by_mean = [](const PathShare& a, const PathShare& b) {
    return a.time.mean > b.time.mean;
  };
  std::stable_sort(f.by_phase.begin(), f.by_phase.end(), by_mean);
  for (const vp::LatencyStatistics::Transactions& t : statistics.transactions()) {
    f.by_transaction.push_back(
        {name(t.phase), t.times.count(), spread_of(t.times), t.times.octaves()});
  }
  return f;
}

void TransactionTimes::report(config::Figures& f) const {
  f.text("transaction", phase, "`arbitration` is waiting for the bus");
  f.count("count", count, "how many");
  f.report(time);
  statistics::report_octaves(f, octaves, "count");
}

void LatencyFigures::report(config::Figures& f) const {
  f.time("best_us", best, "the shortest");
  f.mean_time("mean_us", mean, "their mean");
  f.table("percentiles",
          "latencies that occurred, exact to the picosecond; where more than 65 536 different ones "
          "occurred, p50 to p99.9 are right within one part in 64",
          [&] {
            f.time("p50_us", p50, "half of the frames are within it");
            f.time("p90_us", p90, "90 %");
            f.time("p99_us", p99, "99 %");
            f.time("p99_9_us", p99_9, "99.9 %");
            f.time("worst_us", worst, "all");
          });
  statistics::report_histogram(f, histogram);
  f.list("by_part",
         "time on the critical path: of all frames, zero where a frame had none of it, so that the "
         "means sum to the mean latency. A percentile is the upper end of its bin",
         by_part, [&](const PathShare& s) {
           f.text("part", s.part, "whose time");
           f.report(s.time);
           f.ratio("share", s.share, "of the mean latency");
           statistics::report_histogram(f, s.histogram);
         });
  f.list("by_phase", "likewise, the largest mean first", by_phase, [&](const PathShare& s) {
    f.text("part", s.part, "whose time");
    f.text("phase", s.phase, "what for");
    f.count("frames", s.frames, "in how many it took time");
    f.report(s.time);
    f.ratio("share", s.share, "of the mean latency");
  });
  f.list("by_transaction",
         "each span on the bus by itself, whether its frame waited for it or not. The transfers of "
         "set-up are not in it",
         by_transaction);
}

void LatencyFigures::report_jitter(config::Figures& f) const {
  f.table("frame_to_frame",
          "by how much a frame's latency differs from that of the frame before it, whichever is "
          "longer",
          change);
  f.table_if_present("release",
                     "with `[host.jitter]`: of each frame, what lay between its tick and its "
                     "release, the delay that a late frame before it left, too",
                     release);
  f.table_if_present("wake_up", "with `[host.wake_up]`: of each frame, between ready and running",
                     wake_up);
}

namespace {

using Out = std::back_insert_iterator<std::string>;

void path_line(Out out, std::string_view what, const PathShare& s) {
  fmt::format_to(out, "  {:<22} {:>10} {:>11} {:>11}  {:>5.1f} %", what, readable_time(s.time.p50),
                 readable_time(s.time.p99), readable_time(s.time.worst), 100 * s.share);
}

}  // namespace

std::string parts_text(const LatencyFigures& f) {
  std::string text;
  const Out out = std::back_inserter(text);
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>7}\n", "Every frame  by part", "median",
                 "99 %", "worst", "of mean");
  std::vector<PathShare> parts = f.by_part;
  std::stable_sort(parts.begin(), parts.end(), [](const PathShare& a, const PathShare& b) {
    return a.time.mean > b.time.mean;
  });
  for (const PathShare& part : parts) {
    path_line(out, part.part, part);
    text += '\n';
  }
  return text;
}

std::string details_text(const LatencyFigures& f) {
  std::string text;
  const Out out = std::back_inserter(text);
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>7} {:>9}\n", "Every frame  by phase",
                 "median", "99 %", "worst", "of mean", "frames");
  for (const PathShare& phase : f.by_phase) {
    path_line(out, fmt::format("{} {}", phase.part, phase.phase), phase);
    fmt::format_to(out, " {:>9}\n", phase.frames);
  }
  if (f.by_transaction.empty()) return text;
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>10} {:>6}\n", "Bus          each",
                 "median", "99 %", "worst", "mean", "count");
  for (const TransactionTimes& t : f.by_transaction) {
    fmt::format_to(out, "  {:<22} {:>10} {:>11} {:>11}  {:>10} {:>6}\n", t.phase,
                   readable_time(t.time.p50), readable_time(t.time.p99),
                   readable_time(t.time.worst),
                   readable_time(static_cast<vp::Picoseconds>(t.time.mean)), t.count);
  }
  return text;
}

}  // namespace hvp::results
