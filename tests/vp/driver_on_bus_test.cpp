#include <string_view>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_rig.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/fpga/accelerator.h"
#include "vp/host/board_access.h"
#include "vp/host/driver_port.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp::driver_on_bus_test {
namespace {

using test::kNs;
using test::kUs;
using test::pci_read;
using test::pci_write;
using test::SmallScene;

constexpr Picoseconds kInterruptLatency = 5 * kUs;
constexpr std::size_t kScratchWords = 100;
constexpr std::size_t kUnknowns = SmallScene::kUnknowns;
constexpr int kVectorBytes = 2 * SmallScene::kUnknowns;  // 16-bit words: one burst from the scratch

// The driver's program on a host, a bus and a board.
class DriverOnBus : public test::BoardRig, public testing::Test {
 protected:
  void run(const std::function<void(test::Program&)>& script) {
    run_driver(kInterruptLatency, script);
  }

  void open_and_load() {
    ASSERT_EQ(hvp_open(&device_, &port_->bus(), scratch_.data(), scratch_.size()), HVP_OK);
    load();
  }
  void load() {
    hvp_solver_config config{};
    config.start = HVP_START_FROM_LAST;
    config.dynamic_scaling = true;
    config.headroom_bits = 3;
    config.iterations = 60;
    config.static_shift = 11;
    config.matrix_bits = 12;
    config.vector_bits = 16;
    config.coefficient_bits = 16;
    ASSERT_EQ(hvp_configure(&device_, &config), HVP_OK);
    load_matrix(k());
  }
  std::vector<std::int32_t> expected_solution() const {
    fixed::Settings settings;
    settings.headroom_bits = 3;
    return solution(b_, settings);
  }

