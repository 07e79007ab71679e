// Budgets and periods that are too short: the verdicts flip at the picosecond.
#include <array>
#include <memory>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/platform.h"

namespace hvp::vp::deadline_test {
namespace {

using test::FrameLog;
using test::kUs;
using test::SmallScene;

constexpr Picoseconds kOutputDelay = 10 * kUs;  // the only thing that nobody works on

// Of a frame without contact; frame_test.cpp adds it up from its steps.
constexpr std::int64_t kFrames = 10;

// What a frame without contact takes, by a run with time to spare, in a child process: SystemC
// elaborates once in a process.
Picoseconds frame_latency() {
  std::array<int, 2> pipe_ends{};
  if (pipe(pipe_ends.data()) != 0) return 0;
  const pid_t child = fork();
  if (child == 0) {
    SmallScene scene;
    scene.settings.frames = 2;
    Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    platform.run();
    const Picoseconds latency = platform.verdict().worst_latency();
    const bool sent = write(pipe_ends[1], &latency, sizeof(latency)) == sizeof(latency);
    _exit(sent ? 0 : 1);
  }
  Picoseconds latency = 0;
  int status = 1;
  const bool received = read(pipe_ends[0], &latency, sizeof(latency)) == sizeof(latency);
  waitpid(child, &status, 0);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
  return received && status == 0 ? latency : 0;
}

class Deadline : public testing::Test {
 protected:
  void SetUp() override {
    latency_ = frame_latency();
    ASSERT_GT(latency_, 100 * kUs);
    load_ = latency_ - kOutputDelay;
  }
  const Verdict& run(Picoseconds period, Picoseconds budget) {
    scene_.settings.period = period;
    scene_.settings.budget = budget;
    scene_.settings.frames = kFrames;
    platform_ = std::make_unique<Platform>(scene_.settings, scene_.body, scene_.computation,
                                           scene_.contacts);
    platform_->add_observer(log_);
    platform_->run();
    return platform_->verdict();
  }

  SmallScene scene_;
  FrameLog log_;
  std::unique_ptr<Platform> platform_;
  Picoseconds latency_ = 0;
  Picoseconds load_ = 0;
};

TEST_F(Deadline, BudgetOfTheLatencyHolds) {
  const Verdict& v = run(2'000 * kUs, latency_);
  EXPECT_TRUE(v.force_in_time());
  EXPECT_EQ(v.misses(), 0);
}

TEST_F(Deadline, BudgetOneLessMissesEveryFrame) {
  const Verdict& v = run(2'000 * kUs, latency_ - 1);
  EXPECT_FALSE(v.force_in_time());
  EXPECT_EQ(v.late_forces(), kFrames);
  EXPECT_TRUE(v.load_held());
}

TEST_F(Deadline, PeriodOfTheLoadHolds) {
  const Verdict& v = run(load_, latency_);
  EXPECT_TRUE(v.load_held());
  EXPECT_TRUE(v.force_in_time());
  EXPECT_EQ(v.worst_load(), load_);
  for (const Frame& frame : log_.frames) EXPECT_EQ(frame.latency(), latency_);
}

TEST_F(Deadline, PeriodOneLessMakesEveryFrameLaterThanTheLast) {
  const Verdict& v = run(load_ - 1, load_ - 1);
  EXPECT_FALSE(v.load_held());
  EXPECT_EQ(v.overloads(), kFrames);
  EXPECT_EQ(v.skipped_ticks(), 0);
  for (const Frame& frame : log_.frames) {
    EXPECT_EQ(frame.latency(), latency_ + frame.number);
    // The delay is the frame's first span.
    EXPECT_EQ(frame.spans[0].phase, Phase::release);
    EXPECT_EQ(frame.spans[0].end - frame.spans[0].start, frame.number);
  }
}

// A frame takes two and a half periods. Of five ticks two have a frame: tick 0 runs to 2.5 T,
// tick 1 has passed entirely; 2 begins half a period late and runs to 5 T; 3 and 4 have passed.
TEST_F(Deadline, TicksWithoutAFrameAreCountedAndMiss) {
  const Picoseconds period = 2 * load_ / 5;
  const Verdict& v = run(period, period);
  ASSERT_EQ(log_.frames.size(), 4U);
  const std::array<std::int64_t, 4> ran = {0, 2, 5, 7};
  Picoseconds free_at = 0;
  for (std::size_t i = 0; i < ran.size(); ++i) {
    const Frame& frame = log_.frames[i];
    EXPECT_EQ(frame.number, ran[i]);
    const Picoseconds due = ran[i] * period;
    const Picoseconds begins = std::max(due, free_at);
    EXPECT_EQ(frame.latency(), begins - due + latency_);
    EXPECT_EQ(frame.work_done - frame.born, begins - due + load_);
    free_at = begins + load_;
  }
  EXPECT_EQ(v.frames(), 4);
  EXPECT_EQ(v.skipped_ticks(), 6);
  EXPECT_EQ(v.frames() + v.skipped_ticks(), kFrames);
  EXPECT_EQ(v.late_forces(), 4);
  EXPECT_EQ(v.misses(), 10);
  EXPECT_EQ(v.overloads(), 10);
}

}  // namespace
}  // namespace hvp::vp::deadline_test
