#include "models/statistics/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hvp::statistics {

namespace {
constexpr int kPartBits = 6;
}

// The octave's number above the six bits below the leading one.
std::size_t Histogram::part(std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(std::max<std::int64_t>(value, 0));
  if (bits < kParts) return static_cast<std::size_t>(bits);
  const int shift = static_cast<int>(std::bit_width(bits)) - 1 - kPartBits;
  return static_cast<std::size_t>((bits >> static_cast<unsigned>(shift)) - kParts) +
         static_cast<std::size_t>(kParts) * static_cast<std::size_t>(shift + 1);
}

std::int64_t Histogram::upper_end(std::size_t part) {
  if (part < kParts) return static_cast<std::int64_t>(part);
  const auto shift = static_cast<unsigned>(part / kParts - 1);
  const auto next = static_cast<std::uint64_t>(part % kParts + kParts + 1);
  return static_cast<std::int64_t>((next << shift) - 1);
}

void Histogram::add(std::int64_t value, std::int64_t times) {
  if (times == 0) return;
  counts_[part(value)] += times;
  count_ += times;
  largest_ = std::max(largest_, value);
  sum_ += static_cast<double>(value) * static_cast<double>(times);
}

std::int64_t Histogram::percentile(double share) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += counts_[i];
    if (seen >= wanted && seen > 0) return std::min(upper_end(i), largest_);
  }
  return 0;
}

std::vector<Histogram::Part> Histogram::parts() const {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] == 0) continue;
    parts.push_back({i == 0 ? 0 : upper_end(i - 1) + 1, upper_end(i) + 1, counts_[i]});
  }
  return parts;
}

std::vector<Histogram::Octave> Histogram::octaves() const {
  std::vector<Octave> octaves;
  const auto add = [&octaves](std::int64_t from, std::int64_t count) {
    if (count > 0) octaves.push_back({from, count});
  };
  // Below 64 an octave is a run of parts.
  add(0, counts_[0]);
  for (std::size_t from = 1; from < kParts; from *= 2) {
    std::int64_t count = 0;
    for (std::size_t i = from; i < 2 * from; ++i) count += counts_[i];
    add(static_cast<std::int64_t>(from), count);
  }
  for (std::size_t i = kParts; i < counts_.size(); i += kParts) {
    std::int64_t count = 0;
    for (std::size_t j = i; j < i + kParts; ++j) count += counts_[j];
    add(static_cast<std::int64_t>(std::uint64_t{kParts} << (i / kParts - 1)), count);
  }
  return octaves;
}

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
