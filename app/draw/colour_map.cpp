#include "app/draw/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace hvp::draw {
namespace {

using Triple = std::array<double, 3>;

// White point D65, 2° observer (CIE 15).
constexpr Triple kWhite = {0.95047, 1.0, 1.08883};

double to_linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }

double to_srgb(double c) {
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

constexpr double kDelta = 6.0 / 29.0;

double lab_forward(double t) {
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

double lab_inverse(double t) {
  return t > kDelta ? t * t * t : 3.0 * kDelta * kDelta * (t - 4.0 / 29.0);
}

Colour from_lab(const Triple& lab) {
  const double fy = (lab[0] + 16.0) / 116.0;
  const double x = kWhite[0] * lab_inverse(fy + lab[1] / 500.0);
  const double y = kWhite[1] * lab_inverse(fy);
  const double z = kWhite[2] * lab_inverse(fy - lab[2] / 200.0);
  const auto byte = [](double linear) {
    return static_cast<std::uint8_t>(
        std::lround(255.0 * std::clamp(to_srgb(std::clamp(linear, 0.0, 1.0)), 0.0, 1.0)));
  };
  return {byte(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          byte(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          byte(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

// The path through CIELAB: pale yellow over orange and magenta to a dark violet. The chroma
// stays inside the sRGB gamut at every lightness.
Triple path(double s) {
  constexpr double kLightest = 91.0;
  constexpr double kDarkest = 22.0;
  const double hue = (88.0 - 135.0 * s) * std::numbers::pi / 180.0;
  const double chroma = 24.0 + 32.0 * std::sin(std::numbers::pi * s);
  return {kLightest + (kDarkest - kLightest) * s, chroma * std::cos(hue), chroma * std::sin(hue)};
}

}  // namespace

Colour faded(Colour colour, double opacity) {
  colour.alpha = static_cast<std::uint8_t>(std::lround(255.0 * opacity));
  return colour;
}

std::array<double, 3> lab_of(Colour colour) {
  const double r = to_linear(colour.red / 255.0);
  const double g = to_linear(colour.green / 255.0);
  const double b = to_linear(colour.blue / 255.0);
  const double fx = lab_forward((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / kWhite[0]);
  const double fy = lab_forward((0.2126729 * r + 0.7151522 * g + 0.0721750 * b) / kWhite[1]);
  const double fz = lab_forward((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / kWhite[2]);
  return {116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)};
}

Colour sequential_colour(double t) { return from_lab(path(std::clamp(t, 0.0, 1.0))); }

}  // namespace hvp::draw
