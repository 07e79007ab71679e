// The parts of an iteration that are no vectors: scalars, coefficients, exponents.
#include <algorithm>

#include "models/fixed/fast/fast_solver.h"

namespace hvp::fixed::fast {

namespace {

// The most bits that a·2^a_exponent + b·2^b_exponent can have, in the arithmetic that
// docs/fixed-point.md defines: an adder of 40 bits, and an allowance for the rounding of a word.
int bits_of_sum(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent, int word_bits) {
  constexpr int kAdderBits = 40;
  constexpr int kNothing = -1 << 20;
  const int a_top = a == 0 ? kNothing : width(a) + a_exponent;
  const int b_top = b == 0 ? kNothing : width(b) + b_exponent;
  const int top = std::max(a_top, b_top);
  if (top == kNothing) return 0;
  const int unit = top - kAdderBits;
  std::uint64_t sum = 0;
  for (const auto& [size, exponent] : {std::pair{a, a_exponent}, std::pair{b, b_exponent}}) {
    if (size == 0) continue;
    const int places = exponent - unit;
    // A term below the adder's bits counts as a whole unit.
    sum += places >= 0 ? size << places : (places > -64 ? size >> -places : 0) + 1;
  }
  return width(sum + (sum >> (word_bits - 3))) + unit;
}

}  // namespace

FastSolver::Scalar FastSolver::scalar(Int128 value, int exponent) {
  if (!to_scalar(value, settings_.scalar_bits, settings_.overflow)) {
    report_.flags.raise(stability::Flag::scalar_overflow);
    if (settings_.overflow == Overflow::wrap) ++report_.wraps;
  }
  return {value, exponent};
}

Coefficient FastSolver::divide(Int128 numerator, Int128 denominator, int fraction_bits) {
  const int bits = settings_.coefficient_bits;
  if (settings_.coefficient_format == CoefficientFormat::own_shift) {
    return mantissa_of_ratio(numerator, denominator, bits, settings_.division_rounding);
  }
  bool beyond = false;
  const std::int64_t limit = largest_word(bits);
  auto mantissa = static_cast<std::int64_t>(fixed_point_ratio(
      numerator, denominator, fraction_bits, settings_.division_rounding, limit, beyond));
  if (beyond) {
    std::int64_t ignored = 0;
    mantissa = settings_.overflow == Overflow::saturate
                   ? limit
                   : to_word(mantissa, bits, Overflow::wrap, ignored);
    count(1);
  }
  if (mantissa == 0) return {};
  return {static_cast<std::int32_t>(mantissa), -fraction_bits};
}

void FastSolver::form_alpha() {
  alpha_ = divide(z_r_.word, d_q_.word, settings_.alpha_fraction_bits);
  alpha_.exponent += d_q_.exponent - z_r_.exponent;
  shown_alpha_ = {alpha_.mantissa, alpha_.exponent - q_.exponent + r_.exponent};
}

void FastSolver::form_beta(const Scalar& z_r_old) {
  beta_ = {};
  if (z_r_.word <= 0) return;
  beta_ = divide(z_r_.word, z_r_old.word, settings_.beta_fraction_bits);
  beta_.exponent += z_r_old.exponent - z_r_.exponent;
}

// δ - β²·dᵀA·d, where rounding leaves something of it; else the directions start anew.
void FastSolver::follow_curvature(const Scalar& delta) {
  const int mantissa_bits = settings_.coefficient_bits - 1;
  Int128 carried = beta_.mantissa * d_q_.word;
  bool fits = shift_scalar(carried, -mantissa_bits, settings_.shift_rounding);
  carried *= beta_.mantissa;
  fits = shift_scalar(carried, 2 * beta_.exponent + mantissa_bits - d_q_.exponent + delta.exponent,
                      settings_.shift_rounding) &&
         fits;
  if (!fits) report_.flags.raise(stability::Flag::scalar_overflow);
  d_q_ = scalar(delta.word - carried, delta.exponent);
  if (d_q_.word > 0 || delta.word <= 0) return;
  beta_ = {};
  d_q_ = delta;
}

// By which power of two a vector with this bound is re-scaled (docs/fixed-point.md).
int FastSolver::rescaling(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent,
                          int word_bits, int target_bits, int available_bits) const {
  if (!settings_.dynamic_scaling) return 0;
  const int step = settings_.scaling_step;
  const int bits = bits_of_sum(a, a_exponent, b, b_exponent, word_bits);
  if (target_bits - bits >= settings_.scaling_threshold) {
    return (target_bits - bits) / step * step;
  }
  if (!settings_.scaling_down || bits <= available_bits) return 0;
  return (available_bits - bits - step + 1) / step * step;
}

}  // namespace hvp::fixed::fast
