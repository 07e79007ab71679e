// The operating system between an event and the servo process: when frames begin, to the
// picosecond.
#include <gtest/gtest.h>

#include "models/random/distribution.h"
#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::jitter_test {
namespace {

using test::kUs;
using test::Simulated;
using test::SmallScene;
using Kind = random::TimeDistribution::Kind;

random::TimeDistribution constant(double seconds) {
  random::TimeDistribution d;
  d.kind = Kind::constant;
  d.mean_s = seconds;
  return d;
}

random::TimeDistribution uniform(double longest_s) {
  random::TimeDistribution d;
  d.kind = Kind::uniform;
  d.maximum_s = longest_s;
  return d;
}

Picoseconds time_of(const Frame& frame, const std::vector<SpanId>& path, Phase phase) {
  Picoseconds sum = 0;
  for (const SpanId id : path) {
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    if (span.phase == phase) sum += span.end - span.start;
  }
  return sum;
}

TEST(Jitter, ReleaseIsTheFirstSpanAndTheWakeUpFollowsTickAndInterrupt) {
  SmallScene scene;
  scene.settings.host.jitter = constant(7e-6);
  scene.settings.host.wake_up = constant(3e-6);
  const Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 10U);
  for (std::size_t n = 0; n < 10; ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_EQ(frame.born, run.platform.session().begin + frame.number * 2'000 * kUs);
    EXPECT_EQ(frame.spans[0].phase, Phase::release);
    EXPECT_EQ(frame.spans[0].end, frame.born + 7 * kUs);
    EXPECT_EQ(frame.spans[1].phase, Phase::wake_up);
    EXPECT_EQ(frame.spans[1].end, frame.born + 10 * kUs);
    EXPECT_EQ(time_of(frame, run.log.paths[n], Phase::wake_up), 6 * kUs);
    // The wake-up after the interrupt, and what was there without either.
    EXPECT_EQ(frame.latency(), 10 * kUs + test::latency(scene) + 3 * kUs);
  }
}

TEST(Jitter, EachFrameHasItsOwnDraws) {
  SmallScene scene;
  scene.settings.seed = 42;
  scene.settings.host.jitter = uniform(50e-6);
  scene.settings.host.wake_up = uniform(20e-6);
  const Simulated run(scene);
  const random::Source jitter(uniform(50e-6), 42, "host.jitter");
  const random::Source wake_up(uniform(20e-6), 42, "host.wake_up");
  const auto ps = [](double seconds) { return std::llround(seconds * 1e12); };
  for (std::size_t n = 0; n < 10; ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_EQ(time_of(frame, run.log.paths[n], Phase::release), ps(jitter.time_s(frame.number)));
    EXPECT_EQ(time_of(frame, run.log.paths[n], Phase::wake_up),
              ps(wake_up.time_s(frame.number, 0)) + ps(wake_up.time_s(frame.number, 1)));
    EXPECT_EQ(frame.latency(), time_of(frame, run.log.paths[n], Phase::release) +
                                   time_of(frame, run.log.paths[n], Phase::wake_up) +
                                   test::latency(scene));
  }
}

// A process that is at work at its tick is not woken: only after its interrupt.
TEST(Jitter, AProcessThatIsLateIsNotWoken) {
  SmallScene scene;
  const Picoseconds load = test::latency(scene) - 10 * kUs + 3 * kUs;
  scene.settings.host.wake_up = constant(3e-6);
  scene.settings.period = load - 1;
  const Simulated run(scene);
  for (std::size_t n = 0; n < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    EXPECT_EQ(time_of(frame, run.log.paths[n], Phase::wake_up), 3 * kUs) << n;
    EXPECT_EQ(time_of(frame, run.log.paths[n], Phase::release), static_cast<Picoseconds>(n)) << n;
  }
}

// The timer's delay does not add up from one tick to the next.
TEST(Jitter, AReleaseThatComesWhileTheProcessWorksCostsNothing) {
  SmallScene scene;
  const Picoseconds load = test::latency(scene) - 10 * kUs;
  scene.settings.host.jitter = constant(7e-6);
  scene.settings.period = load;
  const Simulated run(scene);
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.latency(), 7 * kUs + test::latency(scene));
  }
}

TEST(Jitter, SetUpIsNoFrameAndDrawsNothing) {
  SmallScene scene;
  scene.settings.host.wake_up = constant(500e-6);
  const Simulated late(scene);
  // Set-up waits for the matrix' check; 500 µs would show.
  EXPECT_LT(late.platform.servo().set_up_time(), 500 * kUs);
}

}  // namespace
}  // namespace hvp::vp::jitter_test
