#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hvp::scenario {

// ± digits · 10^exponent, exactly; `digits` are decimal digits and may start with zeros.
struct Decimal {
  bool negative = false;
  std::string digits;
  int exponent = 0;
};

// Reads a number such as "-1.5e-3" at the start of `text` and sets `length` to what it took.
// Nothing where no number starts there. An 'e' that no digits follow is not part of it.
// Exponents beyond ±100000 are taken as that.
std::optional<Decimal> read_decimal(std::string_view text, std::size_t& length);

// The number times a whole number given in decimal digits.
Decimal multiply(const Decimal& number, std::string_view factor);

// The nearest double; nothing where it overflows, or underflows to zero.
std::optional<double> nearest_double(const Decimal& number);

// The shortest decimal that reads back as `value`, which is finite. No trailing zeros.
Decimal shortest_decimal(double value);

// As text: plain where that takes few digits, with an exponent otherwise.
std::string decimal_text(const Decimal& number);

}  // namespace hvp::scenario
