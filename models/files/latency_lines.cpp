#include "models/files/latency_lines.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/one_line.h"

namespace hvp::files {

namespace {

constexpr double kLongestLatency = 1;                   // s
constexpr std::int64_t kMostCount = 1'000'000'000'000;  // of a cell: no sum overflows
constexpr std::string_view kBlanks = " \t\r";

}  // namespace

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> result;
  while (true) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return result;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
    result.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

std::optional<std::int64_t> whole_count(std::string_view cell) {
  std::int64_t value = 0;
  const char* const end = cell.data() + cell.size();
  const auto [stopped, error] = std::from_chars(cell.data(), end, value);
  if (error != std::errc() || stopped != end || value < 0 || value > kMostCount) return {};
  return value;
}

std::int64_t count_of(std::string_view cell, std::size_t line) {
  const auto count = whole_count(cell);
  if (count) return *count;
  throw InputError(fmt::format("line {}: the count is '{}': expected a whole number from 0 on",
                               line, one_line(cell, 40)));
}

double latency_of(std::string_view cell, int exponent, std::size_t line) {
  const std::optional<double> value = decimal_number(cell, exponent);
  if (value && *value >= 0 && *value <= kLongestLatency) return *value;
  throw InputError(fmt::format("line {}: expected a latency from 0 to 1 s, found '{}'", line,
                               one_line(cell, 40)));
}

std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

bool is_empty_line(std::string_view line) {
  return line.find_first_not_of(kBlanks) == std::string_view::npos;
}

}  // namespace hvp::files
