// The divider and the re-scaling a step a clock, against the whole operations of ReferenceMachine.
#include "models/fixed/division.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "models/fixed/reference_machine.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::division_test {
namespace {

template <class T, std::size_t N>
T one_of(test::Random& random, const std::array<T, N>& values) {
  return values[static_cast<std::size_t>(random.below(static_cast<int>(N)))];
}

Settings drawn_settings(test::Random& random) {
  Settings s;
  s.scalar_bits = one_of(random, std::array{64, 64, 128});
  s.coefficient_bits = one_of(random, std::array{8, 16, 16, 17, 24});
  s.division_rounding = one_of(
      random, std::array{Rounding::nearest_up, Rounding::nearest_even, Rounding::truncation});
  s.coefficient_format =
      random.below(2) == 0 ? CoefficientFormat::own_shift : CoefficientFormat::fixed;
  s.overflow = random.below(2) == 0 ? Overflow::saturate : Overflow::wrap;
  s.alpha_fraction_bits = random.below(41);
  s.beta_fraction_bits = random.below(41);
  return s;
}

// Of at most so many bits, and of every length alike.
UInt128 number(test::Random& random, int most_bits) {
  const UInt128 wide = (static_cast<UInt128>(random.bits()) << 64) | random.bits();
  return wide >> (128 - 1 - random.below(most_bits));
}

// The quotient of the two lies at half a unit of a mantissa, give or take three of the numerator.
UInt128 aimed(test::Random& random, const Settings& s, UInt128 denominator) {
  const int mantissa_bits = std::min(s.coefficient_bits, 1 + random.below(24));
  const UInt128 odd = (random.bits() >> (64 - mantissa_bits)) * 2 + 1;
  const UInt128 whole = denominator * odd;
  const int room = s.scalar_bits - 1 - bit_length(whole);
  if (room < 0 || bit_length(denominator) + mantissa_bits + 1 > 127) return 0;
  const UInt128 numerator = whole << random.below(room + 1);
  const auto off = static_cast<UInt128>(random.below(4));
  return random.below(2) == 0 ? numerator - std::min(off, numerator) : numerator + off;
}

int run(DivisionSteps& steps) {
  while (!steps.step()) {
    if (steps.clocks() > 1000) break;
  }
  return steps.clocks();
}

TEST(DivisionSteps, MakeTheWordsOfTheWholeDivision) {
  test::Random random(68);
  constexpr int kCases = 300'000;
  int ties = 0;
  int beyond = 0;
  DivisionSteps steps;
  for (int i = 0; i < kCases; ++i) {
    const Settings s = drawn_settings(random);
    const UInt128 limit = (UInt128{1} << (s.scalar_bits - 1)) - 1;
    const UInt128 denominator = std::max<UInt128>(1, number(random, s.scalar_bits - 1));
    UInt128 numerator =
        random.below(3) == 0 ? number(random, s.scalar_bits - 1) : aimed(random, s, denominator);
    numerator = std::min(numerator, limit);
    const int fraction = random.below(2) == 0 ? s.alpha_fraction_bits : s.beta_fraction_bits;
    ties += random.below(3) != 0 && numerator != 0 ? 1 : 0;

    Report report;
    ReferenceMachine machine(s, report);
    const Coefficient expected =
        machine.divide(static_cast<Int128>(numerator), static_cast<Int128>(denominator), fraction);
    steps.start(s, static_cast<Int128>(numerator), static_cast<Int128>(denominator), fraction);
    const int clocks = run(steps);
    ASSERT_EQ(steps.quotient(), expected)
        << "case " << i << ": " << steps.quotient().mantissa << " 2^" << steps.quotient().exponent
        << ", expected " << expected.mantissa << " 2^" << expected.exponent << "; "
        << s.coefficient_bits << " bits, fixed "
        << (s.coefficient_format == CoefficientFormat::fixed) << ", wrap "
        << (s.overflow == Overflow::wrap) << ", fraction " << fraction;
    ASSERT_EQ(steps.beyond(), report.saturations + report.wraps > 0) << "case " << i;
    ASSERT_LE(clocks, most_division_clocks(s)) << "case " << i;
    beyond += steps.beyond() ? 1 : 0;
  }
  EXPECT_GT(ties, kCases / 4);
  EXPECT_GT(beyond, kCases / 20);
}

TEST(DivisionSteps, TakeTwentyOneToThirtyFiveClocks) {
  DivisionSteps steps;
  const auto clocks = [&](Int128 numerator, Int128 denominator) {
    steps.start({}, numerator, denominator, 0);
    return run(steps);
  };
  constexpr Int128 kTop = Int128{1} << 62;
  EXPECT_EQ(clocks(kTop, kTop), 21);
  EXPECT_EQ(clocks(1, kTop), 21 + 7 + 6);
  EXPECT_EQ(clocks(1, Int128{1} << 7), 21 + 7 + 7);
  EXPECT_EQ(most_division_clocks({}), 35);
}

struct Bound {
  Settings settings;
  RescalingSteps::Operands operands;
  Coefficient coefficient;
};

Bound drawn_bound(test::Random& random) {
  Bound bound;
  Settings& s = bound.settings;
  s.coefficient_bits = one_of(random, std::array{8, 16, 16, 24});
  s.scaling_threshold = 1 + random.below(random.below(2) == 0 ? 2 : 16);
  s.scaling_step = random.below(2) == 0 ? 1 : 1 + random.below(16);
  s.scaling_down = random.below(4) != 0;
  s.dynamic_scaling = random.below(16) != 0;
  RescalingSteps::Operands& o = bound.operands;
  o.word_bits = one_of(random, std::array{12, 16, 24, 32});
  o.available_bits = o.word_bits - 1;
  o.target_bits = o.available_bits - random.below(5);
  o.a = static_cast<std::uint64_t>(number(random, 33));
  o.largest = static_cast<std::uint64_t>(number(random, 33));
  const int far = random.below(8) == 0 ? 200 : 24;
  o.a_exponent = random.below(2) == 0 ? 0 : random.below(2 * far) - far;
  o.b_exponent = random.below(2 * far) - far;
  bound.coefficient = {static_cast<std::int32_t>(number(random, s.coefficient_bits - 1)),
                       random.below(2 * far) - far};
  if (random.below(4) != 0) {
    // Both terms of one length, whose sum ends near a power of two; or a term that is cut.
    o.a = (std::uint64_t{1} << random.below(33)) + static_cast<std::uint64_t>(random.below(7));
    o.a -= std::min<std::uint64_t>(o.a, 3);
    const int lengths = bit_length(o.a) + o.a_exponent -
                        bit_length(o.largest * magnitude(bound.coefficient.mantissa)) -
                        bound.coefficient.exponent;
    o.b_exponent = lengths + random.below(7) - 3;
    if (random.below(3) == 0) o.b_exponent -= 36 + random.below(8);
  }
  return bound;
}

TEST(RescalingSteps, FindThePowerOfTheWholeRule) {
  test::Random random(82);
  constexpr int kCases = 300'000;
  int up = 0;
  int down = 0;
  RescalingSteps steps;
  for (int i = 0; i < kCases; ++i) {
    const Bound bound = drawn_bound(random);
    const RescalingSteps::Operands& o = bound.operands;
    Report report;
    const ReferenceMachine machine(bound.settings, report);
    const int expected = machine.rescaling(
        o.a, o.a_exponent, magnitude(bound.coefficient.mantissa) * o.largest,
        bound.coefficient.exponent + o.b_exponent, o.word_bits, o.target_bits, o.available_bits);
    steps.start(bound.settings, o, bound.coefficient);
    while (!steps.step()) {
      ASSERT_LE(steps.clocks(), 1000);
    }
    ASSERT_EQ(steps.up(), expected)
        << "case " << i << ": a " << o.a << " 2^" << o.a_exponent << ", b "
        << bound.coefficient.mantissa << " * " << o.largest << " 2^"
        << o.b_exponent + bound.coefficient.exponent << ", step " << bound.settings.scaling_step;
    ASSERT_EQ(steps.clocks(), rescaling_clocks(bound.settings)) << "case " << i;
    up += expected > 0 ? 1 : 0;
    down += expected < 0 ? 1 : 0;
  }
  EXPECT_GT(up, kCases / 10);
  EXPECT_GT(down, kCases / 10);
}

// The adder has 40 bits and the room of a word of 32 bits is the 2^29th part: 2^40 - 2^11 is the
// largest sum that stays below 2^40 with it, and what is cut off a term counts as one unit more.
TEST(RescalingSteps, CountWhatIsCut) {
  constexpr std::uint64_t kEdge = (std::uint64_t{1} << 29) - 1;
  struct Term {
    std::uint64_t value;
    int exponent;
  };
  RescalingSteps steps;
  const auto bits = [&](const Term& a, const Term& largest, std::int32_t mantissa) {
    const RescalingSteps::Operands operands = {.a = a.value,
                                               .a_exponent = a.exponent,
                                               .largest = largest.value,
                                               .b_exponent = largest.exponent,
                                               .word_bits = 32,
                                               .target_bits = 100,
                                               .available_bits = 100};
    steps.start({}, operands, {mantissa, 0});
    while (!steps.step()) {
    }
    Report report;
    const Settings settings;
    EXPECT_EQ(steps.up(), ReferenceMachine(settings, report)
                              .rescaling(a.value, a.exponent, magnitude(mantissa) * largest.value,
                                         largest.exponent, 32, 100, 100));
    return 100 - steps.up();
  };
  EXPECT_EQ(bits({kEdge, 0}, {0, 0}, 1), 29);
  EXPECT_EQ(bits({kEdge, 0}, {1, -12}, 1), 30);
  EXPECT_EQ(bits({kEdge, 0}, {1, -1000}, 1), 30);
  EXPECT_EQ(bits({0, 0}, {kEdge, 0}, 1), 29);
  EXPECT_EQ(bits({1, -12}, {kEdge, 0}, 1), 30);
  EXPECT_EQ(bits({1, -1000}, {kEdge, 0}, 1), 30);
  // Nothing is cut where a term has just the adder's bits.
  EXPECT_EQ(bits({0, 0}, {kEdge, 0}, 1 << 11), 40);
}

TEST(ShortestDivision, FollowsTheWords) {
  Settings s;
  EXPECT_EQ(shortest_division(s), 68);
  s.scaling_step = 2;
  EXPECT_EQ(shortest_division(s), 82);
  s.scaling_step = 1;
  s.coefficient_bits = 24;
  EXPECT_EQ(shortest_division(s), 68 + 8 + 8);
  s.coefficient_bits = 16;
  s.scalar_bits = 128;
  EXPECT_EQ(shortest_division(s), 68 + 8);
  s.scalar_bits = 64;
  s.coefficient_format = CoefficientFormat::fixed;
  EXPECT_EQ(shortest_division(s), 68);
  s.overflow = Overflow::wrap;
  s.alpha_fraction_bits = 40;
  EXPECT_EQ(shortest_division(s), 68 - 15 + 103);
}

TEST(ShortestDivision, OfTheInverseIsABitOfTheNumeratorAClock) {
  Settings s;
  EXPECT_EQ(shortest_inverse_division(s), 0);
  s.method = Method::jacobi_pcg;
  EXPECT_EQ(shortest_inverse_division(s), 4 + 31);
  s.matrix_bits = 24;
  EXPECT_EQ(shortest_inverse_division(s), 4 + 43);
  s.method = Method::block_jacobi_pcg;
  EXPECT_EQ(shortest_inverse_division(s), 4 + 89);
  s.matrix_bits = 12;
  EXPECT_EQ(shortest_inverse_division(s), 4 + 53);
}

}  // namespace
}  // namespace hvp::fixed::division_test
