#include "models/fixed/reference_machine.h"

namespace hvp::fixed {

namespace {

// Bits of a·2^a_exponent + b·2^b_exponent, rounded up; negative for sums under one half. Both
// terms are cut to 40 bits of the larger, as an adder behind two shifters would. The sum is
// taken a little too large, by four units of a word of `word_bits` that it just fills: room for
// the rounding of the two terms, so that what is scaled by this bound cannot saturate.
int sum_bit_length(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent,
                   int word_bits) {
  constexpr int kAdderBits = 40;
  if (a == 0 && b == 0) return 0;
  const int a_top = bit_length(a) + a_exponent;
  const int b_top = bit_length(b) + b_exponent;
  const int top = a == 0 ? b_top : b == 0 ? a_top : std::max(a_top, b_top);
  const int unit = top - kAdderBits;
  const auto aligned = [unit](std::uint64_t value, int exponent) {
    if (value == 0) return std::uint64_t{0};
    const int left = exponent - unit;
    if (left >= 0) return value << left;
    return left > -64 ? (value >> -left) + 1 : std::uint64_t{1};
  };
  const std::uint64_t sum = aligned(a, a_exponent) + aligned(b, b_exponent);
  return bit_length(sum + (sum >> (word_bits - 3))) + unit;
}

}  // namespace

int ReferenceMachine::rescaling(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent,
                                int word_bits, int target_bits, int available_bits) const {
  if (!settings_.dynamic_scaling) return 0;
  const int bits = sum_bit_length(a, a_exponent, b, b_exponent, word_bits);
  const int step = settings_.scaling_step;
  const int unused = target_bits - bits;
  if (unused >= settings_.scaling_threshold) return unused / step * step;
  const int excess = bits - available_bits;
  if (excess > 0 && settings_.scaling_down) return -((excess + step - 1) / step * step);
  return 0;
}

}  // namespace hvp::fixed
