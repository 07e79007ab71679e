#include "app/scenario/toml_text.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include <fmt/format.h>

#include "app/scenario/quantity.h"

namespace hvp::scenario {

using config::Dimension;

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (code < 0x20U || code == 0x7FU) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(code));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string toml_quantity(double value, Dimension dimension) {
  const std::string text = format_quantity(value, dimension);
  if (dimension != Dimension::dimensionless) return toml_string(text);
  // Without a point or exponent it would be a whole number, and -0 would lose its sign.
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string toml_vector(const Eigen::Vector3d& value, Dimension dimension) {
  return fmt::format("[{}, {}, {}]", toml_quantity(value[0], dimension),
                     toml_quantity(value[1], dimension), toml_quantity(value[2], dimension));
}

bool contains(const config::Range& range, double value) {
  const bool above = range.min_open ? value > range.min : value >= range.min;
  const bool below = range.max_open ? value < range.max : value <= range.max;
  return above && below;
}

std::string range_text(const config::Range& range, Dimension dimension) {
  const bool low = std::isfinite(range.min);
  const bool high = std::isfinite(range.max);
  if (!low && !high) return {};
  const std::string min = low ? format_quantity(range.min, dimension) : "";
  const std::string max = high ? format_quantity(range.max, dimension) : "";
  if (low && high && !range.min_open && !range.max_open) {
    return fmt::format("from {} to {}", min, max);
  }
  std::string text;
  if (low) text = (range.min_open ? "more than " : "at least ") + min;
  if (low && high) text += " and ";
  if (high) text += (range.max_open ? "less than " : "at most ") + max;
  return text;
}

std::string range_text(const config::IntegerRange& range) {
  // A bound that merely comes from the type is not shown.
  using Narrow = std::numeric_limits<int>;
  using Wide = std::numeric_limits<std::int64_t>;
  const bool low = range.min != Narrow::min() && range.min != Wide::min();
  const bool high = range.max != Narrow::max() && range.max != Wide::max();
  if (low && high && range.min == range.max) return fmt::format("{} only", range.min);
  if (low && high) return fmt::format("from {} to {}", range.min, range.max);
  if (low) return fmt::format("at least {}", range.min);
  if (high) return fmt::format("at most {}", range.max);
  return {};
}

}  // namespace hvp::scenario
