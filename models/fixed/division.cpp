#include "models/fixed/division.h"

#include <algorithm>

#include "models/fixed/reference_machine.h"
#include "models/fixed/reference_preconditioner.h"

namespace hvp::fixed {

namespace {

int magnitude_bits(const Settings& s) { return s.scalar_bits - 1; }

// value · 2^left, cut; what is cut is counted as one, a clock later.
std::uint64_t aligned(std::uint64_t value, int left) {
  if (left >= 0) return value << left;
  return left > -64 ? value >> -left : 0;
}

}  // namespace

void DivisionSteps::start(const Settings& settings, Int128 numerator, Int128 denominator,
                          int fraction_bits) {
  settings_ = settings;
  rest_ = static_cast<UInt128>(numerator);
  divisor_ = static_cast<UInt128>(denominator);
  fraction_bits_ = fraction_bits;
  zero_ = numerator == 0;
  nothing_ = denominator == 0;
  beyond_ = false;
  exponent_ = 0;
  result_ = {};
  clocks_ = 1;
  phase_ = Phase::bytes;
}

bool DivisionSteps::step() {
  ++clocks_;
  switch (phase_) {
    case Phase::bytes:
      normalise(8);
      break;
    case Phase::bits:
      normalise(1);
      break;
    case Phase::compare:
      compare();
      break;
    case Phase::subtract: {
      const bool fits = rest_ >= divisor_;
      const std::uint32_t mask = (std::uint32_t{2} << (settings_.coefficient_bits - 1)) - 1;
      beyond_ = beyond_ || (quotient_ >> (settings_.coefficient_bits - 1)) != 0;
      quotient_ = (quotient_ << 1 | (fits ? 1U : 0U)) & mask;
      rest_ = (fits ? rest_ - divisor_ : rest_) << 1;
      if (--left_ == 0) phase_ = Phase::round;
      break;
    }
    case Phase::round:
      up_ = rounds_up(rest_, divisor_, (quotient_ & 1U) != 0, settings_.division_rounding);
      phase_ = Phase::carry;
      break;
    case Phase::carry:
      carry();
      phase_ = Phase::done;
      break;
    case Phase::done:
      break;
  }
  return phase_ == Phase::done;
}

// Both operands side by side, until the top byte, then the top bit, is not zero.
void DivisionSteps::normalise(int by) {
  const int rest_of = magnitude_bits(settings_) - by;
  const bool moves = !zero_ && (rest_ >> rest_of) == 0;
  const bool divisor_moves = !nothing_ && (divisor_ >> rest_of) == 0;
  if (moves) {
    rest_ <<= by;
    exponent_ -= by;
  }
  if (divisor_moves) {
    divisor_ <<= by;
    exponent_ += by;
  }
  if (!moves && !divisor_moves) phase_ = by == 8 ? Phase::bits : Phase::compare;
}

// From here on the quotient of the registers is from one to two.
void DivisionSteps::compare() {
  if (rest_ < divisor_) {
    rest_ <<= 1;
    --exponent_;
  }
  quotient_ = 0;
  left_ = settings_.coefficient_bits - 1;
  if (settings_.coefficient_format == CoefficientFormat::fixed) {
    left_ = exponent_ + fraction_bits_ + 1;
    if (!zero_ && left_ > settings_.coefficient_bits - 1 &&
        settings_.overflow == Overflow::saturate) {
      beyond_ = true;
      left_ = 0;
    }
    // Under half a unit.
    if (left_ < 0) zero_ = true;
  }
  phase_ = zero_ || left_ <= 0 ? Phase::round : Phase::subtract;
}

void DivisionSteps::carry() {
  if (zero_) return;
  const int bits = settings_.coefficient_bits;
  std::uint32_t quotient = quotient_ + (up_ ? 1U : 0U);
  if (settings_.coefficient_format == CoefficientFormat::own_shift) {
    exponent_ -= bits - 2;
    if (quotient >> (bits - 1) != 0) {
      quotient >>= 1;
      ++exponent_;
    }
    result_ = {static_cast<std::int32_t>(quotient), exponent_};
    return;
  }
  beyond_ = beyond_ || static_cast<std::int64_t>(quotient) > word_limit(bits);
  std::int64_t mantissa = quotient;
  if (beyond_ && settings_.overflow == Overflow::saturate) {
    mantissa = word_limit(bits);
  } else if (beyond_) {
    std::int64_t ignored = 0;
    mantissa = static_cast<std::int64_t>(wrap(mantissa, bits, ignored));
  }
  if (mantissa != 0) result_ = {static_cast<std::int32_t>(mantissa), -fraction_bits_};
}

void RescalingSteps::start(const Settings& settings, const Operands& operands,
                           const Coefficient& coefficient) {
  settings_ = settings;
  operands_ = operands;
  mantissa_ = magnitude(coefficient.mantissa);
  b_ = 0;
  b_exponent_ = operands.b_exponent + coefficient.exponent;
  left_ = settings.coefficient_bits - 1;
  up_ = 0;
  clocks_ = 1;
  phase_ = Phase::multiply;
}

bool RescalingSteps::step() {
  ++clocks_;
  const auto next = static_cast<Phase>(static_cast<int>(phase_) + 1);
  switch (phase_) {
    case Phase::multiply: {  // the mantissa's highest bit first
      --left_;
      b_ = (b_ << 1) + ((mantissa_ >> left_ & 1U) != 0 ? operands_.largest : 0);
      if (left_ > 0) return false;
      break;
    }
    case Phase::lengths:
      a_top_ = bit_length(operands_.a);
      b_top_ = bit_length(b_);
      break;
    case Phase::tops:
      a_top_ += operands_.a_exponent;
      b_top_ += b_exponent_;
      break;
    case Phase::larger:
      unit_ = operands_.a == 0 ? b_top_ : b_ == 0 ? a_top_ : std::max(a_top_, b_top_);
      break;
    case Phase::distances:
      unit_ -= kRescalingAdderBits;
      break;
    case Phase::shift_a:
      a_aligned_ = operands_.a == 0 ? 0 : aligned(operands_.a, operands_.a_exponent - unit_);
      break;
    case Phase::shift_b:
      b_aligned_ = b_ == 0 ? 0 : aligned(b_, b_exponent_ - unit_);
      break;
    case Phase::cut_a:
      if (operands_.a != 0 && operands_.a_exponent < unit_) ++a_aligned_;
      break;
    case Phase::cut_b:
      if (b_ != 0 && b_exponent_ < unit_) ++b_aligned_;
      break;
    case Phase::sum:
      sum_ = a_aligned_ + b_aligned_;
      break;
    case Phase::room:
      sum_ += sum_ >> (operands_.word_bits - 3);
      break;
    case Phase::length:
      size_ = bit_length(sum_);
      break;
    case Phase::size:
      if (sum_ != 0) size_ += unit_;
      break;
    case Phase::compare:
      choose();
      if (settings_.scaling_step != 1) break;
      phase_ = Phase::sign;
      return false;
    case Phase::divide:
      --left_;
      divide();
      if (left_ > 0) return false;
      break;
    case Phase::sign:
      if (scales_) up_ = down_ ? -(size_ - remainder_) : size_ - remainder_;
      break;
    case Phase::done:
      return true;
  }
  phase_ = next;
  return phase_ == Phase::done;
}

// Up until target_bits are filled, down where there are more than available_bits.
void RescalingSteps::choose() {
  const int unused = operands_.target_bits - size_;
  const int excess = size_ - operands_.available_bits;
  down_ = unused < settings_.scaling_threshold;
  scales_ = settings_.dynamic_scaling && (!down_ || (excess > 0 && settings_.scaling_down));
  size_ = down_ ? excess + settings_.scaling_step - 1 : unused;
  remainder_ = 0;
  left_ = kRescalingBits;
}

// A bit of the size more, and the step subtracted where it fits; the quotient is not kept, since a
// multiple of the step is the size without its remainder.
void RescalingSteps::divide() {
  if (!scales_) return;
  remainder_ = 2 * remainder_ + (size_ >> left_ & 1);
  if (remainder_ >= settings_.scaling_step) remainder_ -= settings_.scaling_step;
}

int most_division_clocks(const Settings& s) {
  // Load, compare, round and carry; a clock each in which no byte and no bit is moved any more.
  constexpr int kOthers = 6;
  constexpr int kBits = 7;
  const int bytes = (magnitude_bits(s) - 1) / 8;
  int subtractions = s.coefficient_bits - 1;
  if (s.coefficient_format == CoefficientFormat::fixed && s.overflow == Overflow::wrap) {
    subtractions = magnitude_bits(s) + std::max(s.alpha_fraction_bits, s.beta_fraction_bits);
  }
  return kOthers + bytes + kBits + subtractions;
}

int rescaling_clocks(const Settings& s) {
  constexpr int kOthers = 15;  // load, and every phase that is not serial
  return kOthers + s.coefficient_bits - 1 + (s.scaling_step == 1 ? 0 : kRescalingBits);
}

int shortest_division(const Settings& s) {
  constexpr int kRegisters = 3;
  return kRegisters + most_division_clocks(s) + rescaling_clocks(s);
}

int shortest_inverse_division(const Settings& s) {
  if (!s.preconditioned()) return 0;
  constexpr int kOthers = 4;  // load, round, clamp, write
  // A cofactor is a difference of two products of matrix words.
  const int numerator = s.method == Method::block_jacobi_pcg ? 2 * s.matrix_bits - 1 : 1;
  return kOthers + numerator + ReferencePreconditioner::scale_bits(s);
}

}  // namespace hvp::fixed
