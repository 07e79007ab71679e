#include "models/fit/wake_up_histogram.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

namespace {

constexpr double kLongestLatency = 1;                   // s
constexpr std::int64_t kMostCount = 1'000'000'000'000;  // of a cell: no sum overflows

struct Row {
  double latency = 0;  // in the file's unit
  std::vector<std::int64_t> counts;
  std::size_t line = 0;
};

std::vector<std::string_view> cells(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> result;
  while (true) {
    const std::size_t begin = line.find_first_not_of(separators);
    if (begin == std::string_view::npos) return result;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    result.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

template <class Number>
std::optional<Number> number(std::string_view cell) {
  Number value{};
  const char* const end = cell.data() + cell.size();
  const auto [stopped, error] = std::from_chars(cell.data(), end, value);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

// The unit of "latency_us,count", in s; none: no such header.
std::optional<double> unit_of_header(std::string_view line) {
  constexpr std::array<std::pair<std::string_view, double>, 4> kHeaders{
      {{"latency_s", 1}, {"latency_ms", 1e-3}, {"latency_us", 1e-6}, {"latency_ns", 1e-9}}};
  const std::vector<std::string_view> names = cells(line, ", \t\r");
  if (names.size() != 2 || names[1] != "count") return std::nullopt;
  for (const auto& header : kHeaders) {
    if (names[0] == header.first) return header.second;
  }
  return std::nullopt;
}

// The lines that cyclictest prints of its threads while it runs.
bool is_progress(std::string_view line) {
  return line.starts_with("T:") || line.starts_with("policy:");
}

std::string shown(std::string_view line) { return std::string(line.substr(0, 40)); }

class Reading {
 public:
  WakeUpHistogram read(std::string_view text);

 private:
  void comment(std::string_view line);
  void row(std::string_view line);
  void drop_column_of_sums();
  void fill_bins();

  double unit_ = 1e-6;  // s
  bool csv_ = false;
  std::size_t line_ = 0;
  std::vector<Row> rows_;
  WakeUpHistogram histogram_;
};

void Reading::comment(std::string_view line) {
  constexpr std::string_view kOverflows = "# Histogram Overflows:";
  constexpr std::string_view kMaximum = "# Max Latencies:";
  const bool overflows = line.starts_with(kOverflows);
  if (!overflows && !line.starts_with(kMaximum)) return;
  line.remove_prefix(overflows ? kOverflows.size() : kMaximum.size());
  for (const std::string_view cell : cells(line, " \t\r")) {
    const auto value = number<std::int64_t>(cell);
    if (!value || *value < 0 || *value > kMostCount) continue;
    if (overflows) {
      histogram_.overflows += *value;
    } else {
      const double longest = static_cast<double>(*value) * unit_;
      histogram_.longest = std::max(histogram_.longest.value_or(0), longest);
    }
  }
}

void Reading::row(std::string_view line) {
  const std::vector<std::string_view> found = cells(line, csv_ ? ", \t\r" : " \t\r");
  const auto latency = found.empty() ? std::nullopt : number<double>(found[0]);
  if (!latency || found.size() < 2) {
    throw InputError(
        fmt::format("line {}: found '{}'; expected a latency in us and a count for "
                    "each processor, or a header latency_us,count",
                    line_, shown(line)));
  }
  if (!(*latency >= 0) || *latency * unit_ > kLongestLatency) {
    throw InputError(fmt::format("latency: {:g} us in line {}; expected from zero to {:g} s",
                                 *latency * unit_ * 1e6, line_, kLongestLatency));
  }
  Row row{.latency = *latency, .counts = {}, .line = line_};
  for (std::size_t i = 1; i < found.size(); ++i) {
    const auto count = number<std::int64_t>(found[i]);
    if (!count || *count < 0 || *count > kMostCount) {
      throw InputError(fmt::format("count: '{}' in line {}; expected a whole number from zero on",
                                   shown(found[i]), line_));
    }
    row.counts.push_back(*count);
  }
  if (!rows_.empty() && !(row.latency > rows_.back().latency)) {
    throw InputError(fmt::format("latency: {:g} after {:g} in line {}; expected it to grow",
                                 row.latency, rows_.back().latency, line_));
  }
  if (!rows_.empty() && row.counts.size() != rows_.front().counts.size()) {
    throw InputError(fmt::format("count: {} columns in line {}; expected {} as before",
                                 row.counts.size(), line_, rows_.front().counts.size()));
  }
  rows_.push_back(std::move(row));
}

// `cyclictest -H` adds one.
void Reading::drop_column_of_sums() {
  const std::size_t columns = rows_.front().counts.size();
  if (columns < 2) return;
  std::size_t counted = 0;
  for (const Row& r : rows_) {
    if (std::accumulate(r.counts.begin(), r.counts.end() - 1, std::int64_t{0}) != r.counts.back()) {
      return;
    }
    if (r.counts.back() > 0) ++counted;
  }
  // Two processors can have the same counts in a few places.
  if (columns == 2 && counted < 5) return;
  for (Row& r : rows_) r.counts.pop_back();
  histogram_.warnings.emplace_back("count: the last column is the sum of the others, left out");
}

void Reading::fill_bins() {
  double width = 1;
  if (csv_ && rows_.size() > 1) {
    width = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < rows_.size(); ++i) {
      width = std::min(width, rows_[i].latency - rows_[i - 1].latency);
    }
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& r = rows_[i];
    // -h of a later version may leave out lines, but has whole microseconds.
    const double next = r.latency + width;
    const double to = i + 1 < rows_.size() ? std::min(next, rows_[i + 1].latency) : next;
    histogram_.bins.push_back(
        {.from = r.latency * unit_,
         .to = to * unit_,
         .count = std::accumulate(r.counts.begin(), r.counts.end(), std::int64_t{0})});
  }
}

WakeUpHistogram Reading::read(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos || is_progress(line)) continue;
    if (line.front() == '#') {
      comment(line);
      continue;
    }
    const std::optional<double> unit = rows_.empty() && !csv_ ? unit_of_header(line) : std::nullopt;
    if (unit) {
      unit_ = *unit;
      csv_ = true;
      continue;
    }
    row(line);
  }
  if (rows_.empty()) {
    throw InputError("no line of numbers; expected a latency in us and a count for each processor");
  }
  drop_column_of_sums();
  fill_bins();
  return std::move(histogram_);
}

}  // namespace

