#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hvp::draw {

struct Ticks {
  double step = 1.0;
  std::vector<double> values;       // multiples of step within [low, high], ascending
  std::vector<std::string> labels;  // as many decimals as the step needs, the same for all
};

// About `wanted` round ticks (1, 2 or 5 times a power of ten apart) within [low, high];
// low < high, both finite, wanted ≥ 1.
Ticks round_ticks(double low, double high, int wanted);

// Whole-number ticks for a count (frames): as above with a step of at least one.
Ticks whole_ticks(double low, double high, int wanted);

// At most four significant digits, without an exponent where that is readable and without
// trailing zeros: "0.0123", "842.4", "1.2", "12345".
std::string four_digits(double value);

// A unit to write values in: "mm" is 1e-3 of "m".
struct Unit {
  double size = 1.0;
  std::string name;
};

// For values up to `largest` of the unit `symbol`: the preferred one, a power of 1000 such as 1e-3,
// where they are 0.01 to 10 000 of it, as zero is, else one in which they are 1 to 1000.
Unit unit_for(double largest, std::string_view symbol, double preferred);

}  // namespace hvp::draw
