#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hvp::scenario {

// The exact number ± digits · 10^exponent. `digits` are decimal digits and may start with zeros.
struct Decimal {
  bool negative = false;
  std::string digits;
  int exponent = 0;
};

// Reads a number such as "-1.5e-3" at the start of `text` and sets `length` to the number of
// characters read. Returns nothing if no number starts there. An 'e' without digits behind it is
// not part of the number. An exponent beyond ±100000 is clamped.
std::optional<Decimal> read_decimal(std::string_view text, std::size_t& length);

// Multiplies the number by a whole number that is given in decimal digits.
Decimal multiply(const Decimal& number, std::string_view factor);

// Returns the nearest double, or nothing if it overflows or underflows to zero.
std::optional<double> nearest_double(const Decimal& number);

// Returns the shortest decimal that reads back as `value`, without trailing zeros. `value` is
// finite.
Decimal shortest_decimal(double value);

// Writes the number in plain notation if that takes few digits, otherwise with an exponent.
std::string decimal_text(const Decimal& number);

}  // namespace hvp::scenario
