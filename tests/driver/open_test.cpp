#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test::open_test {
namespace {

using Log = std::vector<std::string>;

TEST_F(DriverOnBoard, OpenLooksBeforeItTouches) {
  open();
  EXPECT_EQ(board.take_log(),
            (Log{"read ID", "read VERSION", "read CAPABILITY_NODES", "read CAPABILITY_BLOCKS",
                 "read CAPABILITY_FORMAT", "read CAPABILITY_CLOCK", "read CAPABILITY_SOLVER",
                 "write CONTROL 0x80000000", "read STATUS", "write INTERRUPT_ENABLE 0x3"}));
  const hvp_capability* capability = hvp_capability_of(&device);
  EXPECT_EQ(capability->max_nodes, 64U);
  EXPECT_EQ(capability->max_row_blocks, 256U);
  EXPECT_EQ(capability->max_blocks, 1024U);
  EXPECT_EQ(capability->max_matrix_bits, 24U);
  EXPECT_EQ(capability->clock_khz, 100'000U);
  EXPECT_EQ(capability->methods, 0x1fU);
  EXPECT_EQ(capability->start_modes, 7U);
  EXPECT_EQ(capability->max_scalar_bits, 128U);
}

TEST_F(DriverOnBoard, OpenRefusesWhatIsNotABoard) {
  const hvp_bus bus = board.bus();
  board.dead = true;
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_NO_DEVICE);
  EXPECT_EQ(board.take_log(), Log{"read ID"});  // and wrote nothing to a stranger
  EXPECT_EQ(hvp_reset(&device), HVP_ERROR_STATE);
  board.dead = false;

  for (const std::uint32_t major : {1U, 3U}) {
    board.bank().strap(vp::Register::version, major << 16);
    EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_VERSION);
  }
  board.bank().strap(vp::Register::version, 2U << 16 | 7U);
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);

  // A board that can do nothing, or less than any.
  for (const std::uint32_t solver : {0x80000700U, 0x8000001fU, 0x3f00071fU}) {
    board.bank().strap(vp::Register::capability_solver, solver);
    EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_CAPABILITY);
  }
  board.bank().strap(vp::Register::capability_solver, 0x40000101);
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  board.bank().strap(vp::Register::capability_blocks, 0);
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_CAPABILITY);
}

TEST_F(DriverOnBoard, OpenRefusesHalfABus) {
  hvp_bus bus = board.bus();
  EXPECT_EQ(hvp_open(nullptr, &bus, scratch.data(), scratch.size()), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_open(&device, nullptr, scratch.data(), scratch.size()), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_open(&device, &bus, nullptr, scratch.size()), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), HVP_MIN_SCRATCH_WORDS - 1), HVP_ERROR_ARGUMENT);
  bus.now_ns = nullptr;
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_ARGUMENT);
  EXPECT_TRUE(board.take_log().empty());
}

TEST_F(DriverOnBoard, ConfigureIsOneBurst) {
  open();
  board.take_log();
  hvp_solver_config config = thesis_config();
  config.method = HVP_METHOD_JACOBI_PCG;
  config.start = HVP_START_FROM_EXTRAPOLATED;
  config.iterations = 30;
  config.stop_residual = 0x3f50624dd2f1a9fc;  // 1e-3
  config.replace_every = 20;
  config.scaling_up_only = true;
  config.scaling_threshold = 2;
  config.scaling_step = 4;
  config.scalar_bits = 128;
  config.fixed_coefficients = true;
  config.alpha_fraction = 40;
  config.beta_fraction = 12;
  config.division_rounding = HVP_ROUND_TRUNCATION;
  config.shift_rounding = HVP_ROUND_NEAREST_EVEN;
  config.wrap_overflow = true;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(board.take_log(), Log{"write METHOD x11"});
  const auto& bank = board.bank();
  EXPECT_EQ(bank.get(vp::Register::method), 1U);
  EXPECT_EQ(bank.get(vp::Register::iterations), 30U);
  EXPECT_EQ(bank.get(vp::Register::stop_residual_low), 0xd2f1a9fcU);
  EXPECT_EQ(bank.get(vp::Register::stop_residual_high), 0x3f50624dU);
  EXPECT_EQ(bank.get(vp::Register::replace_every), 20U);
  EXPECT_EQ(bank.get(vp::Register::static_shift), 11U);
  EXPECT_EQ(bank.get(vp::Register::scaling), 0x04020301U);
  EXPECT_EQ(bank.get(vp::Register::format), 0x1020100cU);  // b in 32 bits under Jacobi
  EXPECT_EQ(bank.get(vp::Register::coefficients), 0x000c2801U);
  EXPECT_EQ(bank.get(vp::Register::arithmetic), 0x80000112U);
  EXPECT_EQ(bank.get(vp::Register::start_mode), 2U);
}

// What a caller leaves out of an initialiser is what the thesis' board does.
TEST_F(DriverOnBoard, WhatIsLeftOutIsThePlainBoard) {
  open();
  hvp_solver_config config{};
  config.iterations = 60;
  config.matrix_bits = 12;
  config.vector_bits = 16;
  config.coefficient_bits = 16;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  const auto& bank = board.bank();
  EXPECT_EQ(bank.get(vp::Register::method), 0U);
  EXPECT_EQ(bank.get(vp::Register::stop_residual_low), 0U);
  EXPECT_EQ(bank.get(vp::Register::stop_residual_high), 0U);
  EXPECT_EQ(bank.get(vp::Register::replace_every), 0U);
  EXPECT_EQ(bank.get(vp::Register::scaling), 0x01010002U);  // static; down if ever, step by step
  EXPECT_EQ(bank.get(vp::Register::format), 0x1010100cU);
  EXPECT_EQ(bank.get(vp::field::kCoefficientsFormat), 0U);
  EXPECT_EQ(bank.get(vp::Register::arithmetic), 0x40000000U);  // nearest, clamped, 64 bits
  EXPECT_EQ(bank.get(vp::Register::start_mode), 0U);

  config.method = HVP_METHOD_BLOCK_JACOBI_PCG;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(bank.get(vp::field::kFormatRhsBits), 32U);
  config.method = HVP_METHOD_PIPELINED_CG;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(bank.get(vp::field::kFormatRhsBits), 16U);
}

