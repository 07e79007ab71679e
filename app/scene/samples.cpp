#include "app/scene/samples.h"

#include <array>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/decimal.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/regular_file.h"

namespace hvp::app {

namespace {

constexpr std::size_t kMostSamples = 1'000'000;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{256} << 20U;  // some columns beside them
constexpr double kLongest = 1.0;                                     // s
constexpr std::array<std::pair<std::string_view, int>, 4> kUnits = {
    {{"_ms", -3}, {"_us", -6}, {"_ns", -9}, {"_s", 0}}};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

// Nothing where the line is too short.
std::string_view cell(std::string_view line, std::size_t column) {
  const std::vector<std::string_view> cells = files::csv_cells(line, column + 1);
  return column < cells.size() ? trimmed(cells[column]) : std::string_view{};
}

struct Column {
  std::size_t index = 0;
  int exponent = 0;  // of the unit in s
};

std::optional<Column> find_column(std::string_view header) {
  const std::vector<std::string_view> names = files::csv_cells(header);
  for (std::size_t index = 0; index < names.size(); ++index) {
    for (const auto& [suffix, exponent] : kUnits) {
      if (trimmed(names[index]).ends_with(suffix)) return Column{index, exponent};
    }
  }
  return std::nullopt;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError("samples",
                   scenario::one_line(fmt::format("{}: {}", file.filename().string(), what)));
}

std::string contents_of(const std::filesystem::path& file) {
  try {
    return files::read_regular_file(file, kLargestFile, "a CSV file");
  } catch (const InputError& error) {
    refuse(file, error.what());
  }
}

std::optional<double> seconds(std::string_view text, int exponent) {
  std::size_t length = 0;
  std::optional<scenario::Decimal> number = scenario::read_decimal(text, length);
  if (!number || length != text.size()) return std::nullopt;
  number->exponent += exponent;
  return scenario::nearest_double(*number);
}

}  // namespace

std::vector<double> read_samples(const std::filesystem::path& file) {
  std::istringstream in(contents_of(file));
  std::string line;
  std::getline(in, line);
  const std::optional<Column> column = find_column(line);
  if (!column) {
    refuse(file, "line 1: expected names of columns, one of them ending in _s, _ms, _us or _ns");
  }
  std::vector<double> samples;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    if (trimmed(line).empty()) continue;
    const std::string_view text = cell(line, column->index);
    const std::optional<double> value = seconds(text, column->exponent);
    if (!value || !(*value >= 0 && *value <= kLongest)) {
      refuse(file, fmt::format("line {}: expected a time from 0 to 1 s in column {}, found {}",
                               number, column->index + 1, scenario::in_quotes(text)));
    }
    if (samples.size() == kMostSamples) refuse(file, "more than a million samples");
    samples.push_back(*value);
  }
  if (samples.empty()) refuse(file, "no sample below the names of the columns");
  return samples;
}

}  // namespace hvp::app
