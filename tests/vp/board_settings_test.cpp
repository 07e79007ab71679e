// The solver's settings through the driver and the board's registers and out again. The register
// bank is the real one, the bus between is a function call.
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/stop_test.h"
#include "vp/fpga/board_registers.h"
#include "vp/host/driver_config.h"

namespace hvp::vp::board_settings_test {
namespace {

using fixed::Method;

struct Board {
  RegisterBank bank{{.nodes = 8, .row_blocks = 8, .blocks = 64}};

  hvp_bus bus() {
    hvp_bus bus{};
    bus.context = &bank;
    bus.read32 = [](void* context, std::uint32_t offset) {
      std::uint32_t word = 0;
      EXPECT_TRUE(of(context).read(offset, bytes(&word, 1)).ok());
      return word;
    };
    bus.write32 = [](void* context, std::uint32_t offset, std::uint32_t word) {
      EXPECT_TRUE(of(context).write(offset, bytes(&word, 1)).ok());
    };
    bus.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                        std::size_t count) {
      EXPECT_TRUE(of(context).read(offset, bytes(words, count)).ok());
    };
    bus.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                         std::size_t count) {
      std::vector<std::uint32_t> copy(words, words + count);
      EXPECT_TRUE(of(context).write(offset, bytes(copy.data(), count)).ok());
    };
    bus.now_ns = [](void*) { return std::uint64_t{0}; };
    return bus;
  }

 private:
  static RegisterBank& of(void* context) { return *static_cast<RegisterBank*>(context); }
  static std::span<std::uint8_t> bytes(std::uint32_t* words, std::size_t count) {
    return {reinterpret_cast<std::uint8_t*>(words), 4 * count};
  }
};

// Configures a fresh board through the driver and reads what it makes of that.
fixed::Settings travelled(const fixed::Settings& settings, hvp_status expected = HVP_OK) {
  Board board;
  const hvp_bus bus = board.bus();
  std::array<std::uint32_t, HVP_MIN_SCRATCH_WORDS> scratch{};
  hvp_device device{};
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  const hvp_solver_config config = driver_config(settings);
  EXPECT_EQ(hvp_configure(&device, &config), expected);
  fixed::Settings arrived;
  EXPECT_EQ(read_settings(board.bank, arrived).code, ErrorCode::none);
  return arrived;
}

// The board knows no default of the static shift, only the one in force.
fixed::Settings on_board(fixed::Settings settings) {
  settings.static_shift = settings.shift();
  return settings;
}

// One setting after the other away from its default, and to the ends of its range.
TEST(BoardSettings, EachOneArrives) {
  const std::vector<std::function<void(fixed::Settings&)>> changes = {
      [](auto&) {},
      [](auto& s) { s.method = Method::jacobi_pcg; },
      [](auto& s) { s.method = Method::block_jacobi_pcg; },
      [](auto& s) { s.method = Method::chronopoulos_gear; },
      [](auto& s) { s.method = Method::pipelined_cg; },
      [](auto& s) { s.start = fixed::Start::zero; },
      [](auto& s) { s.start = fixed::Start::extrapolated; },
      [](auto& s) { s.iterations = 1; },
      [](auto& s) { s.iterations = 65535; },
      [](auto& s) { s.stop_residual = 1; },
      [](auto& s) { s.stop_residual = 0.1; },  // 52 bits behind the point
      [](auto& s) { s.stop_residual = fixed::StopTest::kLeast; },
      [](auto& s) { s.replace_residual_every = 1; },
      [](auto& s) { s.replace_residual_every = 65535; },
      [](auto& s) { s.matrix_bits = 8; },
      [](auto& s) { s.matrix_bits = 24; },
      [](auto& s) { s.vector_bits = 12; },
      [](auto& s) { s.vector_bits = 32; },
      [](auto& s) { s.scalar_bits = 128; },
      [](auto& s) { s.coefficient_bits = 8; },
      [](auto& s) { s.coefficient_bits = 24; },
      [](auto& s) { s.coefficient_format = fixed::CoefficientFormat::fixed; },
      [](auto& s) { s.alpha_fraction_bits = 0; },
      [](auto& s) { s.alpha_fraction_bits = 40; },
      [](auto& s) { s.beta_fraction_bits = 0; },
      [](auto& s) { s.beta_fraction_bits = 40; },
      [](auto& s) { s.division_rounding = fixed::Rounding::nearest_even; },
      [](auto& s) { s.division_rounding = fixed::Rounding::truncation; },
      [](auto& s) { s.shift_rounding = fixed::Rounding::nearest_even; },
      [](auto& s) { s.shift_rounding = fixed::Rounding::truncation; },
      [](auto& s) { s.overflow = fixed::Overflow::wrap; },
      [](auto& s) { s.static_shift = 0; },
      [](auto& s) { s.static_shift = 31; },
      [](auto& s) { s.dynamic_scaling = false; },
      [](auto& s) { s.scaling_down = false; },
      [](auto& s) { s.scaling_threshold = 16; },
      [](auto& s) { s.scaling_step = 16; },
      [](auto& s) { s.headroom_bits = 0; },
      [](auto& s) { s.headroom_bits = 8; },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    fixed::Settings settings;
    changes[i](settings);
    EXPECT_EQ(travelled(settings), on_board(settings)) << "change " << i;
  }
}

