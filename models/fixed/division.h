#pragma once

#include <cstdint>

#include "models/fixed/settings.h"
#include "models/fixed/types.h"
#include "models/fixed/word.h"

// α and β and the re-scaling that they lead to, as hardware makes them: one short step a clock
// (docs/accelerator.md, divisions). The words are those of ReferenceMachine, which has whole
// operations for them; division_test.cpp holds the two together.
namespace hvp::fixed {

// A divider of two scalars: both are brought to the left end of their registers, by bytes and then
// by bits; then it compares and subtracts, one bit of the quotient a clock.
class DivisionSteps {
 public:
  // numerator >= 0, denominator > 0, both below 2^(scalar_bits - 1). A denominator of zero, which
  // only a flipped bit makes, gives a quotient of all ones before it is rounded. This is the first
  // clock.
  void start(const Settings& settings, Int128 numerator, Int128 denominator, int fraction_bits);
  // One clock more; true with the last one.
  bool step();

  int clocks() const { return clocks_; }
  Coefficient quotient() const { return result_; }
  // A quotient of CoefficientFormat::fixed does not fit its mantissa.
  bool beyond() const { return beyond_; }

 private:
  enum class Phase { bytes, bits, compare, subtract, round, carry, done };

  void normalise(int by);
  void compare();
  void carry();

  Settings settings_;
  Phase phase_ = Phase::done;
  UInt128 rest_ = 0;     // a bit more than a scalar: it is doubled
  UInt128 divisor_ = 1;  // as wide as a scalar's magnitude
  std::uint32_t quotient_ = 0;
  int fraction_bits_ = 0;
  int exponent_ = 0;
  int left_ = 0;  // bits of the quotient
  int clocks_ = 0;
  bool zero_ = false;
  bool nothing_ = false;  // the denominator is
  bool up_ = false;
  bool beyond_ = false;
  Coefficient result_;
};

// The re-scaling behind it, with the bound that ReferenceMachine::rescaling() states: a serial
// product of mantissa and largest word, two lengths, two shifts, sum, length, and where
// scaling_step is not one, a serial division by it.
class RescalingSteps {
 public:
  // The entries are bounded by a·2^a_exponent + (mantissa·largest)·2^b_exponent.
  struct Operands {
    std::uint64_t a = 0;
    int a_exponent = 0;
    std::uint64_t largest = 0;
    int b_exponent = 0;  // beside the mantissa's own
    int word_bits = 16;
    int target_bits = 14;
    int available_bits = 15;
  };

  // The mantissa's exponent is added to Operands::b_exponent. This is the first clock.
  void start(const Settings& settings, const Operands& operands, const Coefficient& coefficient);
  bool step();

  int clocks() const { return clocks_; }
  // The power of two; zero without dynamic scaling.
  int up() const { return up_; }

 private:
  enum class Phase {
    multiply,
    lengths,
    tops,
    larger,
    distances,
    shift_a,
    shift_b,
    cut_a,
    cut_b,
    sum,
    room,
    length,
    size,
    compare,
    divide,
    sign,
    done
  };

  void choose();
  void divide();

  Settings settings_;
  Operands operands_;
  Phase phase_ = Phase::done;
  std::uint64_t mantissa_ = 0;
  std::uint64_t b_ = 0;
  int b_exponent_ = 0;
  int left_ = 0;  // clocks of a serial operation
  int a_top_ = 0;
  int b_top_ = 0;
  int unit_ = 0;
  std::uint64_t sum_ = 0;
  std::uint64_t a_aligned_ = 0;
  std::uint64_t b_aligned_ = 0;
  bool down_ = false;
  bool scales_ = false;
  int size_ = 0;  // of the power, before it becomes a multiple of the step
  int remainder_ = 0;
  int clocks_ = 0;
  int up_ = 0;
};

// The bits of a re-scaling's own numbers.
inline constexpr int kRescalingBits = 14;

// The most clocks that a division takes with these settings: 35 with the thesis' words.
int most_division_clocks(const Settings& settings);
// Those of every re-scaling: 30, or 44 where scaling_step is not one.
int rescaling_clocks(const Settings& settings);
// The shortest time from the command to coefficient and power in their registers, that of command
// and quotient and the sequencer's included: 68 with the thesis' words and steps of one bit.
int shortest_division(const Settings& settings);
// The same of one quotient of P⁻¹: a bit of its numerator a clock. Zero without a preconditioner.
int shortest_inverse_division(const Settings& settings);

}  // namespace hvp::fixed
