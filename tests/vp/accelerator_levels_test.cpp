// The board with an engine behind its registers: the same words and registers at every level, and
// the time of the engine's clocks.
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_master.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/fpga/accelerator.h"

namespace hvp::vp {
namespace {

using fixed::Method;
using test::BoardMaster;
using test::kBoardClock;
using test::kUs;
using test::SmallScene;
using test::Stimulus;
using Words = std::vector<std::int32_t>;

class AcceleratorLevels : public testing::TestWithParam<Timing> {
 protected:
  void run(const std::function<void(Stimulus&, BoardMaster&)>& script) {
    accelerator_ =
        std::make_unique<Accelerator>("accelerator", accel::Architecture{}, GetParam(), ledger_);
    line_ = std::make_unique<test::LineProbe>("line");
    stimulus_ = std::make_unique<Stimulus>("stimulus", [&](Stimulus& s) {
      BoardMaster master(s);
      script(s, master);
      finished_ = true;
    });
    stimulus_->to_target.bind(accelerator_->from_bus);
    accelerator_->interrupt.bind(*line_);
    sc_core::sc_start();
    EXPECT_TRUE(finished_);
  }

  // Runs a job that begins now and returns its clocks, which are those until its interrupt.
  std::int64_t clocks_of_job(Stimulus& s, BoardMaster& board) {
    const Picoseconds started = now_ps();
    const std::size_t before = line_->up.size();
    board.command(field::kControlStart);
    while (board.peek(field::kStatusBusy) != 0) s.sleep(kUs);
    const auto clocks = static_cast<std::int64_t>(board.peek(Register::result_cycles_low));
    EXPECT_EQ(line_->up.size(), before + 1);
    EXPECT_EQ(line_->up.back() - started, clocks * kBoardClock);
    board.clear_interrupts();
    return clocks;
  }

  // What a solve of the scene's matrix takes, counted out: 48 nodes, two a clock. Beyond the closed
  // form there are the copy of the guess into the multipliers' memories, and a clock a product: the
  // partitions finish their last rows together, and two of them are taken at a time.
  std::int64_t expected_clocks(int iterations) const {
    constexpr std::int64_t kPass = 24 + 20;
    const std::int64_t products = iterations + 1;
    return kPass + test::solve_time(k().row_begin, iterations) / kBoardClock + products;
  }
  const fixed::QuantisedMatrix& k() const { return scene_.computation.quantised(); }

  SmallScene scene_;
  Ledger ledger_;
  std::unique_ptr<Accelerator> accelerator_;
  std::unique_ptr<test::LineProbe> line_;
  std::unique_ptr<Stimulus> stimulus_;
  bool finished_ = false;
};

TEST_P(AcceleratorLevels, JobsHaveTheReferencesWordsAndTheEnginesClocks) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    fixed::Settings settings;
    fixed::QuantisedMatrix matrix = k();
    Words u(SmallScene::kUnknowns, 0);
    const auto solve = [&] {
      board.put(Aperture::b, b, 16);
      const std::int64_t clocks = clocks_of_job(s, board);
      const fixed::Report report = fixed::ReferenceSolver(settings).solve(matrix, {b, u});
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
      EXPECT_EQ(board.peek(Register::result_flags), report.flags.bits());
      EXPECT_EQ(board.peek(Register::result_iterations), 60U);
      return clocks;
    };
    EXPECT_EQ(solve(), expected_clocks(60));
    EXPECT_EQ(solve(), expected_clocks(60));  // from the first one's U

    // A contact node comes and goes; the access that says so is held for the packages.
    board.poke(Register::update_node, 17);
    for (const std::uint32_t kind : {0U, 1U}) {
      board.poke(Register::update_kind, kind);
      if (kind == 0) {
        board.poke(Register::update_diagonal, 1'000);
        matrix.set_contact(17, 1'000);
      } else {
        const auto row = k().row(17);
        board.put(Aperture::row, row, 12);
        board.poke(Register::update_blocks, static_cast<std::uint32_t>(row.size() / 9));
        matrix.restore_row(17, row);
      }
      std::int64_t clocks = 20;
      for (int i = k().row_begin[17]; i < k().row_begin[18]; ++i) {
        const auto other = static_cast<std::size_t>(k().column[static_cast<std::size_t>(i)]);
        clocks += test::packages(k().row_begin[other + 1] - k().row_begin[other]);
      }
      const Picoseconds before = now_ps();
      board.command(field::kControlUpdateNode);
      EXPECT_EQ(now_ps() - before, clocks * kBoardClock);
      EXPECT_EQ(board.get(Aperture::value, matrix.value.size(), 12), matrix.value);
      EXPECT_EQ(solve(), expected_clocks(60));
    }
  });
}

TEST_P(AcceleratorLevels, AResetEndsTheJobAndTheBoardWorksOn) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 3);
    board.command(field::kControlStart);
    s.sleep(expected_clocks(60) / 2 * kBoardClock);
    board.command(field::kControlReset);
    s.sleep(expected_clocks(60) * kBoardClock);
    EXPECT_TRUE(line_->up.empty());
    EXPECT_EQ(board.peek(Register::status), 0U);

    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    EXPECT_EQ(clocks_of_job(s, board), expected_clocks(60));
    Words u(SmallScene::kUnknowns, 0);
    fixed::ReferenceSolver(fixed::Settings{}).solve(k(), {b, u});
    EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
  });
}

TEST_P(AcceleratorLevels, AMethodThatTheLevelDoesNotHaveIsABadSetting) {
  run([&](Stimulus&, BoardMaster& board) {
    board.poke(Register::method, static_cast<std::uint32_t>(Method::pipelined_cg));
    board.load(k());
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_setting));
    EXPECT_EQ(board.peek(Register::error_detail), test::offset_of(Register::method));
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
  });
  fixed::Settings settings;
  settings.method = Method::pipelined_cg;
  EXPECT_THROW(Accelerator::require_supported(GetParam(), settings), InputError);
  EXPECT_NO_THROW(Accelerator::require_supported(Timing::loosely_timed, settings));
}

INSTANTIATE_TEST_SUITE_P(Engines, AcceleratorLevels,
                         testing::Values(Timing::approximately_timed, Timing::cycle_accurate),
                         [](const auto& level) {
                           return level.param == Timing::cycle_accurate ? "CycleAccurate"
                                                                        : "ApproximatelyTimed";
                         });

}  // namespace
}  // namespace hvp::vp
