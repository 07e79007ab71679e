// Points of simulated time at which a program wants to look.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "tests/app/board/faulty_program.h"

namespace hvp::test::stop_test {
namespace {

constexpr std::array<std::int32_t, kUnknowns> kRhs = {640, 640, 640, 640, 640, 640};
constexpr std::uint64_t kControlAt = 0x20;
constexpr std::uint64_t kStatusAt = 0x24;

struct Seen {
  std::string point;
  std::string what;
  std::uint64_t time;
  std::int64_t job;
  std::uint64_t offset;
  std::uint32_t value;
};

class StopAt : public testing::Test {
 protected:
  void open(bool dma, const char* notification) {
    program.emplace(
        Parameters{.fault = {}, .dma = dma, .notification = notification, .pcie = false});
    ASSERT_NE(program->board, nullptr) << program->why.data();
    ASSERT_EQ(program->open(), HVP_OK);
  }
  static void note(void* context, const hvp_board_stop* stop) {
    auto& self = *static_cast<StopAt*>(context);
    EXPECT_EQ(stop->time_ps, hvp_board_now_ps(self.program->board));
    self.seen.push_back(
        {stop->point, stop->what, stop->time_ps, stop->job, stop->offset, stop->value});
  }
  std::string stop_at(const char* point, hvp_board_stopped stopped = note) {
    std::array<char, 1024> why{};
    const bool done =
        hvp_board_stop_at(program->board, point, stopped, this, why.data(), why.size());
    return done ? "" : why.data();
  }
  hvp_status solve() {
    return hvp_solve(&program->device, kRhs.data(), u.data(), u.size(), kLongestWait);
  }
  std::uint64_t now() const { return hvp_board_now_ps(program->board); }

  std::optional<Program> program;
  std::vector<Seen> seen;
  std::array<std::int32_t, kUnknowns> u{};
};

TEST_F(StopAt, AnAccessEachTimeItComes) {
  open(false, "intx");
  EXPECT_EQ(stop_at("write to CONTROL"), "");
  EXPECT_EQ(stop_at("read of STATUS"), "");
  ASSERT_EQ(hvp_write_rhs(&program->device, kRhs.data(), kRhs.size()), HVP_OK);
  const std::uint64_t started = now();
  ASSERT_EQ(hvp_start(&program->device), HVP_OK);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].point, "write to CONTROL");
  EXPECT_EQ(seen[0].time, started);  // the host makes it
  EXPECT_EQ(seen[0].job, 0);
  EXPECT_EQ(seen[0].offset, kControlAt);
  EXPECT_EQ(seen[0].value, 1U);
  std::uint32_t status = 0;
  hvp_board_read(program->board, kStatusAt, &status, sizeof status);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[1].time, now());  // the answer has arrived
  EXPECT_EQ(seen[1].value, status);
  ASSERT_EQ(hvp_wait(&program->device, kLongestWait), HVP_OK);
  const std::size_t before = seen.size();
  EXPECT_EQ(stop_at("read of STATUS", nullptr), "");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(seen.size(), before + 1);
  EXPECT_EQ(seen.back().job, 1);
  EXPECT_EQ(stop_at("read of STATUS", nullptr),
            "hvp_board_stop_at: there is no such point to take away");
}

TEST_F(StopAt, AMemoryOfTheBoards) {
  open(false, "intx");
  EXPECT_EQ(stop_at("write to B"), "");
  const std::uint64_t began = now();
  EXPECT_EQ(solve(), HVP_OK);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].time, began);
  EXPECT_EQ(seen[0].offset, 0x20000U);
  EXPECT_EQ(seen[0].value, 640U);
  EXPECT_EQ(seen[0].job, 0);
}

// At one instant every point is of one job.
TEST_F(StopAt, OfTheJobThatTheAccessBegins) {
  open(false, "intx");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(stop_at("write to B"), "");
  EXPECT_EQ(stop_at("job 1"), "");
  const std::uint64_t began = now();
  EXPECT_EQ(solve(), HVP_OK);
  ASSERT_EQ(seen.size(), 2U);
  for (const Seen& one : seen) {
    EXPECT_EQ(one.time, began) << one.what;
    EXPECT_EQ(one.job, 1) << one.what;
    EXPECT_TRUE(one.what.ends_with(", in job 1")) << one.what;
  }
}

