#include "app/draw/axis_ticks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace hvp::draw {
namespace {

Ticks ticks_with_step(double low, double high, double step) {
  Ticks ticks;
  ticks.step = step;
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  // A tick that rounding puts a hair outside still belongs to the axis.
  const double slack = 1e-9 * (high - low);
  for (double n = std::ceil((low - slack) / step); n * step <= high + slack; ++n) {
    ticks.values.push_back(n * step + 0.0);  // + 0.0: no "-0"
    ticks.labels.push_back(fmt::format("{:.{}f}", ticks.values.back(), decimals));
  }
  return ticks;
}

double round_step(double low, double high, int wanted) {
  const double raw = (high - low) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

}  // namespace

Ticks round_ticks(double low, double high, int wanted) {
  return ticks_with_step(low, high, round_step(low, high, wanted));
}

Ticks whole_ticks(double low, double high, int wanted) {
  return ticks_with_step(low, high, std::max(1.0, round_step(low, high, wanted)));
}

std::string four_digits(double value) {
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size >= 1e7 || size < 1e-5) return fmt::format("{:.3e}", value);
  const int decimals = std::clamp(3 - static_cast<int>(std::floor(std::log10(size))), 0, 8);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (decimals > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

Unit unit_for(double largest, std::string_view symbol, double preferred) {
  constexpr std::array kPrefixes = {"p", "n", "µ", "m", "", "k", "M", "G", "T"};
  constexpr int kNone = 4;
  const bool fits = largest == 0.0 || (largest >= 0.01 * preferred && largest < 1e4 * preferred);
  const double thousands = std::floor(std::log10(fits ? preferred : largest) / 3.0 + 1e-9);
  const double size = std::pow(1000.0, thousands);
  const double prefix = kNone + thousands;
  if (prefix < 0.0 || prefix >= static_cast<double>(kPrefixes.size()))
    return {size, fmt::format("1e{:.0f} {}", 3.0 * thousands, symbol)};
  return {size, fmt::format("{}{}", kPrefixes.at(static_cast<std::size_t>(prefix)), symbol)};
}

}  // namespace hvp::draw
