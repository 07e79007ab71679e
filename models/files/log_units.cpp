#include "models/files/log_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "models/files/decimal_number.h"

namespace hvp::files {
namespace {

constexpr auto kUnits = std::to_array<LogUnit>({
    {"s", "s", 0},
    {"ms", "s", -3},
    {"us", "s", -6},
    {"\u00b5s", "s", -6},  // the micro sign, which Unicode has twice
    {"\u03bcs", "s", -6},
    {"ns", "s", -9},
    {"min", "s", 0, 60},
    {"m", "m", 0},
    {"cm", "m", -2},
    {"mm", "m", -3},
    {"um", "m", -6},
    {"\u00b5m", "m", -6},
    {"\u03bcm", "m", -6},
    {"nm", "m", -9},
    {"m_s", "m/s", 0},
    {"mm_s", "m/s", -3},
    {"rad", "rad", 0},
    {"mrad", "rad", -3},
    {"deg", "rad", 0, std::numbers::pi / 180},
    {"rad_s", "rad/s", 0},
    {"deg_s", "rad/s", 0, std::numbers::pi / 180},
    {"N", "N", 0},
    {"mN", "N", -3},
    {"uN", "N", -6},
    {"kN", "N", 3},
    {"Nm", "N m", 0},
    {"mNm", "N m", -3},
    {"N_m", "N m", 0},
    {"mN_m", "N m", -3},
    {"A", "A", 0},
    {"mA", "A", -3},
    {"V", "V", 0},
    {"mV", "V", -3},
    {"Pa", "Pa", 0},
    {"kPa", "Pa", 3},
    {"bytes", "B", 0},
    {"B", "B", 0},
    {"kB", "B", 3},
    {"KiB", "B", 0, 1024},
    {"MB", "B", 6},
    {"MiB", "B", 0, 1024.0 * 1024.0},
    {"B_s", "B/s", 0},
    {"MB_s", "B/s", 6},
    {"GB_s", "B/s", 9},
    {"counts", "count", 0},
});

constexpr LogUnit kNumber = {"", "", 0};

const LogUnit& unit_called(std::string_view suffix) {
  return *std::ranges::find(kUnits, suffix, &LogUnit::suffix);
}

}  // namespace

std::optional<LogName> log_name(std::string_view column) {
  if (column == "bytes") return LogName{"size", &unit_called("bytes")};
  if (column == "count") return LogName{"count", &kNumber};
  // The longest: velocity_m_s is no velocity_m in seconds.
  const LogUnit* longest = nullptr;
  for (const LogUnit& unit : kUnits) {
    const std::size_t length = unit.suffix.size();
    const bool has_it = column.size() > length + 1 && column.ends_with(unit.suffix) &&
                        column[column.size() - length - 1] == '_';
    if (has_it && (longest == nullptr || length > longest->suffix.size())) longest = &unit;
  }
  if (longest == nullptr) return {};
  return LogName{std::string(column.substr(0, column.size() - longest->suffix.size() - 1)),
                 longest};
}

std::optional<double> in_si(std::string_view text, const LogUnit& unit) {
  const std::optional<double> number = decimal_number(text, unit.exponent);
  if (!number || unit.factor == 1) return number;
  const double value = *number * unit.factor;
  if (!std::isfinite(value)) return {};
  return value;
}

std::string log_names(std::string_view quantity, std::string_view si) {
  std::vector<std::string> names;
  for (const LogUnit& unit : kUnits) {
    const bool ascii = std::ranges::all_of(
        unit.suffix, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    if (unit.si == si && ascii) names.push_back(fmt::format("{}_{}", quantity, unit.suffix));
  }
  if (names.empty()) return std::string(quantity);
  const std::string last = names.back();
  names.pop_back();
  return names.empty() ? last : fmt::format("{} or {}", fmt::join(names, ", "), last);
}

}  // namespace hvp::files
