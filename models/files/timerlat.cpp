#include "models/files/timerlat.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/latency_lines.h"
#include "models/files/one_line.h"

namespace hvp::files {

namespace {

constexpr std::string_view kTitle = "# RTLA ";
constexpr std::string_view kIndex = "Index";

class Timerlat {
 public:
  Latencies read(std::string_view text) {
    bool summary = false;
    while (!text.empty()) {
      const std::string_view line = next_line(text);
      ++line_;
      if (is_empty_line(line)) continue;
      if (line.front() == '#') {
        comment(line);
        continue;
      }
      const std::vector<std::string_view> found = cells(line);
      const bool names = found.front() == kIndex;
      if (names && columns_.empty()) {
        take_names(found);
      } else if (found.front().ends_with(':') || names) {
        // The processors' lines are followed by the sums of all, which say nothing new.
        if (found.front() == "ALL:") break;
        summary = true;
        summarise(found);
      } else if (!summary) {
        row(found);
      }
    }
    if (result_.entries.empty()) throw InputError("no line of a latency and its counts");
    result_.whole_microseconds = exponent_ == -6 && finest_ < 1.5e-6;
    return std::move(result_);
  }

 private:
  void comment(std::string_view line) {
    if (line.starts_with(kTitle) && line.find("timerlat") == std::string_view::npos) {
      throw InputError(fmt::format("line {}: '{}' has no latencies: expected rtla timerlat's",
                                   line_, one_line(line, 60)));
    }
    if (line.find("(ns)") != std::string_view::npos) exponent_ = -9;
  }

  void take_names(const std::vector<std::string_view>& names) {
    for (const char* const what : {"Usr-", "Thr-"}) {
      for (std::size_t i = 1; i < names.size(); ++i) {
        if (names[i].starts_with(what)) columns_.push_back(i);
      }
      if (!columns_.empty()) break;
    }
    width_ = names.size();
    if (columns_.empty()) {
      throw InputError(fmt::format(
          "line {}: no column of a thread, as Thr-000 is: an interrupt's latency is not when a "
          "process runs",
          line_));
    }
  }

  void row(const std::vector<std::string_view>& found) {
    if (columns_.empty()) {
      throw InputError(fmt::format(
          "line {}: expected the names of the columns, which begin with Index, before the counts",
          line_));
    }
    if (found.size() != width_) {
      throw InputError(fmt::format("line {}: {} columns: expected {} as the names are", line_,
                                   found.size(), width_));
    }
    Latencies::Entry entry{latency_of(found.front(), exponent_, line_), 0};
    for (const std::size_t column : columns_) entry.count += count_of(found[column], line_);
    if (!result_.entries.empty()) {
      const double before = result_.entries.back().seconds;
      if (!(entry.seconds > before)) {
        throw InputError(
            fmt::format("line {}: the latency is {:g} us after {:g} us: expected it to "
                        "grow",
                        line_, entry.seconds * 1e6, before * 1e6));
      }
      finest_ = std::min(finest_, entry.seconds - before);
    }
    result_.entries.push_back(entry);
  }

  void summarise(const std::vector<std::string_view>& found) {
    const bool over = found.front() == "over:";
    if (!over && found.front() != "max:") return;
    for (const std::size_t column : columns_) {
      // A processor without a sample has a dash.
      if (column >= found.size() || !whole_count(found[column])) continue;
      if (over) {
        result_.overflows += *whole_count(found[column]);
      } else {
        const double longest = latency_of(found[column], exponent_, line_);
        result_.longest = std::max(result_.longest.value_or(0), longest);
      }
    }
  }

  std::size_t line_ = 0;
  int exponent_ = -6;
  std::size_t width_ = 0;
  std::vector<std::size_t> columns_;
  double finest_ = 1;
  Latencies result_;
};

}  // namespace

bool is_timerlat(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = next_line(text);
    if (is_empty_line(line)) continue;
    if (line.starts_with(kTitle)) return true;
    if (line.front() != '#') return cells(line).front() == kIndex;
  }
  return false;
}

Latencies read_timerlat(std::string_view text) { return Timerlat().read(text); }

}  // namespace hvp::files
