// Schedules of one core, drawn out by hand.
#include "models/host/shared_core.h"

#include <gtest/gtest.h>

namespace hvp::host::shared_core_test {
namespace {

constexpr SharedCore::Settings kSwitch{.context_switch = 4, .section = 0, .section_every = 1};
// Sections of 30 at 0, 100, 200 … of the other process' own time.
constexpr SharedCore::Settings kSections{.context_switch = 4, .section = 30, .section_every = 100};

void expect_dispatch(const SharedCore::Dispatch& d, std::int64_t unblocked, std::int64_t runs,
                     bool preempts) {
  EXPECT_EQ(d.unblocked, unblocked);
  EXPECT_EQ(d.runs, runs);
  EXPECT_EQ(d.preempts, preempts);
}

// A core on which the other process has begun `work` at 1000.
SharedCore running(const SharedCore::Settings& settings, std::int64_t work) {
  SharedCore core(settings);
  core.servo_sleeps(0);
  EXPECT_EQ(core.other_takes(1000), 1000) << "a core that was idle is not switched";
  core.other_begins(1000, work);
  EXPECT_EQ(core.other_ends(), 1000 + work);
  return core;
}

TEST(SharedCore, IsTheServosUntilItSleeps) {
  SharedCore core(kSwitch);
  EXPECT_TRUE(core.servo_has_it());
  core.servo_sleeps(10);
  EXPECT_FALSE(core.servo_has_it());
  expect_dispatch(core.servo_ready(20), 20, 20, false);
  EXPECT_TRUE(core.servo_has_it());
}

// 1000      1060 64        164 168        208
//  | other 60 |sw| servo 100 |sw| other 40 |
TEST(SharedCore, APreemptionCostsASwitchEachWayAndTheServosTime) {
  SharedCore core = running(kSwitch, 100);
  expect_dispatch(core.servo_ready(1060), 1060, 1064, true);
  EXPECT_FALSE(core.other_has_it());
  EXPECT_EQ(core.other_progress(), 60);
  EXPECT_FALSE(core.other_done(1060));
  core.servo_sleeps(1164);
  EXPECT_EQ(core.other_takes(1164), 1168);
  core.other_resumes(1168);
  EXPECT_EQ(core.other_ends(), 1208);
  EXPECT_FALSE(core.other_done(1207));
  EXPECT_TRUE(core.other_done(1208));
  EXPECT_FALSE(core.other_has_it());
}

TEST(SharedCore, ASwitchThatIsNotOverIsLost) {
  SharedCore core = running(kSwitch, 100);
  core.servo_ready(1060);
  core.servo_sleeps(1164);
  EXPECT_EQ(core.other_takes(1164), 1168);
  expect_dispatch(core.servo_ready(1167), 1167, 1171, true);
  core.servo_sleeps(1200);
  EXPECT_EQ(core.other_takes(1200), 1204);
  core.other_resumes(1204);
  EXPECT_EQ(core.other_ends(), 1244);
}

// Of 100 each the first 30 hold the servo up.
TEST(SharedCore, ASectionHoldsTheServoUpUntilItsEnd) {
  SharedCore in_it = running(kSections, 250);
  expect_dispatch(in_it.servo_ready(1110), 1130, 1134, true);
  EXPECT_EQ(in_it.other_progress(), 130);
  SharedCore last_instant = running(kSections, 250);
  expect_dispatch(last_instant.servo_ready(1129), 1130, 1134, true);
  SharedCore over = running(kSections, 250);
  expect_dispatch(over.servo_ready(1130), 1130, 1134, true);
  SharedCore not_begun = running(kSections, 250);
  expect_dispatch(not_begun.servo_ready(1200), 1200, 1204, true);
  SharedCore cut_short = running(kSections, 215);  // the work ends within a section
  expect_dispatch(cut_short.servo_ready(1205), 1215, 1219, true);
  EXPECT_TRUE(cut_short.other_done(1215));
}

// The sections lie in the process' own time: 60 before the preemption, 45 after it.
TEST(SharedCore, SectionsMoveWithThePreemptions) {
  SharedCore core = running(kSections, 250);
  core.servo_ready(1060);
  core.servo_sleeps(1500);
  core.other_takes(1500);
  core.other_resumes(1504);
  expect_dispatch(core.servo_ready(1549), 1574, 1578, true);
  EXPECT_EQ(core.other_progress(), 130);
}

// At one instant the order of the questions does not matter.
TEST(SharedCore, WorkThatEndsAsTheServoIsReadyHasEnded) {
  SharedCore servo_first = running(kSwitch, 100);
  expect_dispatch(servo_first.servo_ready(1100), 1100, 1104, false);
  EXPECT_TRUE(servo_first.other_done(1100));
  SharedCore other_first = running(kSwitch, 100);
  EXPECT_TRUE(other_first.other_done(1100));
  expect_dispatch(other_first.servo_ready(1100), 1100, 1104, false);
}

TEST(SharedCore, AProcessThatGetsTheCoreAsTheServoIsReadyHasNotHadIt) {
  SharedCore core(kSwitch);
  core.servo_sleeps(0);
  core.other_takes(50);
  core.other_begins(50, 100);
  expect_dispatch(core.servo_ready(50), 50, 50, true);
  EXPECT_FALSE(core.other_has_it());
  EXPECT_EQ(core.other_progress(), 0);
}

TEST(SharedCore, ACoreThatWasIdleForAMomentIsNotSwitched) {
  SharedCore core(kSwitch);
  core.servo_sleeps(99);
  EXPECT_EQ(core.other_takes(100), 100);
  SharedCore at_once(kSwitch);
  at_once.servo_sleeps(100);
  EXPECT_EQ(at_once.other_takes(100), 104);
}

}  // namespace
}  // namespace hvp::host::shared_core_test
