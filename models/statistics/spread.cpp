#include "models/statistics/spread.h"

namespace hvp::statistics {

Spread spread_of(const Histogram& times) {
  return {times.percentile(0.50), times.percentile(0.99), times.largest(), times.mean()};
}

void Spread::report(config::Figures& f) const {
  f.time("p50_us", p50, "half of them are at most this");
  f.time("p99_us", p99, "99 % of them are at most this");
  f.time("worst_us", worst, "the largest");
  f.mean_time("mean_us", mean, "their mean");
}

void report_octaves(config::Figures& f, const std::vector<Histogram::Octave>& octaves,
                    std::string_view counted) {
  f.list("octaves", "by size; octaves without any are left out", octaves,
         [&](const Histogram::Octave& octave) {
           f.time("from_us", octave.from, "at least this, and less than twice that");
           f.count(counted, octave.count, "how many");
         });
}

void report_histogram(config::Figures& f, const std::vector<Histogram::Part>& parts) {
  f.list("histogram", "a bin is one part in 64 of its octave wide; empty ones are left out", parts,
         [&](const Histogram::Part& part) {
           f.time("from_us", part.from, "at least this");
           f.time("below_us", part.below, "and less than this");
           f.count("frames", part.count, "how many frames");
         });
}

}  // namespace hvp::statistics
