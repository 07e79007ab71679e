#include "app/scenario/quantity.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "app/scenario/decimal.h"
#include "app/scenario/message.h"
#include "app/scenario/nearest.h"
#include "app/scenario/unit_table.h"
#include "models/config/input_error.h"

namespace hvp::scenario {
namespace {

using config::Dimension;

// No quantity anybody writes is longer; the bound keeps long multiplication short.
constexpr std::size_t kLongestText = 200;

std::string expected(Dimension dimension) {
  const DimensionUnits& units = units_table(dimension);
  if (dimension == Dimension::dimensionless) return "expected a number such as 0.5";
  return fmt::format("expected {} such as \"{}\"", units.name, units.example);
}

const Unit* find_unit(std::string_view name, Dimension dimension) {
  for (const Unit& unit : units_table(dimension).units) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

bool looks_infinite(std::string_view text) {
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.remove_prefix(1);
  return text.starts_with("inf") || text.starts_with("nan") || text.starts_with("Inf") ||
         text.starts_with("NaN");
}

[[noreturn]] void throw_bad_unit(std::string_view text, std::string_view unit,
                                 Dimension dimension) {
  for (const DimensionUnits& other : all_dimensions()) {
    if (find_unit(unit, other.dimension) == nullptr) continue;
    const auto article = other.name.find(' ');
    throw InputError(fmt::format("wrong unit: {}, found the {} {}", expected(dimension),
                                 other.name.substr(article + 1), in_quotes(text)));
  }
  std::string message = fmt::format("unknown unit {}: {}, found {}", in_quotes(unit),
                                    expected(dimension), in_quotes(text));
  const std::string_view close = nearest(unit, units_of(dimension));
  if (!close.empty()) message += fmt::format("; did you mean \"{}\"?", close);
  throw InputError(message);
}

// Degrees where they say the same in a few digits, since nobody thinks in radians.
std::optional<std::string> format_degrees(double value) {
  const double rounded = std::round(value * (180.0 / 3.141592653589793) * 1e6) / 1e6;
  if (!std::isfinite(rounded) || rounded == 0.0) return std::nullopt;
  std::string text = decimal_text(shortest_decimal(rounded)) + " deg";
  if (parse_quantity(text, Dimension::angle) != value) return std::nullopt;
  return text;
}

// Whole multiples of 1024 in powers of 1024: memories are built that way.
std::optional<std::string> format_binary(double value) {
  constexpr double kKibi = 1024.0;
  if (value < kKibi || value >= kKibi * kKibi * kKibi * kKibi || std::fmod(value, kKibi) != 0.0) {
    return std::nullopt;
  }
  if (std::fmod(value, 1000.0) == 0.0) return std::nullopt;
  double scaled = value / kKibi;
  std::string_view unit = "KiB";
  for (const std::string_view larger : {"MiB", "GiB"}) {
    if (std::fmod(scaled, kKibi) != 0.0) break;
    scaled /= kKibi;
    unit = larger;
  }
  return fmt::format("{} {}", decimal_text(shortest_decimal(scaled)), unit);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

double parse_quantity(std::string_view text, Dimension dimension) {
  const std::string_view body = trimmed(text);
  if (body.size() > kLongestText) {
    throw InputError(
        fmt::format("{}, found a text of {} characters", expected(dimension), body.size()));
  }
  std::size_t length = 0;
  const std::optional<Decimal> number = read_decimal(body, length);
  if (!number) {
    throw InputError(
        looks_infinite(body)
            ? fmt::format("not a finite value: {}, found {}", expected(dimension), in_quotes(text))
            : fmt::format("{}, found {}", expected(dimension), in_quotes(text)));
  }
  const std::string_view name = trimmed(body.substr(length));
  Decimal exact = *number;
  if (dimension == Dimension::dimensionless) {
    if (!name.empty()) {
      throw InputError(fmt::format("a unit where there is none: {}, found {}", expected(dimension),
                                   in_quotes(text)));
    }
  } else {
    if (name.empty()) throw InputError(missing_unit(dimension, in_quotes(text)));
    const Unit* unit = find_unit(name, dimension);
    if (unit == nullptr) throw_bad_unit(text, name, dimension);
    exact = multiply(exact, unit->factor);
    exact.exponent += unit->exponent;
  }
  const std::optional<double> value = nearest_double(exact);
  if (!value) {
    throw InputError(fmt::format("too large or too small for double precision: {}, found {}",
                                 expected(dimension), in_quotes(text)));
  }
  return *value;
}

std::string format_quantity(double value, Dimension dimension) {
  if (!std::isfinite(value)) throw std::invalid_argument("format_quantity: value is not finite");
  Decimal number = shortest_decimal(value);
  if (dimension == Dimension::dimensionless) return decimal_text(number);
  if (dimension == Dimension::angle) {
    if (const auto degrees = format_degrees(value)) return *degrees;
  }
  if (dimension == Dimension::data_size) {
    if (const auto binary = format_binary(value)) return *binary;
  }
  // The largest unit that the value reaches, the smallest where it reaches none.
  const int magnitude = static_cast<int>(number.digits.size()) + number.exponent - 1;
  const Unit* best = &units_table(dimension).units.front();  // the SI unit, also for zero
  for (const Unit& unit : units_table(dimension).units) {
    if (unit.use != Unit::Use::read_and_write || value == 0.0) continue;
    const bool reaches = unit.exponent <= magnitude;
    const bool best_reaches = best->exponent <= magnitude;
    if (reaches ? !best_reaches || unit.exponent > best->exponent
                : !best_reaches && unit.exponent < best->exponent) {
      best = &unit;
    }
  }
  if (value != 0.0) number.exponent -= best->exponent;
  return fmt::format("{} {}", decimal_text(number), best->name);
}

std::string_view dimension_name(Dimension dimension) { return units_table(dimension).name; }

std::string_view dimension_example(Dimension dimension) { return units_table(dimension).example; }

std::vector<std::string_view> units_of(Dimension dimension) {
  std::vector<std::string_view> names;
  for (const Unit& unit : units_table(dimension).units) {
    if (unit.use != Unit::Use::spelling) names.push_back(unit.name);
  }
  return names;
}

std::string missing_unit(Dimension dimension, std::string_view found) {
  return fmt::format("missing unit: {}, found {}", expected(dimension), found);
}

}  // namespace hvp::scenario
