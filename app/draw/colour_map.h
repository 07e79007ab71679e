#pragma once

#include <array>
#include <cstdint>

namespace hvp::draw {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  std::uint8_t alpha = 255;

  bool operator==(const Colour&) const = default;
};

// The same colour with another opacity, 0 to 1.
Colour faded(Colour colour, double opacity);

// CIELAB (D65) of an opaque sRGB colour: {L*, a*, b*}; IEC 61966-2-1 and CIE 15.
std::array<double, 3> lab_of(Colour colour);

// A sequential colour map for t in [0, 1] (clamped), from light at 0 to dark at 1. Lightness falls
// linearly in CIELAB and the steps between neighbours are of one size, so that equal differences of
// the value look equal, also to the colour-blind and in grey.
Colour sequential_colour(double t);

}  // namespace hvp::draw