std::int64_t WakeUpHistogram::count() const {
  std::int64_t sum = 0;
  for (const Bin& bin : bins) sum += bin.count;
  return sum;
}

WakeUpHistogram read_wake_up_histogram(std::string_view text) { return Reading().read(text); }

namespace {

constexpr std::int64_t kFewestLatencies = 100;
constexpr std::size_t kFewestBins = 3;

}  // namespace

WakeUpCounts wake_up_counts(const WakeUpHistogram& histogram) {
  WakeUpCounts counts;
  for (const WakeUpHistogram::Bin& bin : histogram.bins) {
    if (bin.count == 0) continue;
    counts.bins.push_back(bin);
    counts.total += bin.count;
  }
  if (counts.total < kFewestLatencies) {
    throw InputError(
        fmt::format("count: {} latencies; expected at least {}", counts.total, kFewestLatencies));
  }
  if (counts.bins.size() < kFewestBins) {
    throw InputError(
        fmt::format("latency: all in {} bins from {:g} us on; expected at least {}, "
                    "measure with a finer unit or state a constant",
                    counts.bins.size(), counts.bins.front().from * 1e6, kFewestBins));
  }
  const double end = histogram.bins.back().to;
  counts.finest = end;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    counts.finest = std::min(counts.finest, bin.to - bin.from);
  }
  if (histogram.overflows > 0 && histogram.longest.value_or(0) >= end) {
    counts.bins.push_back({end, *histogram.longest + counts.finest, histogram.overflows});
    counts.total += histogram.overflows;
  }
  counts.minimum = counts.bins.front().from;
  counts.maximum = counts.bins.back().to;
  return counts;
}

}  // namespace hvp::fit
