#include "app/scenario/quantity.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "app/scenario/decimal.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"

namespace hvp::scenario {

namespace {

using config::Dimension;

constexpr auto kWrite = Unit::Use::read_and_write;
constexpr auto kRead = Unit::Use::read;
constexpr auto kSpelling = Unit::Use::spelling;

// The micro sign exists twice in Unicode: U+00B5 and the Greek letter U+03BC.
constexpr Unit kTime[] = {
    {"s", "1", 0, kWrite},           {"ms", "1", -3, kWrite},         {"us", "1", -6, kWrite},
    {"\u00b5s", "1", -6, kSpelling}, {"\u03bcs", "1", -6, kSpelling}, {"ns", "1", -9, kWrite},
    {"ps", "1", -12, kWrite},        {"min", "60", 0, kRead},
};
constexpr Unit kFrequency[] = {
    {"Hz", "1", 0, kWrite},
    {"kHz", "1", 3, kWrite},
    {"MHz", "1", 6, kWrite},
    {"GHz", "1", 9, kWrite},
};
constexpr Unit kRate[] = {{"1/s", "1", 0, kWrite}, {"1/ms", "1", 3, kRead}};
constexpr Unit kLength[] = {
    {"m", "1", 0, kWrite},           {"km", "1", 3, kWrite},  {"cm", "1", -2, kRead},
    {"mm", "1", -3, kWrite},         {"um", "1", -6, kWrite}, {"\u00b5m", "1", -6, kSpelling},
    {"\u03bcm", "1", -6, kSpelling}, {"nm", "1", -9, kWrite},
};
constexpr Unit kMass[] = {
    {"kg", "1", 0, kWrite},
    {"g", "1", -3, kWrite},
    {"mg", "1", -6, kWrite},
};
constexpr Unit kVelocity[] = {
    {"m/s", "1", 0, kWrite},   {"cm/s", "1", -2, kRead},          {"mm/s", "1", -3, kWrite},
    {"um/s", "1", -6, kWrite}, {"\u00b5m/s", "1", -6, kSpelling}, {"\u03bcm/s", "1", -6, kSpelling},
};
// The standard acceleration of gravity, 9.80665 m/s² (3rd CGPM, 1901).
constexpr Unit kAcceleration[] = {
    {"m/s2", "1", 0, kWrite},   {"m/s\u00b2", "1", 0, kSpelling},   {"m/s^2", "1", 0, kSpelling},
    {"mm/s2", "1", -3, kWrite}, {"mm/s\u00b2", "1", -3, kSpelling}, {"mm/s^2", "1", -3, kSpelling},
    {"g", "980665", -5, kRead},
};
constexpr Unit kForce[] = {
    {"N", "1", 0, kWrite},   {"kN", "1", 3, kWrite},          {"mN", "1", -3, kWrite},
    {"uN", "1", -6, kWrite}, {"\u00b5N", "1", -6, kSpelling}, {"\u03bcN", "1", -6, kSpelling},
};
constexpr Unit kStiffness[] = {
    {"N/m", "1", 0, kWrite},
    {"kN/m", "1", 3, kWrite},
    {"N/mm", "1", 3, kRead},
};
constexpr Unit kDamping[] = {
    {"N s/m", "1", 0, kWrite},
    {"N\u00b7s/m", "1", 0, kSpelling},
    {"Ns/m", "1", 0, kSpelling},
    {"mN s/m", "1", -3, kWrite},
};
constexpr Unit kPressure[] = {
    {"Pa", "1", 0, kWrite},
    {"kPa", "1", 3, kWrite},
    {"MPa", "1", 6, kWrite},
    {"GPa", "1", 9, kWrite},
};
constexpr Unit kDensity[] = {
    {"kg/m3", "1", 0, kWrite}, {"kg/m\u00b3", "1", 0, kSpelling}, {"kg/m^3", "1", 0, kSpelling},
    {"g/cm3", "1", 3, kRead},  {"g/cm\u00b3", "1", 3, kSpelling}, {"g/cm^3", "1", 3, kSpelling},
};
// π/180, the digits by Machin's formula.
constexpr Unit kAngle[] = {
    {"rad", "1", 0, kWrite},
    {"mrad", "1", -3, kRead},
    {"deg", "17453292519943295769236907684886127134428718885417", -51, kRead},
    {"\u00b0", "17453292519943295769236907684886127134428718885417", -51, kSpelling},
};
constexpr Unit kInertia[] = {
    {"kg m2", "1", 0, kWrite},
    {"kg m\u00b2", "1", 0, kSpelling},
    {"kg m^2", "1", 0, kSpelling},
    {"g cm2", "1", -7, kRead},
};
constexpr Unit kCurrent[] = {{"A", "1", 0, kWrite}, {"mA", "1", -3, kWrite}};
constexpr Unit kVoltage[] = {{"V", "1", 0, kWrite}, {"mV", "1", -3, kWrite}};
constexpr Unit kTransconductance[] = {{"A/V", "1", 0, kWrite}, {"mA/V", "1", -3, kWrite}};
constexpr Unit kTorqueConstant[] = {
    {"N m/A", "1", 0, kWrite},
    {"N\u00b7m/A", "1", 0, kSpelling},
    {"mN m/A", "1", -3, kWrite},
};
constexpr Unit kThroughput[] = {
    {"flop/s", "1", 0, kWrite},  {"kflop/s", "1", 3, kWrite},  {"Mflop/s", "1", 6, kWrite},
    {"Gflop/s", "1", 9, kWrite}, {"Tflop/s", "1", 12, kWrite},
};
constexpr Unit kBandwidth[] = {
    {"B/s", "1", 0, kWrite},  {"kB/s", "1", 3, kWrite},  {"MB/s", "1", 6, kWrite},
    {"GB/s", "1", 9, kWrite}, {"TB/s", "1", 12, kWrite},
};
constexpr Unit kDataSize[] = {
    {"B", "1", 0, kWrite},           {"kB", "1", 3, kWrite},    {"MB", "1", 6, kWrite},
    {"GB", "1", 9, kWrite},          {"KiB", "1024", 0, kRead}, {"MiB", "1048576", 0, kRead},
    {"GiB", "1073741824", 0, kRead},
};

constexpr std::array<DimensionUnits, 22> kDimensions = {{
    {Dimension::dimensionless, "a number", "0.5", {}},
    {Dimension::time, "a time", "2 ms", kTime},
    {Dimension::frequency, "a frequency", "100 MHz", kFrequency},
    {Dimension::rate, "a rate", "0.1 1/s", kRate},
    {Dimension::length, "a length", "50 mm", kLength},
    {Dimension::mass, "a mass", "100 g", kMass},
    {Dimension::velocity, "a velocity", "20 mm/s", kVelocity},
    {Dimension::acceleration, "an acceleration", "9.81 m/s2", kAcceleration},
    {Dimension::force, "a force", "5 N", kForce},
    {Dimension::stiffness, "a stiffness", "375 N/m", kStiffness},
    {Dimension::damping, "a damping", "4.5 N s/m", kDamping},
    {Dimension::pressure, "a pressure", "10 kPa", kPressure},
    {Dimension::density, "a density", "1000 kg/m3", kDensity},
    {Dimension::angle, "an angle", "30 deg", kAngle},
    {Dimension::inertia, "a moment of inertia", "0.001 kg m2", kInertia},
    {Dimension::current, "a current", "2.4 A", kCurrent},
    {Dimension::voltage, "a voltage", "10 V", kVoltage},
    {Dimension::transconductance, "a current for a voltage", "0.5 A/V", kTransconductance},
    {Dimension::torque_constant, "a torque for a current", "23.4 mN m/A", kTorqueConstant},
    {Dimension::throughput, "a throughput", "298 Mflop/s", kThroughput},
    {Dimension::bandwidth, "a bandwidth", "20 GB/s", kBandwidth},
    {Dimension::data_size, "a data size", "64 B", kDataSize},
}};

}  // namespace

const DimensionUnits& units_table(Dimension dimension) {
  for (const DimensionUnits& entry : kDimensions) {
    if (entry.dimension == dimension) return entry;
  }
  throw std::logic_error("a dimension without units");
}

std::span<const DimensionUnits> all_dimensions() { return kDimensions; }

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
