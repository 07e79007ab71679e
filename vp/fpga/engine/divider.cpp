#include "vp/fpga/engine/divider.h"

#include <algorithm>

namespace hvp::vp::engine {

void Divider::configure(const fixed::Settings& settings, int clocks) {
  settings_ = settings;
  clocks_ = clocks;
}

void Divider::clocked() {
  const DivisionCommand& division = command->read();
  if (division.number != number_) {
    number_ = division.number;
    busy_ = true;
    // The command's register takes the first edge.
    left_ = std::max(1, clocks_ - 1);
  }
  if (!busy_ || --left_ > 0) return;
  busy_ = false;
  Quotient result{number_, {}};
  if (!division.hold) {
    result.value =
        machine_.divide(division.numerator, division.denominator, division.fraction_bits);
  }
  quotient.write(result);
}

}  // namespace hvp::vp::engine