  std::vector<std::uint32_t> scratch_ = std::vector<std::uint32_t>(kScratchWords);
  std::vector<std::int32_t> b_ = test::words(SmallScene::kUnknowns, 200);
  std::vector<std::int32_t> u_ = std::vector<std::int32_t>(kUnknowns);
};

// Bursts of the scratch area's size, the last one shorter.
Picoseconds elements(std::size_t n, unsigned bits) {
  Picoseconds time = 0;
  for (std::size_t words = packed_words(n, bits); words > 0;) {
    const std::size_t burst = std::min(words, kScratchWords);
    time += pci_write(static_cast<int>(4 * burst));
    words -= burst;
  }
  return time;
}

TEST_F(DriverOnBus, EveryCallTakesItsAccesses) {
  run([&](test::Program&) {
    ASSERT_EQ(hvp_open(&device_, &port_->bus(), scratch_.data(), scratch_.size()), HVP_OK);
    // ID, VERSION, five of CAPABILITY and STATUS; CONTROL.reset and INTERRUPT_ENABLE.
    Picoseconds expected = 8 * pci_read(4) + 2 * pci_write(4);
    EXPECT_EQ(now_ps(), expected);
    load();
    expected += pci_write(44);  // METHOD to START_MODE
    expected += elements(2, 32) + elements(49, 32) + elements(k().column.size(), 32) +
                elements(k().value.size(), 12);
    expected += pci_write(4) + 10 * kNs;  // load_done, and the clock that it takes
    expected += kInterruptLatency + pci_read(4) + pci_write(4);
    EXPECT_EQ(now_ps(), expected);

    ASSERT_EQ(hvp_solve(&device_, b_.data(), u_.data(), kUnknowns, 1'000'000), HVP_OK);
    expected += pci_write(kVectorBytes) + pci_write(4) + solve_time() + kInterruptLatency +
                pci_read(4) + pci_write(4) + pci_read(kVectorBytes);
    EXPECT_EQ(now_ps(), expected);
    EXPECT_EQ(u_, expected_solution());

    hvp_result result{};
    ASSERT_EQ(hvp_read_result(&device_, &result), HVP_OK);
    expected += pci_read(40);
    EXPECT_EQ(result.job, 1U);
    EXPECT_EQ(static_cast<Picoseconds>(result.cycles) * test::kBoardClock, solve_time());
    EXPECT_EQ(hvp_close(&device_), HVP_OK);
    expected += pci_write(4);
    EXPECT_EQ(now_ps(), expected);
  });
}

TEST_F(DriverOnBus, TimeOutComesAfterItsTimeAndOneLookAtStatus) {
  run([&](test::Program&) {
    open_and_load();
    ASSERT_EQ(hvp_write_rhs(&device_, b_.data(), kUnknowns), HVP_OK);
    ASSERT_EQ(hvp_start(&device_), HVP_OK);
    const Picoseconds started = now_ps();
    ASSERT_GT(solve_time(), 100 * kUs);
    EXPECT_EQ(hvp_wait(&device_, 100'000), HVP_ERROR_TIMEOUT);
    EXPECT_EQ(now_ps(), started + 100 * kUs + pci_read(4));

    // The job goes on: a second wait finds it.
    EXPECT_EQ(hvp_wait(&device_, 1'000'000), HVP_OK);
    EXPECT_EQ(now_ps(), started + solve_time() + kInterruptLatency + pci_read(4) + pci_write(4));
    ASSERT_EQ(hvp_read_solution(&device_, u_.data(), kUnknowns), HVP_OK);
    EXPECT_EQ(u_, expected_solution());
  });
}

TEST_F(DriverOnBus, ResetAndReloadRecoverFromATimeOut) {
  run([&](test::Program&) {
    open_and_load();
    EXPECT_EQ(hvp_solve(&device_, b_.data(), u_.data(), kUnknowns, 20'000), HVP_ERROR_TIMEOUT);
    EXPECT_EQ(hvp_write_rhs(&device_, b_.data(), kUnknowns), HVP_ERROR_STATE);
    const Picoseconds lost = now_ps();
    ASSERT_EQ(hvp_reset(&device_), HVP_OK);
    EXPECT_EQ(now_ps(), lost + 2 * pci_write(4) + pci_read(4));
    load();
    const Picoseconds loaded = now_ps();
    ASSERT_EQ(hvp_solve(&device_, b_.data(), u_.data(), kUnknowns, 1'000'000), HVP_OK);
    EXPECT_EQ(now_ps(), loaded + pci_write(kVectorBytes) + pci_write(4) + solve_time() +
                            kInterruptLatency + pci_read(4) + pci_write(4) +
                            pci_read(kVectorBytes));
    EXPECT_EQ(u_, expected_solution());
  });
}

// Which of two processes the kernel runs first at one instant must not show.
TEST_F(DriverOnBus, JobThatEndsAtTheTimeOutHasEnded) {
  run([&](test::Program&) {
    open_and_load();
    ASSERT_EQ(hvp_write_rhs(&device_, b_.data(), kUnknowns), HVP_OK);
    ASSERT_EQ(hvp_start(&device_), HVP_OK);
    const Picoseconds started = now_ps();
    EXPECT_EQ(hvp_wait(&device_, static_cast<std::uint64_t>(solve_time() / kNs)), HVP_OK);
    EXPECT_EQ(now_ps(), started + solve_time() + kInterruptLatency + pci_read(4) + pci_write(4));
  });
}

TEST_F(DriverOnBus, InterruptThatCameBeforeTheWaitIsNotLost) {
  run([&](test::Program& p) {
    open_and_load();
    access_->tag() = Tag{3, kBirth};
    ledger_.open(3, now_ps());
    ASSERT_EQ(hvp_write_rhs(&device_, b_.data(), kUnknowns), HVP_OK);
    ASSERT_EQ(hvp_start(&device_), HVP_OK);
    p.sleep(1'000 * kUs);
    const Picoseconds late = now_ps();
    EXPECT_EQ(hvp_wait(&device_, 1'000'000), HVP_OK);
    EXPECT_EQ(now_ps(), late + kInterruptLatency + pci_read(4) + pci_write(4));

    // The host came later than the board, so that the path goes through the host.
    const std::vector<Span>& spans = ledger_.frame(3).spans;
    const auto interrupt = std::find_if(spans.begin(), spans.end(),
                                        [](const Span& s) { return s.phase == Phase::interrupt; });
    ASSERT_NE(interrupt, spans.end());
    EXPECT_EQ(interrupt->start, late);
    EXPECT_EQ(spans[static_cast<std::size_t>(interrupt->cause)].phase, Phase::bus_write);
  });
}

TEST_F(DriverOnBus, EndlessTimeOutDoesNotWrap) {
  run([&](test::Program&) {
    open_and_load();
    EXPECT_EQ(hvp_solve(&device_, b_.data(), u_.data(), kUnknowns, UINT64_MAX), HVP_OK);
    EXPECT_EQ(u_, expected_solution());
  });
}

TEST_F(DriverOnBus, RowsComeBackThroughTheDriver) {
  run([&](test::Program&) {
    open_and_load();
    const std::vector<std::int32_t> loaded = k().value;
    const auto value = [&] {
      std::vector<std::uint32_t> words(packed_words(loaded.size(), 12));
      EXPECT_TRUE(access_->read(kSolverBase + test::offset_of(Aperture::value), words.data(),
                                4 * words.size()));
      std::vector<std::int32_t> result;
      for (std::size_t i = 0; i < loaded.size(); ++i) {
        result.push_back(packed_element(words, i, 12));
      }
      return result;
    };
    EXPECT_EQ(value(), loaded);
    ASSERT_EQ(hvp_constrain_node(&device_, 30, 900), HVP_OK);
    ASSERT_EQ(hvp_constrain_node(&device_, 31, 900), HVP_OK);
    EXPECT_NE(value(), loaded);
    // The block towards 31 has to be zero while that is constrained.
    std::vector<std::int32_t> row(k().row(30).begin(), k().row(30).end());
    const auto towards = static_cast<std::size_t>(k().find(30, 31) - k().row_begin[30]);
    std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(9 * towards), 9, 0);
    ASSERT_EQ(
        hvp_restore_node(&device_, 30, row.data(), static_cast<std::uint32_t>(row.size() / 9)),
        HVP_OK);
    row.assign(k().row(31).begin(), k().row(31).end());
    ASSERT_EQ(
        hvp_restore_node(&device_, 31, row.data(), static_cast<std::uint32_t>(row.size() / 9)),
        HVP_OK);
    EXPECT_EQ(value(), loaded);
  });
}

TEST_F(DriverOnBus, NobodyAnswersAtAnEmptyAddress) {
  run([&](test::Program&) {
    std::uint32_t word = 0;
    EXPECT_FALSE(access_->read(0x3000'0000, &word, 4));
    EXPECT_EQ(word, 0xffffffffU);
    EXPECT_FALSE(access_->write(0x3000'0000, &word, 4));
    EXPECT_EQ(now_ps(), pci_read(4) + pci_write(4));
  });
}

}  // namespace
}  // namespace hvp::vp::driver_on_bus_test
