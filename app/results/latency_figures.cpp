#include "app/results/latency_figures.h"

#include <algorithm>
#include <array>

namespace hvp::results {

Spread spread_of(const statistics::Histogram& times) {
  return {times.percentile(0.50), times.percentile(0.99), times.largest(), times.mean()};
}

LatencyFigures latency_figures(const vp::Verdict& verdict,
                               const vp::LatencyStatistics& statistics) {
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

  // Where nothing takes time there is no share of it.
  const double whole = std::max(f.mean, 1.0);
  for (const vp::Part part :
       {vp::Part::host, vp::Part::bus, vp::Part::fpga, vp::Part::daq, vp::Part::device}) {
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

}  // namespace hvp::results
