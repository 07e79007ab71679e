// stop_test.sv against fixed::StopTest: whole systems seldom come to a tie, or to a mantissa that
// rounds up to a power of two.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/vp/engine/clocked_module.h"
// Behind it, as it has what Verilator's headers expect.
#include <Vstop_test.h>

#include "models/fixed/stop_test.h"
#include "models/fixed/types.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/stop_cases.h"

namespace hvp::vp::rtl::rtl_stop_test_test {
namespace {

using fixed::UInt128;
using hvp::test::StopCase;

// CMakeLists.txt has it too: more than 64, so that there are bytes beyond eight.
constexpr int kSquareBits = 79;
constexpr int kMantissaBits = 53;
// stop_test.sv, the head.
constexpr int kRhsClocks = 18;
constexpr int kResidualClocks = 9;

void set(VlWide<3>& port, UInt128 value) {
  for (int i = 0; i < 3; ++i) port[i] = static_cast<std::uint32_t>(value >> (32 * i));
}

class Module {
 public:
  // As the engine asks: ‖b‖² first, and ‖r‖² when that is taken over or while it is.
  bool reached(const StopCase& c, int clocks_between) {
    int exponent = 0;
    const double mantissa = std::frexp(c.t * c.t, &exponent);
    module_->tolerance = static_cast<std::uint64_t>(std::ldexp(mantissa, kMantissaBits));
    module_->tolerance_exponent =
        static_cast<std::uint16_t>(static_cast<unsigned>(exponent - kMantissaBits) & 0xfffU);
    module_->static_shift = static_cast<std::uint8_t>(c.shift);
    set(module_->rhs_squares, c.rhs);
    module_->take_rhs = 1;
    module_.tick();
    module_->take_rhs = 0;
    for (int i = 0; i < clocks_between; ++i) module_.tick();
    set(module_->squares, c.residual);
    module_->r_exponent = static_cast<std::uint32_t>(c.exponent) & ((1U << 22U) - 1);
    module_->take_residual = 1;
    module_.tick();
    module_->take_residual = 0;
    // An engine without nodes asks at once.
    EXPECT_EQ(module_->reached != 0, c.residual == 0);
    for (int i = 0; i < kRhsClocks + kResidualClocks - clocks_between; ++i) module_.tick();
    return module_->reached != 0;
  }

 private:
  test::ClockedModule<Vstop_test> module_;
};

void expect_same(Module& module, const StopCase& c, int clocks_between) {
  ASSERT_EQ(module.reached(c, clocks_between),
            fixed::StopTest(c.t, c.rhs, c.shift).reached(c.residual, c.exponent))
      << "t " << c.t << ", b " << static_cast<double>(c.rhs) << " shifted by " << c.shift
      << ", residual " << static_cast<double>(c.residual) << ", exponent " << c.exponent << ", "
      << clocks_between << " clocks between";
}

TEST(RtlStopTest, AgreesAtTheLimit) {
  Module module;
  fixed::test::Random random(31);
  int compared = 0;
  int aimed = 0;
  for (int i = 0; i < 40'000; ++i) {
    const StopCase c = hvp::test::random_stop_case(random);
    if (c.residual >> kSquareBits != 0) continue;
    ++compared;
    aimed += c.aimed ? 1 : 0;
    expect_same(module, c, i % kRhsClocks);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(compared, 30'000);
  EXPECT_GT(aimed, compared / 3);
}

// ‖b‖² and ‖r‖² round up to a power of two, or not quite.
TEST(RtlStopTest, AgreesWhereAMantissaCarries) {
  constexpr UInt128 kOne = 1;
  Module module;
  for (int bits = kMantissaBits + 1; bits < kSquareBits; ++bits) {
    const UInt128 power = kOne << bits;
    const UInt128 half = kOne << (bits - kMantissaBits - 1);  // of the last place below it
    for (const UInt128 b : {power - half - 1, power - half, power - 1, power, power + half}) {
      for (const UInt128 r : {power - half - 1, power - half, power - 1, power, power + half,
                              power + 2 * half, power + 3 * half}) {
        for (const double t : {1.0, 1.0 - 0x1p-53, 0.5 + 0x1p-53}) {
          for (const int exponent : {0, 1}) {
            expect_same(module, {.t = t, .rhs = b, .residual = r, .exponent = exponent}, 0);
            if (HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

// (1 - x·2^-53)² is 1 - 2x·2^-53 in 53 bits, and that times 2^52 + x is 2x²·2^-53 below 2^52, which
// it rounds to.
TEST(RtlStopTest, AgreesWhereAProductCarries) {
  Module module;
  fixed::test::Random random(33);
  for (int i = 0; i < 2'000; ++i) {
    const int x = 1 + random.below(1 << 25);
    for (int beside = -3; beside <= 3; ++beside) {
      expect_same(module,
                  {.t = 1 - std::ldexp(x, -kMantissaBits),
                   .rhs = (UInt128{1} << 52U) + static_cast<UInt128>(x),
                   .residual = (UInt128{1} << 52U) + static_cast<UInt128>(beside)},
                  0);
      if (HasFatalFailure()) return;
    }
  }
}

// What a product has below the half decides in a tie alone: mantissas whose product is one.
TEST(RtlStopTest, AgreesWhereAProductIsATie) {
  Module module;
  fixed::test::Random random(32);
  int ties = 0;
  for (int i = 0; i < 200'000; ++i) {
    // Short mantissas, of 54 bits together: the last bit of their product is the half.
    const std::uint64_t of_t = (std::uint64_t{1} << 13U) | (random.bits() >> 51U) | 1U;
    const std::uint64_t square = of_t * of_t;  // 27 or 28 bits
    const std::uint64_t rhs = (std::uint64_t{1} << 26U) | (random.bits() >> 38U) | 1U;
    const UInt128 product = static_cast<UInt128>(square) * rhs;
    if (product >> kMantissaBits != 1) continue;
    ++ties;
    for (int beside = -3; beside <= 3; ++beside) {
      expect_same(module,
                  {.t = std::ldexp(static_cast<double>(of_t), -14),
                   .rhs = rhs,
                   .residual = product + static_cast<UInt128>(beside),
                   .exponent = 14},
                  0);
      if (HasFatalFailure()) return;
    }
    if (ties == 5'000) break;
  }
  EXPECT_EQ(ties, 5'000);
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_stop_test_test
