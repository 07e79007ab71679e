#pragma once

#include <string>
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

}  // namespace hvp::draw
