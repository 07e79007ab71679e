// coefficient_divider.sv against fixed::ratio: whole systems seldom come to a tie.
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/vp/engine/clocked_module.h"
// Behind it, as it has what Verilator's headers expect.
#include <Vcoefficient_divider.h>

#include "models/fixed/word.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::vp::rtl::rtl_divider_test {
namespace {

// The parameters that the module has by itself: the thesis' words.
constexpr int kMantissaBits = 16;
constexpr int kScalarBits = 64;
constexpr int kMostClocks = 6 + (kScalarBits - 1) / 8 + 7 + kMantissaBits;

class Divider {
 public:
  fixed::Coefficient ratio(std::uint64_t numerator, std::uint64_t denominator,
                           fixed::Rounding rounding) {
    module_->rounding = static_cast<std::uint8_t>(rounding);
    module_->numerator = numerator;
    module_->denominator = denominator;
    clocks = module_.run();
    return {static_cast<std::int32_t>(module_->mantissa),
            static_cast<std::int32_t>(module_->exponent << 10U) >> 10};
  }

  int clocks = 0;  // of the last one

 private:
  test::ClockedModule<Vcoefficient_divider> module_;
};

void expect_same(Divider& divider, std::uint64_t numerator, std::uint64_t denominator) {
  for (const auto rounding :
       {fixed::Rounding::nearest_even, fixed::Rounding::nearest_up, fixed::Rounding::truncation}) {
    const fixed::Coefficient is = divider.ratio(numerator, denominator, rounding);
    const fixed::Coefficient should =
        fixed::ratio(static_cast<fixed::Int128>(numerator), static_cast<fixed::Int128>(denominator),
                     kMantissaBits, rounding);
    ASSERT_EQ(is.mantissa, should.mantissa) << numerator << " / " << denominator;
    ASSERT_EQ(is.exponent, should.exponent) << numerator << " / " << denominator;
    ASSERT_LE(divider.clocks, kMostClocks);
  }
}

TEST(RtlDivider, AgreesOnRandomScalars) {
  Divider divider;
  fixed::test::Random random(1);
  const auto scalar = [&] {
    const int length = random.below(kScalarBits);
    return random.bits() & ((std::uint64_t{1} << length) - 1);
  };
  for (int i = 0; i < 20'000; ++i) {
    expect_same(divider, scalar(), scalar() | 1U);
    if (HasFatalFailure()) return;
  }
}

// Quotients halfway between two mantissas and a remainder beside, and those that carry out of one.
TEST(RtlDivider, AgreesOnTiesAndCarries) {
  Divider divider;
  fixed::test::Random random(2);
  for (int i = 0; i < 5'000; ++i) {
    const std::uint64_t tie = std::uint64_t{0x8001} | (random.bits() & 0xffffU);  // 16 bits, odd
    const int up = random.below(40);
    const std::uint64_t odd = random.bits() % 0x7fff | 1U;
    expect_same(divider, tie << up, std::uint64_t{1} << random.below(62));
    expect_same(divider, tie * odd, odd);
    expect_same(divider, tie * odd * 16 + 1, odd);
    expect_same(divider, tie * odd * 16 - 1, odd);
    expect_same(divider, (std::uint64_t{0xffff} << up) + 1, odd);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_divider_test
