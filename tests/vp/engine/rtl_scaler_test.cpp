// scaler.sv against fixed::ReferenceMachine::rescaling: whole systems seldom come to where a bit
// that was cut decides.
#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/vp/engine/clocked_module.h"
// Behind it, as it has what Verilator's headers expect.
#include <Vscaler.h>

#include "models/fixed/reference_machine.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::vp::rtl::rtl_scaler_test {
namespace {

// The parameters that the module has by itself, the thesis' words, but for that of wide words,
// which CMakeLists.txt has.
constexpr int kFirstBits = 15;
constexpr int kMantissaBits = 15;
constexpr int kLargestBits = 31;
constexpr int kWordBits = 16;
constexpr int kWideWordBits = 32;
constexpr int kAvailable = 15;
constexpr std::uint32_t kExponentMask = (1U << 22U) - 1;

struct Case {
  std::uint32_t first = 0;
  int first_exponent = 0;
  std::uint32_t mantissa = 0;
  std::uint32_t largest = 0;
  int second_exponent = 0;
  bool wide = false;
};

int word_bits(bool wide) { return wide ? kWideWordBits : kWordBits; }

class Scaler {
 public:
  int up(const Case& c, const fixed::Settings& s) {
    module_->first = static_cast<std::uint16_t>(c.first);
    module_->first_exponent = static_cast<std::uint32_t>(c.first_exponent) & kExponentMask;
    module_->mantissa = static_cast<std::uint16_t>(c.mantissa);
    module_->largest = c.largest;
    module_->second_exponent = static_cast<std::uint32_t>(c.second_exponent) & kExponentMask;
    module_->wide = c.wide ? 1 : 0;
    module_->dynamic_scaling = s.dynamic_scaling ? 1 : 0;
    module_->scaling_down = s.scaling_down ? 1 : 0;
    module_->target = static_cast<std::uint8_t>(kAvailable - s.headroom_bits);
    module_->available = kAvailable;
    module_->threshold = static_cast<std::uint8_t>(s.scaling_threshold);
    module_->step = static_cast<std::uint8_t>(s.scaling_step);
    clocks = module_.run();
    return static_cast<std::int32_t>(module_->up << 10U) >> 10;
  }

  int clocks = 0;  // of the last one

