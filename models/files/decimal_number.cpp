#include "models/files/decimal_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

namespace hvp::files {
namespace {

// Of a zero, which alone may have it: no other double does.
constexpr int kLargestExponent = 100000;

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

std::optional<double> decimal_number(std::string_view text, int exponent) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return {};
  }
  const std::optional<double> plain = number(text);
  if (!plain || exponent == 0) return plain;
  const std::size_t e = std::min(text.find_first_of("eE"), text.size());
  int own = 0;
  if (e < text.size()) {
    const std::size_t digits = e + (text[e + 1] == '+' ? 2 : 1);
    std::from_chars(text.data() + digits, text.data() + text.size(), own);
  }
  fmt::memory_buffer scaled;
  fmt::format_to(std::back_inserter(scaled), "{}e{}", text.substr(0, e),
                 std::clamp(own, -kLargestExponent, kLargestExponent) + exponent);
  return number({scaled.data(), scaled.size()});
}

}  // namespace hvp::files