TEST(BoardSettings, WhatIsTheHostsStaysThere) {
  fixed::Settings settings;
  settings.displacement_range = 0.5;
  settings.matrix_scaling = fixed::MatrixScaling::diagonal;
  settings.static_scale = fixed::StaticScale::matrix_norm;
  EXPECT_EQ(travelled(settings), on_board({}));
}

TEST(BoardSettings, ANegativeZeroIsNoTest) {
  fixed::Settings settings;
  settings.stop_residual = -0.0;
  EXPECT_EQ(driver_config(settings).stop_residual, 0U);
  EXPECT_EQ(travelled(settings), on_board({}));
}

TEST(BoardSettings, AfterPowerUpAreTheDefaults) {
  fixed::Settings settings;
  EXPECT_EQ(read_settings(RegisterBank{}, settings).code, ErrorCode::none);
  EXPECT_EQ(settings, on_board({}));
}

// The values just outside, and each other code that a field can hold.
TEST(BoardSettings, EveryRegisterIsToBlameForItself) {
  struct Bad {
    Field field;
    std::uint32_t value;
    Register blamed;
  };
  std::vector<Bad> bad = {
      {field::kIterationsCount, 0, Register::iterations},
      {field::kStopResidualHighHigh, 0x80000000, Register::stop_residual_high},
      {field::kStopResidualHighHigh, 0x3ff00001, Register::stop_residual_high},
      {field::kStopResidualHighHigh, 0x7ff80000, Register::stop_residual_high},
      {field::kStaticShiftShift, 32, Register::static_shift},
      {field::kScalingHeadroomBits, 9, Register::scaling},
      {field::kScalingThreshold, 0, Register::scaling},
      {field::kScalingThreshold, 17, Register::scaling},
      {field::kScalingStep, 0, Register::scaling},
      {field::kScalingStep, 17, Register::scaling},
      {field::kFormatMatrixBits, 7, Register::format},
      {field::kFormatMatrixBits, 25, Register::format},
      {field::kFormatVectorBits, 11, Register::format},
      {field::kFormatVectorBits, 33, Register::format},
      {field::kFormatVectorBits, 17, Register::format},  // b has 16
      {field::kFormatRhsBits, 32, Register::format},     // without a preconditioner
      {field::kFormatCoefficientBits, 7, Register::format},
      {field::kFormatCoefficientBits, 25, Register::format},
      {field::kCoefficientsAlphaFraction, 41, Register::coefficients},
      {field::kCoefficientsBetaFraction, 41, Register::coefficients},
      {field::kArithmeticDivisionRounding, 3, Register::arithmetic},
      {field::kArithmeticShiftRounding, 3, Register::arithmetic},
      {field::kArithmeticScalarBits, 0, Register::arithmetic},
      {field::kArithmeticScalarBits, 65, Register::arithmetic},
      {field::kStartModeMode, 3, Register::start_mode},
  };
  for (std::uint32_t method = 5; method < 8; ++method) {
    bad.push_back({field::kMethodMethod, method, Register::method});
  }
  for (const Bad& b : bad) {
    RegisterBank bank;
    bank.set(b.field, b.value);
    fixed::Settings settings;
    const BoardError error = read_settings(bank, settings);
    EXPECT_EQ(error.code, ErrorCode::bad_setting);
    EXPECT_EQ(error.detail, kRegisters[static_cast<std::size_t>(b.blamed)].offset)
        << kRegisters[static_cast<std::size_t>(b.field.reg)].name << " " << b.value;
  }
  // One and the next double after it.
  RegisterBank bank;
  fixed::Settings settings;
  bank.set(Register::stop_residual_high, 0x3ff00000);
  EXPECT_EQ(read_settings(bank, settings).code, ErrorCode::none);
  bank.set(Register::stop_residual_low, 1);
  EXPECT_EQ(read_settings(bank, settings).detail, 0x4cU);
  // Eight free bits of a word of twelve leave three.
  bank.reset();
  bank.set(Register::format, 0x100c0c0c);
  bank.set(field::kScalingHeadroomBits, 8);
  EXPECT_EQ(read_settings(bank, settings).detail, 0x58U);
}

}  // namespace
}  // namespace hvp::vp::board_settings_test
