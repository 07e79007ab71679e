#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::scenario {

// The value in SI units of a text such as "850 ns", "9.81 m/s2" or "0.1 1/s". The result is the
// double nearest to the exact product of the number and the unit: "850 ns" is 8.5e-7 to the
// last bit. A dimensionless text has no unit. Throws InputError (without a key) that says what
// was expected: no unit, a unit of another dimension, an unknown unit (with the nearest), no
// number, a number that is not finite or that a double cannot hold.
double parse_quantity(std::string_view text, config::Dimension dimension);

// The shortest decimal that reads back as the same double, with the unit that leaves one to
// three digits before the point where there is one. `value` is finite
// (std::invalid_argument otherwise).
std::string format_quantity(double value, config::Dimension dimension);

// The text without blanks and tabs at both ends.
std::string_view trimmed(std::string_view text);

// "a time", "an acceleration"; and a text that is one: "2 ms".
std::string_view dimension_name(config::Dimension dimension);
std::string_view dimension_example(config::Dimension dimension);

// Every unit a text may have, in the order of the reference page; spellings of the same unit
// once.
std::vector<std::string_view> units_of(config::Dimension dimension);

// "missing unit: expected a time such as "2 ms", found 2".
std::string missing_unit(config::Dimension dimension, std::string_view found);

}  // namespace hvp::scenario
