// Frame n is sent while the board is free of frame n − 1 and the host is not done with it: two
// frames in flight, to the picosecond.
#include <numeric>

#include <gtest/gtest.h>

#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::pipeline_test {
namespace {

using test::FrameLog;
using test::kUs;
using test::Simulated;
using test::SmallScene;

constexpr Picoseconds kPeriod = 2'000 * kUs;
constexpr int kVectorBytes = 2 * SmallScene::kUnknowns;

// The parts of a frame without contact, as frame_test.cpp adds them up.
Picoseconds sense() { return test::pci_write(4) + 1 * kUs + test::pci_read(12) + 1 * kUs; }
Picoseconds convert() { return test::compute(4.0 * SmallScene::kUnknowns); }
Picoseconds send() {
  return convert() + 1 * kUs + test::pci_write(kVectorBytes) + test::pci_write(4);
}
Picoseconds receive() {
  return 5 * kUs + test::pci_read(4) + test::pci_write(4) + 1 * kUs + test::pci_read(kVectorBytes);
}
Picoseconds deliver() { return convert() + test::pci_write(12) + 10 * kUs; }

// The path's spans add up to the latency.
void expect_sums(const FrameLog& log) {
  for (std::size_t n = 0; n < log.frames.size(); ++n) {
    Picoseconds sum = 0;
    for (const SpanId id : log.paths[n]) {
      const Span& span = log.frames[n].spans[static_cast<std::size_t>(id)];
      sum += span.end - span.start;
    }
    EXPECT_EQ(sum, log.frames[n].latency()) << "frame " << n;
  }
}

SmallScene& pipelined(SmallScene& scene, Picoseconds period) {
  scene.settings.host.pipeline_depth = 1;
  scene.settings.period = period;
  scene.settings.budget = 2 * period;
  return scene;
}

TEST(Pipeline, ForceComesInTheNextPeriod) {
  SmallScene scene;
  const Simulated run(pipelined(scene, kPeriod));
  ASSERT_EQ(run.log.frames.size(), 10U);
  for (std::size_t n = 0; n < 9; ++n) {
    // The next frame's position, this one's U, the next one's b, this one's force.
    EXPECT_EQ(run.log.frames[n].number, static_cast<std::int64_t>(n));
    EXPECT_EQ(run.log.frames[n].latency(), kPeriod + sense() + receive() + send() + deliver());
  }
  // No frame follows the last one.
  EXPECT_EQ(run.log.frames[9].latency(), kPeriod + receive() + deliver());
  expect_sums(run.log);
  EXPECT_TRUE(run.platform.verdict().force_in_time());
  EXPECT_EQ(run.platform.verdict().worst_load(),
            sense() + receive() + send() + deliver() - 10 * kUs);
}

// What the pipeline is for: a period in which the frame does not fit from end to end, only from
// one U to the next. The board then works nearly all the time.
TEST(Pipeline, HoldsAPeriodThatOneFrameAfterTheOtherMisses) {
  SmallScene scene;
  const Picoseconds solve = test::solve_time(scene.computation.board().matrix().row_begin, 60);
  const Picoseconds cycle = receive() + send() + solve;
  ASSERT_GT(test::latency(scene), cycle + sense());
  scene.settings.frames = 50;
  const Simulated run(pipelined(scene, cycle + 1 * kUs));
  EXPECT_EQ(run.platform.verdict().misses(), 0);
  EXPECT_EQ(run.platform.verdict().skipped_ticks(), 0);
  expect_sums(run.log);
  // Two solves do not overlap, and the board rests for less than sense() between them.
  Picoseconds before = 0;
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) {
      if (span.phase != Phase::solve) continue;
      EXPECT_GE(span.start, before);
      if (frame.number > 2) {
        EXPECT_LE(span.start - before, receive() + send() + 2 * kUs) << frame.number;
      }
      before = span.end;
    }
  }
}

TEST(Pipeline, FramesOverlapInTheLedger) {
  SmallScene scene;
  const Simulated run(pipelined(scene, kPeriod));
  for (std::size_t n = 0; n + 1 < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_GT(frame.born + frame.latency(), run.log.frames[n + 1].born);
  }
}

TEST(Pipeline, UpdateOfTheFrameBeforeComesBeforeTheNextForceVector) {
  SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  const Simulated run(pipelined(scene, kPeriod));
  const double operations =
      (4 + 12 + 2 + 2) * SmallScene::kUnknowns +
      18.0 * static_cast<double>(scene.computation.board().matrix().column.size());
  for (std::size_t n = 0; n < 9; ++n) {
    EXPECT_EQ(run.log.frames[n].latency(),
              kPeriod + sense() + receive() + test::compute(operations) + send() + deliver());
  }
  expect_sums(run.log);
}

TEST(Pipeline, ContactIsFoundAndItsForceIsThatOfTheFrame) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 40;
  const Simulated run(pipelined(scene, kPeriod));
  EXPECT_EQ(run.platform.servo().counts().contact_changes, 1);
  bool touched = false;
  for (const Frame& frame : run.log.frames) {
    touched = touched || frame.touch().contact.node >= 0;
    // A node that is taken over has gone a frame's part of its way already.
    EXPECT_EQ(frame.touch().force.norm() > 0, touched) << frame.number;
  }
  EXPECT_TRUE(touched);
  expect_sums(run.log);
}

// A board that does not answer in time: its frame holds the force, and the board is brought back in
// what is left of the periods; the frames in between have none.
TEST(Pipeline, AFailedFrameIsHandedOutBeforeTheBoardIsBroughtBack) {
  SmallScene scene;
  const Picoseconds solve = test::solve_time(scene.computation.board().matrix().row_begin, 60);
  scene.settings.host.timeout_s = 10e-6;
  const Simulated run(pipelined(scene, solve / 2));
  EXPECT_GT(run.platform.verdict().unsolved(), 0);
  EXPECT_GT(run.platform.servo().counts().driver_errors, 0);
  EXPECT_EQ(run.platform.servo().counts().held_frames, run.platform.verdict().unsolved());
  EXPECT_EQ(run.platform.servo().counts().last_error, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(run.platform.accelerator().illegal_accesses(), 0);
  expect_sums(run.log);
}

}  // namespace
}  // namespace hvp::vp::pipeline_test
