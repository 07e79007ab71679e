#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::scenario {

// Converts a text such as "850 ns", "9.81 m/s2" or "0.1 1/s" to SI units. The result is the double
// nearest to the exact product of number and unit: "850 ns" is 8.5e-7 to the last bit. A
// dimensionless text has no unit. Throws InputError (without a key) that says what was expected if
// the unit is missing, unknown (with the nearest one) or of another dimension, and if the number is
// missing, not finite or out of a double's range.
double parse_quantity(std::string_view text, config::Dimension dimension);

// Writes the shortest decimal that reads back as the same double. If possible, the unit is chosen
// so that one to three digits stand before the point. Throws std::invalid_argument if `value` is
// not finite.
std::string format_quantity(double value, config::Dimension dimension);

// Removes blanks and tabs from both ends.
std::string_view trimmed(std::string_view text);

// The name with its article ("a time", "an acceleration"), and an example of such a text ("2 ms").
std::string_view dimension_name(config::Dimension dimension);
std::string_view dimension_example(config::Dimension dimension);

// Lists all units of a dimension in the order of the reference page, without alternative spellings.
std::vector<std::string_view> units_of(config::Dimension dimension);

// Returns "missing unit: expected a time such as "2 ms", found 2".
std::string missing_unit(config::Dimension dimension, std::string_view found);

// One spelling of a unit: 1 unit = factor · 10^exponent SI units. `factor` is a whole number in
// decimal digits, so that its product with a decimal number is exact.
struct Unit {
  enum class Use {
    read_and_write,  // format_quantity may choose it
    read,            // accepted, but never written
    spelling,        // another spelling of the preceding unit
  };
  std::string_view name;
  std::string_view factor;
  int exponent;
  Use use;
};

struct DimensionUnits {
  config::Dimension dimension;
  std::string_view name;     // with its article
  std::string_view example;  // a typical text
  std::span<const Unit> units;
};

const DimensionUnits& units_table(config::Dimension dimension);
std::span<const DimensionUnits> all_dimensions();

}  // namespace hvp::scenario