class Configure : public DriverOnBoard {
 protected:
  template <class Change>
  hvp_status with(Change change) {
    hvp_solver_config config = thesis_config();
    change(config);
    return hvp_configure(&device, &config);
  }
};

TEST_F(Configure, RefusesWhatTheBoardCannotDo) {
  board.bank().strap(vp::Register::capability_format, 16U << 24 | 16U << 16 | 16U << 8 | 12U);
  // Neither block-Jacobi nor pipelined; no extrapolation; 64-bit scalars.
  board.bank().strap(vp::Register::capability_solver, 64U << 24 | 3U << 8 | 0x0bU);
  open();
  board.take_log();
  EXPECT_EQ(with([](auto& c) { c.matrix_bits = 13; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.vector_bits = 17; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.method = HVP_METHOD_JACOBI_PCG; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.coefficient_bits = 64; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.method = HVP_METHOD_PIPELINED_CG; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) {
              c.method = HVP_METHOD_BLOCK_JACOBI_PCG;
              c.rhs_bits = 16;
            }),
            HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.start = HVP_START_FROM_EXTRAPOLATED; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(with([](auto& c) { c.scalar_bits = 128; }), HVP_ERROR_CAPABILITY);
  EXPECT_TRUE(board.take_log().empty());
  EXPECT_EQ(with([](auto&) {}), HVP_OK);
  EXPECT_EQ(with([](auto& c) { c.method = HVP_METHOD_CHRONOPOULOS_GEAR; }), HVP_OK);
}

TEST_F(Configure, RefusesWhatNoBoardHas) {
  open();
  board.take_log();
  EXPECT_EQ(with([](auto& c) { c.matrix_bits = 1; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.iterations = 0; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.iterations = 65536; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.replace_every = 65536; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.static_shift = 64; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.headroom_bits = 16; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.scaling_threshold = 32; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.scaling_step = 32; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.scalar_bits = 96; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.alpha_fraction = 64; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.beta_fraction = 64; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.method = HVP_METHOD_COUNT; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.start = HVP_START_FROM_COUNT; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.division_rounding = HVP_ROUND_COUNT; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(with([](auto& c) { c.shift_rounding = HVP_ROUND_COUNT; }), HVP_ERROR_ARGUMENT);
  // The next double after one, the last one before 2^-511, the first one above zero, -0, a NaN.
  for (const std::uint64_t bits : {0x3ff0000000000001U, 0x1fffffffffffffffU, UINT64_C(1),
                                   0x8000000000000000U, 0x7ff8000000000000U}) {
    EXPECT_EQ(with([bits](auto& c) { c.stop_residual = bits; }), HVP_ERROR_ARGUMENT);
  }
  EXPECT_TRUE(board.take_log().empty());
  for (const std::uint64_t bits : {0x3ff0000000000000U, 0x2000000000000000U}) {
    EXPECT_EQ(with([bits](auto& c) { c.stop_residual = bits; }), HVP_OK);
  }
}

TEST_F(DriverOnBoard, NothingWorksOutOfOrder) {
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  hvp_result result{};
  const auto all_refused = [&] {
    return hvp_load_matrix(&device, &view) == HVP_ERROR_STATE &&
           hvp_constrain_node(&device, 0, 1) == HVP_ERROR_STATE &&
           hvp_restore_node(&device, 0, matrix.value.data(), 2) == HVP_ERROR_STATE &&
           hvp_write_rhs(&device, b.data(), b.size()) == HVP_ERROR_STATE &&
           hvp_write_initial_guess(&device, b.data(), b.size()) == HVP_ERROR_STATE &&
           hvp_start(&device) == HVP_ERROR_STATE && hvp_wait(&device, 1) == HVP_ERROR_STATE &&
           hvp_read_solution(&device, u.data(), u.size()) == HVP_ERROR_STATE &&
           hvp_read_result(&device, &result) == HVP_ERROR_STATE;
  };
  EXPECT_TRUE(all_refused());
  EXPECT_EQ(hvp_configure(&device, &config), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_close(&device), HVP_ERROR_STATE);
  open();
  board.take_log();
  EXPECT_TRUE(all_refused());
  EXPECT_TRUE(board.take_log().empty());
  ASSERT_EQ(hvp_close(&device), HVP_OK);
  EXPECT_EQ(board.take_log(), Log{"write INTERRUPT_ENABLE 0x0"});
  EXPECT_EQ(hvp_close(&device), HVP_ERROR_STATE);
}

TEST(StatusText, EveryStatusHasItsOwn) {
  std::set<std::string> texts;
  for (int i = 0; i <= HVP_STATUS_COUNT; ++i) {
    texts.insert(hvp_status_text(static_cast<hvp_status>(i)));
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(HVP_STATUS_COUNT) + 1);
  std::set<std::string> names;
  for (int i = 0; i <= HVP_STATUS_COUNT; ++i) {
    names.insert(hvp_status_name(static_cast<hvp_status>(i)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(HVP_STATUS_COUNT) + 1);
  EXPECT_STREQ(hvp_status_name(HVP_ERROR_BOARD), "HVP_ERROR_BOARD");
}

}  // namespace
}  // namespace hvp::test::open_test
