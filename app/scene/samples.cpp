#include "app/scene/samples.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "models/files/csv.h"
#include "models/files/regular_file.h"

namespace hvp::app {

namespace {

constexpr std::size_t kMostSamples = 1'000'000;
constexpr double kLongest = 1.0;  // s
constexpr std::array<std::pair<std::string_view, int>, 4> kUnits = {
    {{"_ms", -3}, {"_us", -6}, {"_ns", -9}, {"_s", 0}}};

struct Column {
  std::size_t index = 0;
  int exponent = 0;  // of the unit in s
};

std::optional<Column> find_column(const std::vector<std::string>& names) {
  for (std::size_t index = 0; index < names.size(); ++index) {
    for (const auto& [suffix, exponent] : kUnits) {
      if (names[index].ends_with(suffix)) return Column{index, exponent};
    }
  }
  return std::nullopt;
}

std::vector<double> read_table(files::CsvTable& table) {
  const auto wrong = [&table](const std::string& what) {
    return InputError(fmt::format("{}: {}", table.name(), what));
  };
  const std::optional<Column> column = find_column(table.columns());
  if (!column) {
    throw wrong(
        fmt::format("line {}: expected names of columns, one of them ending in _s, _ms, _us or _ns",
                    table.header_line()));
  }
  std::vector<double> samples;
  while (table.next_of_any_length()) {
    const std::string_view text = table.text(column->index);
    const std::optional<double> value = files::decimal_number(text, column->exponent);
    if (!value || !(*value >= 0 && *value <= kLongest)) {
      throw wrong(fmt::format("line {}: expected a time from 0 to 1 s in column {}, found {}",
                              table.line(), column->index + 1, scenario::in_quotes(text)));
    }
    if (samples.size() == kMostSamples) throw wrong("more than a million samples");
    samples.push_back(*value);
  }
  if (samples.empty()) throw wrong("no sample below the names of the columns");
  return samples;
}

std::ifstream open(const std::filesystem::path& file) {
  try {
    return files::open_regular_file(file, "a CSV file");
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.filename().string(), error.what()));
  }
}

}  // namespace

std::vector<double> read_samples(const std::filesystem::path& file) {
  try {
    std::ifstream in = open(file);
    files::CsvTable table(in, file.filename().string());
    return read_table(table);
  } catch (const InputError& error) {
    throw InputError("samples", scenario::one_line(error.what()));
  }
}

}  // namespace hvp::app
