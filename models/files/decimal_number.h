#pragma once

#include <optional>
#include <string_view>

namespace hvp::files {

// The double nearest to the decimal number that is all of `text`, such as "-1.5e-3" or "+2", times
// 10^exponent: rounded once, so that 0.1 ms is the double that 0.0001 s is. Nothing for any other
// text, NaN and infinity included, and where the number overflows, or underflows to zero.
std::optional<double> decimal_number(std::string_view text, int exponent = 0);

}  // namespace hvp::files