 private:
  test::ClockedModule<Vscaler> module_;
};

int expected(const Case& c, const fixed::Settings& s) {
  fixed::Report report;
  const fixed::ReferenceMachine machine(s, report);
  return machine.rescaling(c.first, c.first_exponent, std::uint64_t{c.mantissa} * c.largest,
                           c.second_exponent, word_bits(c.wide), kAvailable - s.headroom_bits,
                           kAvailable);
}

void expect_same(Scaler& scaler, const Case& c, const fixed::Settings& s) {
  ASSERT_EQ(scaler.up(c, s), expected(c, s))
      << c.first << " * 2^" << c.first_exponent << " + " << c.mantissa << " * " << c.largest
      << " * 2^" << c.second_exponent;
  ASSERT_LE(scaler.clocks, 25);
}

fixed::Settings random_settings(fixed::test::Random& random) {
  fixed::Settings s;
  s.dynamic_scaling = random.below(10) != 0;
  s.scaling_down = random.below(4) != 0;
  s.scaling_threshold = 1 + random.below(16);
  s.scaling_step = 1 + random.below(16);
  s.headroom_bits = random.below(9);
  return s;
}

TEST(RtlScaler, AgreesOnRandomBounds) {
  Scaler scaler;
  fixed::test::Random random(1);
  const auto word = [&](int bits) {
    const int length = random.below(bits + 1);
    return static_cast<std::uint32_t>(random.bits() & ((std::uint64_t{1} << length) - 1));
  };
  for (int i = 0; i < 60'000; ++i) {
    const fixed::Settings s = random_settings(random);
    const Case c = {.first = word(kFirstBits),
                    .first_exponent = random.below(60) - 30,
                    .mantissa = word(kMantissaBits),
                    .largest = word(kLargestBits),
                    .second_exponent = random.below(120) - 80,
                    .wide = random.below(2) == 0};
    expect_same(scaler, c, s);
    if (HasFatalFailure()) return;
  }
}

constexpr std::uint64_t kOne = 1;
constexpr int kAdderBits = 40;

// The least sum that has a bit more than the adder once room for the rounding is added.
std::uint64_t least_sum(bool wide) {
  const auto length = [&](std::uint64_t sum) {
    return fixed::bit_length(sum + (sum >> (word_bits(wide) - 3)));
  };
  std::uint64_t least = kOne << (kAdderBits - 1);
  for (int bit = kAdderBits - 2; bit >= 0; --bit) {
    if (length(least + (kOne << bit) - 1) == kAdderBits) least += kOne << bit;
  }
  EXPECT_EQ(length(least), kAdderBits + 1);
  EXPECT_EQ(length(least - 1), kAdderBits);
  return least;
}

// Sums within two units of the adder of one that has a bit more, with a second term that is cut.
void compare_cut_bits(bool wide) {
  constexpr int kBelowFirst = kAdderBits - kFirstBits;
  const std::uint64_t least = least_sum(wide);
  Scaler scaler;
  fixed::Settings s;
  s.headroom_bits = 0;
  int grown = 0;
  for (int exponent = -20; exponent <= 20; ++exponent) {
    for (int beside = -3; beside <= 3; ++beside) {
      const auto low = static_cast<std::uint32_t>((least & ((kOne << kBelowFirst) - 1)) +
                                                  static_cast<std::uint64_t>(beside));
      // 2^14 · low, of which the adder sees `low` and that it was cut.
      const Case c = {.first = static_cast<std::uint32_t>(least >> kBelowFirst),
                      .first_exponent = exponent,
                      .mantissa = 1U << 14U,
                      .largest = low,
                      .second_exponent = exponent - kBelowFirst - 14,
                      .wide = wide};
      expect_same(scaler, c, s);
      if (testing::Test::HasFatalFailure()) return;
      const Case alone = {.first = c.first, .first_exponent = exponent, .wide = wide};
      if (expected(c, s) != expected(alone, s)) ++grown;
    }
  }
  EXPECT_EQ(grown, 41 * 5);  // from one below on, as the cut counts as one
}

TEST(RtlScaler, AgreesWhereACutBitDecides) { compare_cut_bits(false); }
TEST(RtlScaler, AgreesWhereACutBitDecidesOfWideWords) { compare_cut_bits(true); }

// A term that is shifted out altogether still counts as one.
TEST(RtlScaler, AgreesWhereATermIsShiftedOut) {
  const std::uint64_t least = least_sum(false);
  Scaler scaler;
  fixed::Settings s;
  s.headroom_bits = 0;
  int grown = 0;
  for (std::uint32_t mantissa = 1U << 14U; mantissa < 1U << 15U; ++mantissa) {
    for (int cut = 5; cut <= 6; ++cut) {
      // Factors of a product of which the adder sees two less than that: the cuts count as one
      // each.
      const std::uint64_t wanted = (least - 2) << cut;
      const std::uint64_t largest = (wanted + mantissa - 1) / mantissa;
      if (largest >> kLargestBits != 0 || (mantissa * largest) >> cut != least - 2) continue;
      Case c = {.mantissa = mantissa, .largest = static_cast<std::uint32_t>(largest)};
      const int alone = expected(c, s);
      c.first = 1;
      c.first_exponent = -100;
      expect_same(scaler, c, s);
      if (HasFatalFailure()) return;
      if (expected(c, s) != alone) ++grown;
    }
  }
  EXPECT_GE(grown, 5);
}

// The largest shift has eight bits, and a bound that asks for more gets that, in whole steps. No
// engine has words so far apart.
TEST(RtlScaler, AShiftBeyondTheLargestIsTheLargest) {
  constexpr int kLargestShift = 255;
  Scaler scaler;
  fixed::test::Random random(2);
  int longer = 0;
  for (int i = 0; i < 20'000; ++i) {
    fixed::Settings s = random_settings(random);
    s.dynamic_scaling = true;
    const int exponent = random.below(1'200) - 600;
    const Case c = {.first = 1U + static_cast<std::uint32_t>(random.below(1 << 14U)),
                    .first_exponent = exponent,
                    .second_exponent = exponent};
    const int step = s.scaling_step;
    const int up = kLargestShift / step * step;
    const int wanted = std::clamp(expected(c, s), -up, up);
    ASSERT_EQ(scaler.up(c, s), wanted) << c.first << " * 2^" << exponent << " by " << step;
    longer += wanted == expected(c, s) ? 0 : 1;
  }
  EXPECT_GT(longer, 1'000);
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_scaler_test
