#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/word.h"

namespace hvp::fixed {

// A vector of words with one exponent: entry i is worth word[i] · 2^-exponent, in units of A·x
// for residuals and products, in those of x for x, d and z scaled alike.
struct ScaledVector {
  std::vector<std::int32_t> word;
  int exponent = 0;

  std::uint64_t largest() const {
    std::uint64_t result = 0;
    for (const std::int32_t w : word) result = std::max(result, magnitude(w));
    return result;
  }
  bool all_zero() const { return largest() == 0; }
};

// An inner product and its exponent: worth word · 2^-exponent.
struct ScaledScalar {
  Int128 word = 0;
  int exponent = 0;
};

// The registers' rules: how a value becomes a word of the settings. Counts and flags what does
// not fit, in the report of the solve that runs.
class ReferenceMachine {
 public:
  ReferenceMachine(const Settings& settings, Report& report)
      : settings_(settings), report_(report) {}

  std::int64_t rounded_shift(std::int64_t value, int exponent) const {
    return shift(value, exponent, settings_.shift_rounding);
  }

  std::int32_t write(std::int64_t value, int bits) {
    if (settings_.overflow == Overflow::saturate) {
      return static_cast<std::int32_t>(saturate(value, word_limit(bits), report_.saturations));
    }
    return static_cast<std::int32_t>(wrap(value, bits, report_.wraps));
  }

  // The sum of the products is exact; it becomes a scalar once.
  ScaledScalar inner_product(const ScaledVector& a, const ScaledVector& b) {
    Int128 sum = 0;
    for (std::size_t i = 0; i < a.word.size(); ++i) {
      sum += static_cast<Int128>(a.word[i]) * b.word[i];
    }
    return {write_scalar(sum), a.exponent + b.exponent};
  }

  Int128 write_scalar(Int128 value) {
    std::int64_t count = 0;
    const auto limit = static_cast<Int128>((UInt128{1} << (settings_.scalar_bits - 1)) - 1);
    const Int128 word = settings_.overflow == Overflow::saturate
                            ? saturate(value, limit, count)
                            : wrap(value, settings_.scalar_bits, count);
    if (count > 0) report_.flags.raise(stability::Flag::scalar_overflow);
    if (count > 0 && settings_.overflow == Overflow::wrap) ++report_.wraps;
    return word;
  }

  Int128 shift_scalar(Int128 value, int exponent) {
    std::int64_t count = 0;
    const Int128 result = fixed::shift_scalar(value, exponent, settings_.shift_rounding, count);
    if (count > 0) report_.flags.raise(stability::Flag::scalar_overflow);
    return result;
  }

  // The quotient of two scalars as they are, exponents aside. numerator >= 0, denominator > 0.
  Coefficient divide(Int128 numerator, Int128 denominator, int fraction_bits) {
    if (settings_.coefficient_format == CoefficientFormat::own_shift) {
      return ratio(numerator, denominator, settings_.coefficient_bits, settings_.division_rounding);
    }
    bool huge = false;
    const UInt128 quotient =
        fixed_ratio(numerator, denominator, fraction_bits, settings_.division_rounding, huge);
    const bool beyond =
        huge || quotient > static_cast<UInt128>(word_limit(settings_.coefficient_bits));
    Int128 mantissa = static_cast<Int128>(quotient);
    if (beyond && settings_.overflow == Overflow::saturate) {
      ++report_.saturations;
      mantissa = word_limit(settings_.coefficient_bits);
    } else if (beyond) {
      std::int64_t ignored = 0;
      ++report_.wraps;
      mantissa = wrap(mantissa, settings_.coefficient_bits, ignored);
    }
    if (mantissa == 0) return {};
    return {static_cast<std::int32_t>(mantissa), -fraction_bits};
  }

  // By which power of two a vector is re-scaled whose entries are bounded by
  // a·2^a_exponent + b·2^b_exponent: up until that has `target_bits` of magnitude, down where it
  // has more than are available. Known before the first word is written, so nothing saturates.
  int rescaling(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent, int word_bits,
                int target_bits, int available_bits) const;

 private:
  const Settings& settings_;
  Report& report_;
};

}  // namespace hvp::fixed
