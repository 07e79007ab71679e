#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test {
namespace {

using Log = std::vector<std::string>;

TEST_F(DriverOnBoard, OpenLooksBeforeItTouches) {
  open();
  EXPECT_EQ(board.take_log(),
            (Log{"read ID", "read VERSION", "read CAPABILITY_NODES", "read CAPABILITY_BLOCKS",
                 "read CAPABILITY_FORMAT", "read CAPABILITY_CLOCK", "write CONTROL 0x80000000",
                 "read STATUS", "write INTERRUPT_ENABLE 0x3"}));
  const hvp_capability* capability = hvp_capability_of(&device);
  EXPECT_EQ(capability->max_nodes, 64U);
  EXPECT_EQ(capability->max_row_blocks, 64U);
  EXPECT_EQ(capability->max_blocks, 1024U);
  EXPECT_EQ(capability->max_matrix_bits, 32U);
  EXPECT_EQ(capability->clock_khz, 100'000U);
}

TEST_F(DriverOnBoard, OpenRefusesWhatIsNotABoard) {
  const hvp_bus bus = board.bus();
  board.dead = true;
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_NO_DEVICE);
  EXPECT_EQ(board.take_log(), Log{"read ID"});  // and wrote nothing to a stranger
  EXPECT_EQ(hvp_reset(&device), HVP_ERROR_STATE);
  board.dead = false;

  board.bank().strap(vp::Register::version, 2U << 16);
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_VERSION);
  board.bank().strap(vp::Register::version, 1U << 16 | 7U);
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
  config.jacobi = true;
  config.warm_start = false;
  config.iterations = 30;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(board.take_log(), Log{"write METHOD x6"});
  const auto& bank = board.bank();
  EXPECT_EQ(bank.get(vp::Register::method), 1U);
  EXPECT_EQ(bank.get(vp::Register::iterations), 30U);
  EXPECT_EQ(bank.get(vp::Register::static_shift), 11U);
  EXPECT_EQ(bank.get(vp::Register::scaling), 0x301U);
  EXPECT_EQ(bank.get(vp::Register::format), 0x1020100cU);  // b in 32 bits under Jacobi
  EXPECT_EQ(bank.get(vp::Register::start_mode), 0U);
}

TEST_F(DriverOnBoard, ConfigureRefusesWhatTheBoardCannotDo) {
  board.bank().strap(vp::Register::capability_format, 16U << 24 | 16U << 16 | 16U << 8 | 12U);
  open();
  board.take_log();
  const auto configure = [this](auto change) {
    hvp_solver_config config = thesis_config();
    change(config);
    return hvp_configure(&device, &config);
  };
  EXPECT_EQ(configure([](auto& c) { c.matrix_bits = 13; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(configure([](auto& c) { c.vector_bits = 17; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(configure([](auto& c) { c.jacobi = true; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(configure([](auto& c) { c.coefficient_bits = 64; }), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(configure([](auto& c) { c.matrix_bits = 1; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(configure([](auto& c) { c.iterations = 0; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(configure([](auto& c) { c.iterations = 65536; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(configure([](auto& c) { c.static_shift = 64; }), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(configure([](auto& c) { c.headroom_bits = 16; }), HVP_ERROR_ARGUMENT);
  EXPECT_TRUE(board.take_log().empty());
  EXPECT_EQ(configure([](auto&) {}), HVP_OK);
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
}

}  // namespace
}  // namespace hvp::test
