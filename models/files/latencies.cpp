#include "models/files/latencies.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/latency_lines.h"
#include "models/files/one_line.h"
#include "models/files/regular_file.h"
#include "models/files/timerlat.h"

namespace hvp::files {

namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{64} << 20U;

// The lines that cyclictest prints of its threads while it runs.
bool is_progress(std::string_view line) {
  return line.starts_with("T:") || line.starts_with("policy:");
}

class Cyclictest {
 public:
  Latencies read(std::string_view text) {
    while (!text.empty()) {
      const std::string_view line = next_line(text);
      ++line_;
      if (is_empty_line(line) || is_progress(line)) continue;
      if (line.front() == '#') {
        comment(line);
      } else {
        row(line);
      }
    }
    if (rows_.empty()) {
      throw InputError(
          "no line of numbers: expected a latency in us and a count for each processor, or CSV "
          "with a column of latencies");
    }
    drop_column_of_sums();
    result_.whole_microseconds = true;
    for (const Row& r : rows_) {
      result_.entries.push_back(
          {r.latency, std::accumulate(r.counts.begin(), r.counts.end(), std::int64_t{0})});
    }
    return std::move(result_);
  }

 private:
  struct Row {
    double latency = 0;  // s
    std::vector<std::int64_t> counts;
  };

  void comment(std::string_view line) {
    constexpr std::string_view kOverflows = "# Histogram Overflows:";
    constexpr std::string_view kMaximum = "# Max Latencies:";
    const bool overflows = line.starts_with(kOverflows);
    if (!overflows && !line.starts_with(kMaximum)) return;
    line.remove_prefix(overflows ? kOverflows.size() : kMaximum.size());
    for (const std::string_view cell : cells(line)) {
      const auto value = whole_count(cell);
      if (!value) continue;
      if (overflows) {
        result_.overflows += *value;
      } else {
        const double longest = latency_of(cell, -6, line_);
        result_.longest = std::max(result_.longest.value_or(0), longest);
      }
    }
  }

  void row(std::string_view line) {
    const std::vector<std::string_view> found = cells(line);
    if (found.size() < 2) {
      throw InputError(fmt::format(
          "line {}: found '{}': expected a latency in us and a count for each processor", line_,
          one_line(line, 40)));
    }
    Row row{.latency = latency_of(found[0], -6, line_), .counts = {}};
    for (std::size_t i = 1; i < found.size(); ++i) row.counts.push_back(count_of(found[i], line_));
    if (!rows_.empty() && !(row.latency > rows_.back().latency)) {
      throw InputError(
          fmt::format("line {}: the latency is {:g} us after {:g} us: expected it to "
                      "grow",
                      line_, row.latency * 1e6, rows_.back().latency * 1e6));
    }
    if (!rows_.empty() && row.counts.size() != rows_.front().counts.size()) {
      throw InputError(fmt::format("line {}: {} columns of counts: expected {} as before", line_,
                                   row.counts.size(), rows_.front().counts.size()));
    }
    rows_.push_back(std::move(row));
  }

  // `cyclictest -H` adds one.
  void drop_column_of_sums() {
    const std::size_t columns = rows_.front().counts.size();
    if (columns < 2) return;
    std::size_t counted = 0;
    for (const Row& r : rows_) {
      const std::int64_t sum =
          std::accumulate(r.counts.begin(), r.counts.end() - 1, std::int64_t{0});
      if (sum != r.counts.back()) return;
      if (r.counts.back() > 0) ++counted;
    }
    // Two processors can have the same counts in a few places.
    if (columns == 2 && counted < 5) return;
    for (Row& r : rows_) r.counts.pop_back();
    result_.warnings.emplace_back("count: the last column is the sum of the others, left out");
  }

  std::size_t line_ = 0;
  std::vector<Row> rows_;
  Latencies result_;
};

struct CsvColumns {
  std::size_t latency = 0;
  int exponent = 0;  // of its unit in s
  std::optional<std::size_t> count;
};

std::optional<int> exponent_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, int>, 4> kUnits = {
      {{"_ms", -3}, {"_us", -6}, {"_ns", -9}, {"_s", 0}}};
  for (const auto& [suffix, exponent] : kUnits) {
    if (name.ends_with(suffix)) return exponent;
  }
  return std::nullopt;
}

std::string_view without_unit(std::string_view name) { return name.substr(0, name.rfind('_')); }

CsvColumns columns_of(const CsvTable& table) {
  const auto wrong = [&table](const std::string& what) {
    return InputError(fmt::format("line {}: {}", table.header_line(), what));
  };
  const std::vector<std::string>& names = table.columns();
  CsvColumns columns;
  std::vector<std::size_t> times;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (exponent_of(names[i])) {
      times.push_back(i);
    } else if (names[i] == "count" && !columns.count) {
      columns.count = i;
    } else if (names.size() > 1) {
      throw wrong(
          fmt::format("column {} is called '{}': expected one column of latencies, named "
                      "as latency_us is, and beside it at most count and time_s",
                      i + 1, one_line(names[i], 40)));
    }
  }
  if (times.empty()) {
    throw wrong("expected names of columns, one of them ending in _s, _ms, _us or _ns");
  }
  columns.latency = times.front();
  if (times.size() > 1) {
    const auto called = [&](std::string_view what) {
      return std::ranges::count_if(times,
                                   [&](std::size_t i) { return without_unit(names[i]) == what; });
    };
    if (times.size() > 2 || called("latency") != 1 || called("time") != 1) {
      std::string found;
      for (const std::size_t i : times) {
        found += (found.empty() ? "" : ", ") + one_line(names[i], 40);
      }
      throw wrong(fmt::format("{} columns of times, {}: expected one, or time_s and latency_us",
                              times.size(), found));
    }
    columns.latency = *std::ranges::find_if(
        times, [&](std::size_t i) { return without_unit(names[i]) == "latency"; });
  }
  columns.exponent = *exponent_of(names[columns.latency]);
  return columns;
}

Latencies read_csv(std::string_view text) {
  std::istringstream in{std::string(text)};
  CsvTable table(in, "");
  const CsvColumns columns = columns_of(table);
  Latencies result;
  while (table.next_of_any_length()) {
    if (table.fields() > table.columns().size()) {
      throw InputError(fmt::format("line {}: {} fields: expected {} as the header has",
                                   table.line(), table.fields(), table.columns().size()));
    }
    Latencies::Entry entry;
    entry.seconds = latency_of(table.text(columns.latency), columns.exponent, table.line());
    if (columns.count) entry.count = count_of(table.text(*columns.count), table.line());
    result.entries.push_back(entry);
  }
  if (result.entries.empty()) throw InputError("no sample below the names of the columns");
  return result;
}

// The output of cyclictest has numbers, comments and lines of its threads; CSV has names.
bool has_names(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = next_line(text);
    if (is_empty_line(line) || is_progress(line) || line.front() == '#') continue;
    const std::string_view first = trimmed(line);
    return !decimal_number(first.substr(0, first.find_first_of(" \t,;"))).has_value();
  }
  return false;
}

}  // namespace

Latencies read_latencies(std::string_view text) {
  if (is_timerlat(text)) return read_timerlat(text);
  return has_names(text) ? read_csv(text) : Cyclictest().read(text);
}

Latencies read_latencies_file(const std::filesystem::path& file) {
  try {
    return read_latencies(read_regular_file(file, kLargestFile, "a table of latencies"));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", one_line(file.filename().string()), e.what()));
  }
}

}  // namespace hvp::files
