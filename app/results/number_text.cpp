#include "app/results/number_text.h"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "models/fixed/spectrum.h"

namespace hvp::results {

std::string microseconds(vp::Picoseconds time) {
  const char* sign = time < 0 ? "-" : "";
  const vp::Picoseconds magnitude = time < 0 ? -time : time;
  return fmt::format("{}{}.{:06d}", sign, magnitude / 1'000'000, magnitude % 1'000'000);
}

std::string shortest(double value) { return fmt::format("{}", value); }

std::string readable_time(vp::Picoseconds time) {
  const double us = static_cast<double>(time) * 1e-6;
  if (us >= 999.5) return fmt::format("{:.3f} ms", us * 1e-3);
  if (us >= 0.9995) return fmt::format("{:.1f} us", us);
  return fmt::format("{:.0f} ns", us * 1e3);
}

std::string counted(std::int64_t count, std::string_view what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

namespace {

// Three significant digits, in the unit or a thousandth of it, or a thousandth of that.
std::string scaled(double value, std::string_view unit) {
  const double magnitude = std::abs(value);
  if (magnitude >= 0.9995 || magnitude == 0) return fmt::format("{:.3g} {}", value, unit);
  if (magnitude >= 0.9995e-3) return fmt::format("{:.3g} m{}", 1e3 * value, unit);
  return fmt::format("{:.3g} u{}", 1e6 * value, unit);
}

}  // namespace

std::string newtons(double force) {
  if (!std::isfinite(force)) return "not measurable";
  return std::abs(force) > kMeasurable ? fmt::format("beyond {:g} N", kMeasurable)
                                       : scaled(force, "N");
}

std::string readable_length(double metres) { return scaled(metres, "m"); }

std::string readable_stress(double pascal) {
  constexpr std::array<std::pair<double, char>, 3> kPrefixes = {
      {{1e9, 'G'}, {1e6, 'M'}, {1e3, 'k'}}};
  for (const auto& [size, prefix] : kPrefixes) {
    if (pascal >= 0.9995 * size) return fmt::format("{:.3g} {}Pa", pascal / size, prefix);
  }
  return scaled(pascal, "Pa");
}

std::string percent(double ratio) {
  const double p = 100 * ratio;
  if (!std::isfinite(p)) return "not measurable";
  if (ratio >= kMeasurable) return fmt::format("beyond {:g} %", 100 * kMeasurable);
  if (p >= 1e6) return fmt::format("{:.2g} %", p);
  if (p >= 10) return fmt::format("{:.0f} %", p);
  if (p >= 1) return fmt::format("{:.1f} %", p);
  return fmt::format("{:.2g} %", p);
}

namespace {

std::string line(const char* what, const sparse::Spectrum& s) {
  const auto condition = s.condition();
  const std::string kappa =
      condition ? fmt::format("condition {:.4g} to {:.4g}", condition->lower, condition->upper)
                : std::string("not positive definite");
  return fmt::format("  {:<14} {}; eigenvalues from {:.4g} .. {:.4g} to {:.4g} .. {:.4g}\n", what,
                     kappa, s.smallest.lower, s.smallest.upper, s.largest.lower, s.largest.upper);
}

}  // namespace

std::string spectrum_text(const fixed::SystemSpectrum& spectrum) {
  std::string text = line("true matrix", spectrum.given);
  if (spectrum.scaled) text += line("scaled", *spectrum.scaled);
  return text + line("rounded", spectrum.rounded);
}

}  // namespace hvp::results