TEST_F(StopAt, AJobBeforeItsFirstAccess) {
  open(true, "msi");
  EXPECT_EQ(stop_at("job 2"), "");
  std::uint64_t began = 0;
  for (int n = 0; n < 4; ++n) {
    if (n == 2) began = now();
    ASSERT_EQ(solve(), HVP_OK);
  }
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].time, began);
  EXPECT_EQ(seen[0].job, 2);
  EXPECT_EQ(stop_at("job 3"), "hvp_board_stop_at: job 3: has been: expected 4 or later");
}

// The check of the matrix sends the first.
TEST_F(StopAt, AMessage) {
  open(true, "msi");
  EXPECT_EQ(stop_at("message 3"), "");
  EXPECT_EQ(stop_at("interrupt 3"), "");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_TRUE(seen.empty());
  ASSERT_EQ(hvp_start(&program->device), HVP_OK);
  std::uint64_t when = 0;
  while (!hvp_board_interrupt(program->board)) {
    ASSERT_TRUE(hvp_board_next_event_ps(program->board, &when));
    hvp_board_run_until_ps(program->board, when);
  }
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].time, now());
  EXPECT_EQ(seen[0].value, 3U);
  EXPECT_EQ(seen[0].point, "message 3");
  EXPECT_EQ(seen[1].point, "interrupt 3");
  EXPECT_TRUE(seen[0].what.starts_with("message 3 arrives at ")) << seen[0].what;
  EXPECT_TRUE(seen[0].what.ends_with(" us, in job 1")) << seen[0].what;
  EXPECT_EQ(stop_at("message 3"), "hvp_board_stop_at: message 3: has been: expected 4 or later");
}

TEST_F(StopAt, ALineThatGoesUp) {
  open(false, "intx");
  EXPECT_EQ(stop_at("message 2"), "");
  EXPECT_EQ(stop_at("interrupt 2"), "");
  EXPECT_EQ(solve(), HVP_OK);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].point, "interrupt 2");
}

// At the stop a fault strikes what it has stopped at; no time passes there.
void break_start(void* context, const hvp_board_stop* stop) {
  auto* const board = static_cast<hvp_board*>(context);
  std::uint32_t word = 0;
  hvp_board_read(board, 0, &word, sizeof word);
  EXPECT_EQ(word, 0xffff'ffffU);
  hvp_board_write(board, kControlAt, &word, sizeof word);
  EXPECT_TRUE(hvp_board_run_until_ps(board, stop->time_ps + 1'000'000));
  EXPECT_EQ(hvp_board_now_ps(board), stop->time_ps);
  EXPECT_TRUE(hvp_board_inject(board, "kind=master-abort,access=start", nullptr, 0));
  EXPECT_TRUE(hvp_board_stop_at(board, "write to CONTROL", nullptr, nullptr, nullptr, 0));
}

TEST_F(StopAt, AFaultCanBeAskedForThere) {
  open(false, "intx");
  ASSERT_TRUE(hvp_board_stop_at(program->board, "write to CONTROL", break_start, program->board,
                                nullptr, 0));
  EXPECT_EQ(solve(), HVP_ERROR_BUS);
  ASSERT_TRUE(program->recover());
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(StopAt, OtherWordsAreRefused) {
  open(false, "intx");
  EXPECT_EQ(stop_at("write to CONTRL"),
            "hvp_board_stop_at: write to CONTRL: no such register; did you mean CONTROL?");
  const std::string all = stop_at("read of nothing at all");
  EXPECT_TRUE(
      all.starts_with("hvp_board_stop_at: read of nothing at all: no such register: "
                      "expected ID, VERSION, "))
      << all;
  EXPECT_TRUE(all.ends_with("COLUMN or VALUE")) << all;
  for (const char* const wrong :
       {"", "job", "job -1", "job 1x", "message 0", "interrupt", "write CONTROL", "Job 1"}) {
    EXPECT_NE(stop_at(wrong).find("expected \"write to REGISTER\""), std::string::npos) << wrong;
  }
  EXPECT_NE(stop_at(nullptr), "");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_TRUE(seen.empty());
}

}  // namespace
}  // namespace hvp::test::stop_test
