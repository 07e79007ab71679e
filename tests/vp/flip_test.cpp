// Bits that flip in the board's engine, as the driver, the frames and the record of faults see it.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::flip_test {
namespace {

using engine::FlipPlace;
using test::Simulated;
using test::SmallScene;

// The contact has its place, and stays there.
constexpr std::int64_t kAt = 25;
constexpr std::int64_t kFrames = 32;
constexpr std::int64_t kAmid = 5'000;  // clocks: the job runs

Fault flip_at(std::int64_t clock, const engine::Flip& flip) {
  Fault fault;
  fault.kind = FaultKind::flip;
  fault.frame = kAt;
  fault.clock = clock;
  fault.flip = flip;
  return fault;
}

void prepare(SmallScene& scene, const std::vector<Fault>& faults,
             Timing level = Timing::cycle_accurate) {
  scene.touch();
  scene.settings.frames = kFrames;
  scene.settings.host.timeout_s = 1e-3;
  scene.settings.solver.start = fixed::Start::zero;
  scene.settings.fidelity.accelerator = level;
  scene.settings.faults = faults;
}

// The forces, as text that tells every bit, and what came of the first fault.
std::string described(const Simulated& run) {
  std::string text;
  for (const Frame& frame : run.log.frames) {
    char line[160];
    const Eigen::Vector3d& force = frame.touch().force;
    std::snprintf(line, sizeof(line), "%d %lld %a %a %a\n", static_cast<int>(frame.status),
                  static_cast<long long>(frame.flips), force.x(), force.y(), force.z());
    text += line;
  }
  if (run.platform.faults() != nullptr) {
    const FlipEffect& e = run.platform.faults()->records().front().effect;
    text += std::to_string(e.wrong) + " " + std::to_string(e.worst);
  }
  return text;
}

std::vector<Eigen::Vector3d> forces(const Simulated& run) {
  std::vector<Eigen::Vector3d> all;
  for (const Frame& frame : run.log.frames) all.push_back(frame.touch().force);
  return all;
}

// With a start from zero a frame without the flip is the frame before.
TEST(Flips, AWordOfRMakesOneFrameWrongAndNobodyNotices) {
  SmallScene scene;
  prepare(scene, {flip_at(kAmid, {.place = FlipPlace::r, .node = 44, .component = 2, .bit = 14})});
  const Simulated run(scene);
  const std::vector<Eigen::Vector3d> force = forces(run);
  EXPECT_EQ(force[kAt - 1], force[kAt + 1]);
  EXPECT_NE(force[kAt - 1], force[kAt]);
  const FaultRecord& record = run.platform.faults()->records().front();
  EXPECT_EQ(record.injected, 1);
  EXPECT_EQ(record.unnoticed(), 1);
  EXPECT_EQ(record.effect.wrong, 1);
  EXPECT_EQ(record.effect.last_wrong_frame, kAt);
  EXPECT_GT(record.effect.worst, 0);
  EXPECT_EQ(run.log.frames[kAt].flips, 1);
  EXPECT_EQ(run.log.frames[kAt + 1].flips, 0);
}

TEST(Flips, AWordOfTheMatrixMakesEveryFrameWrong) {
  SmallScene scene;
  prepare(scene, {flip_at(0, {.place = FlipPlace::matrix,
                              .partition = 2,
                              .package = 3,
                              .row = 1,
                              .column = 0,
                              .bit = 10})});
  const Simulated run(scene);
  const FaultRecord& record = run.platform.faults()->records().front();
  EXPECT_EQ(record.effect.wrong, kFrames - kAt);
  EXPECT_EQ(record.effect.last_wrong_frame, kFrames - 1);
}

TEST(Flips, WhatIsWrittenBeforeItIsReadHasNoEffect) {
  SmallScene scene;
  prepare(scene, {flip_at(0, {.place = FlipPlace::q, .node = 3, .component = 0, .bit = 30})});
  const Simulated run(scene);
  const FaultRecord& record = run.platform.faults()->records().front();
  EXPECT_EQ(record.injected, 1);
  EXPECT_EQ(record.effect.wrong, 0);
  EXPECT_EQ(forces(run)[kAt], forces(run)[kAt - 1]);
}

TEST(Flips, AJobWithoutAnEndIsTheDriversTimeOut) {
  SmallScene scene;
  prepare(scene, {flip_at(kAmid, {.place = FlipPlace::loops, .bit = 15})});
  const Simulated run(scene);
  EXPECT_EQ(run.log.frames[kAt].status, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(run.platform.servo().counts().recoveries, 1);
  EXPECT_EQ(run.platform.faults()->unnoticed(), 0);
  EXPECT_EQ(forces(run)[kAt + 1], forces(run)[kAt - 1]) << "set up again";
}

TEST(Flips, ABitThatTheEngineDoesNotHaveDoesNotFlip) {
  SmallScene scene;
  prepare(scene, {flip_at(5, {.place = FlipPlace::x, .node = 48, .component = 0, .bit = 0})});
  const Simulated run(scene);
  const FaultRecord& record = run.platform.faults()->records().front();
  EXPECT_EQ(record.injected, 0);
  EXPECT_EQ(record.why_not(kFrames),
            "the engine has no such bit: node is 48, expected less than 48");
}

TEST(Flips, AClockBehindTheEndOfTheRunIsNotMade) {
  SmallScene scene;
  prepare(scene,
          {flip_at(1'000'000'000, {.place = FlipPlace::x, .node = 4, .component = 0, .bit = 0})});
  const Simulated run(scene);
  const FaultRecord& record = run.platform.faults()->records().front();
  EXPECT_EQ(record.injected, 1);
  EXPECT_EQ(record.effect.flipped, 0);
  EXPECT_EQ(record.effect.wrong, 0);
}

// The objects and events of all modules and processes that are there for flips.
int count_of_flips(const std::vector<sc_core::sc_object*>& objects) {
  int count = 0;
  for (const sc_core::sc_object* object : objects) {
    if (std::string(object->basename()) == "flips") ++count;
    for (const sc_core::sc_event* event : object->get_child_events()) {
      if (std::string(event->basename()) == "flip_due") ++count;
    }
    count += count_of_flips(object->get_child_objects());
  }
  return count;
}

TEST(Flips, WithoutOneThereIsNoProcessAndNoEvent) {
  SmallScene scene;
  prepare(scene, {});
  const Simulated run(scene);
  EXPECT_EQ(count_of_flips(sc_core::sc_get_top_level_objects()), 0);
  EXPECT_FALSE(run.platform.accelerator().engine()->carries_words());
}

TEST(Flips, WithSomeThereIsOneProcessAndOneEvent) {
  SmallScene scene;
  Fault fault = flip_at(kAmid, {.place = FlipPlace::q});
  fault.count = 3;
  prepare(scene, {fault});
  const Simulated run(scene);
  EXPECT_EQ(count_of_flips(sc_core::sc_get_top_level_objects()), 2);
  EXPECT_TRUE(run.platform.accelerator().engine()->carries_words());
}

// Behind the job's end and before the host has read it, a word of U is another one in that frame's
// force; a clock later than any read it is nobody's.
TEST(Flips, AWordOfUIsWrongOnceItIsRead) {
  const std::int64_t clocks = std::stoll(test::output_of_child([](std::string& text) {
    SmallScene scene;
    prepare(scene, {});
    const Simulated run(scene);
    text = std::to_string(run.platform.accelerator().longest_solve()->clocks);
  }));
  const auto wrong_at = [clocks](std::int64_t behind) {
    return test::output_of_child([clocks, behind](std::string& out) {
      SmallScene scene;
      prepare(scene, {flip_at(clocks + behind,
                              {.place = FlipPlace::x, .node = 44, .component = 2, .bit = 12})});
      const Simulated run(scene);
      out = std::to_string(run.platform.faults()->records().front().effect.wrong);
    });
  };
  EXPECT_EQ(wrong_at(3), "1");
  EXPECT_EQ(wrong_at(100'000), "0");
}

// Drawn places and clocks, a frame each: the same forces and the same record at both levels.
TEST(Flips, AreTheSameAtTheLevelRtl) {
  try {
    Accelerator::require_supported(Timing::rtl, {});
  } catch (const InputError&) {
    GTEST_SKIP() << "built without Verilator";
  }
  for (std::size_t place = 0; place < engine::kFlipPlaces; ++place) {
    if (static_cast<FlipPlace>(place) >= FlipPlace::r_exponent) break;  // not compared there
    if (static_cast<FlipPlace>(place) == FlipPlace::last) continue;     // nor this
    const auto run_at = [place](Timing level) {
      return test::output_of_child([place, level](std::string& out) {
        SmallScene scene;
        Fault fault = flip_at(-1, {.place = static_cast<FlipPlace>(place)});
        fault.count = 4;
        prepare(scene, {fault}, level);
        const Simulated run(scene);
        out = described(run);
      });
    };
    const std::string accurate = run_at(Timing::cycle_accurate);
    EXPECT_FALSE(accurate.empty());
    EXPECT_EQ(run_at(Timing::rtl), accurate) << engine::name(static_cast<FlipPlace>(place));
  }
}

}  // namespace
}  // namespace hvp::vp::flip_test
