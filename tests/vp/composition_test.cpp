// What is there at all, and that it is the same in every process.
#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "models/config/input_error.h"
#include "tests/vp/child_output.h"
#include "tests/vp/small_scene.h"
#include "vp/platform.h"

namespace hvp::vp::composition_test {
namespace {

using test::SmallScene;

void expect_the_six(SmallScene& scene) {
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::modules(), (std::vector<std::string>{"bus", "accelerator", "daq", "access",
                                                           "servo", "collision"}));
  // The end of a job; the servo process; the collision process.
  EXPECT_EQ(Platform::processes(), 3U);
}

TEST(Composition, StaticSceneBuildsSixModules) {
  SmallScene scene;
  expect_the_six(scene);
}

TEST(Composition, DynamicsIsTheHostsArithmeticAndNoModule) {
  SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  expect_the_six(scene);
}

TEST(Composition, UntimedBuildsTheSame) {
  SmallScene scene;
  scene.settings.fidelity = {Timing::untimed, Timing::untimed, Timing::untimed, Numbers::fixed};
  expect_the_six(scene);
}

TEST(Composition, OneCoreBuildsTheSame) {
  SmallScene scene;
  scene.settings.host.cores = 1;
  expect_the_six(scene);
}

TEST(Composition, JitterIsNoModuleAndNoProcess) {
  SmallScene scene;
  scene.settings.host.jitter.emplace();
  scene.settings.host.wake_up.emplace();
  expect_the_six(scene);
}

TEST(Composition, DrawnLatenciesAreNoModuleAndNoProcess) {
  SmallScene scene;
  scene.settings.host.interrupt_latencies.emplace();
  scene.settings.bus.read_latencies.emplace();
  expect_the_six(scene);
}

std::string parts_of_a_link(bool drawn) {
  return test::output_of_child([drawn](std::string& text) {
    SmallScene scene;
    scene.settings.bus.pcie.emplace();
    scene.settings.transfer.method = Transfer::Method::dma;
    if (drawn) scene.settings.bus.pcie->root_complex_latencies.emplace();
    const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    for (const std::string& module : Platform::modules()) text += module + ' ';
    text += std::to_string(Platform::processes());
  });
}

TEST(Composition, ALinkWhoseReadsAreDrawnIsTheSameLink) {
  const std::string constant = parts_of_a_link(false);
  EXPECT_NE(constant.find("pcie"), std::string::npos);
  EXPECT_EQ(parts_of_a_link(true), constant);
}

// Between the board and what it is attached to, where they may come during a run.
TEST(Composition, FaultsAreNoModuleAndNoProcess) {
  SmallScene scene;
  scene.settings.faults.resize(3);
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::modules(), (std::vector<std::string>{"bus", "accelerator", "daq", "access",
                                                           "servo", "collision"}));
  EXPECT_EQ(Platform::processes(), 3U);
}

// The engine is the accelerator's; who looks at its clocks is there when asked for.
TEST(Composition, AnEngineAndAWaveformAreThereWhereTheyAreAskedFor) {
  SmallScene scene;
  scene.settings.fidelity.accelerator = Timing::cycle_accurate;
  {
    const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    const std::vector<std::string> modules = Platform::modules();
    EXPECT_EQ(std::ranges::count(modules, "waveform"), 0);
    EXPECT_EQ(std::ranges::count(modules, "accelerator.engine"), 1);
    for (const char* unit : {"vector_unit", "divider", "sequencer", "matrix_editor", "spmxv_0",
                             "spmxv_1", "spmxv_2", "spmxv_3", "spmxv_4"}) {
      EXPECT_EQ(std::ranges::count(modules, std::string("accelerator.engine.") + unit), 1) << unit;
    }
  }
  const std::string file = testing::TempDir() + "hvp_composition_" + std::to_string(getpid());
  scene.settings.waveform = {file, 0, 1};
  {
    const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    EXPECT_EQ(std::ranges::count(Platform::modules(), "waveform"), 1);
  }
  std::filesystem::remove(file + ".vcd");
  scene.settings.fidelity.accelerator = Timing::approximately_timed;
  EXPECT_THROW(Platform(scene.settings, scene.body, scene.computation, scene.contacts), InputError);
}

// All spans of all frames of a run, as bytes.
class Bytes : public FrameObserver {
 public:
  void closed(const Frame& f, const CriticalPath& path) override {
    add(f.number), add(f.born), add(f.work_done), add(f.touch().contact.node), add(f.contact_age);
    for (int i = 0; i < 3; ++i) add(f.touch().tip[i]), add(f.touch().force[i]);
    add(f.saturations), add(f.flags);
    for (const Span& s : f.spans) add(s.part), add(s.phase), add(s.start), add(s.end), add(s.cause);
    for (const SpanId id : path.spans()) add(id);
  }
  std::string text;

 private:
  template <class Value>
  void add(const Value& value) {
    std::array<char, sizeof(Value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(Value));
    text.append(bytes.data(), bytes.size());
  }
};

std::string frames_of_a_run() {
  return test::output_of_child([](std::string& text) {
    SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
    scene.slide(0.05);
    scene.settings.frames = 40;
    Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    Bytes bytes;
    platform.add_observer(bytes);
    platform.run();
    text = bytes.text;
  });
}

TEST(Composition, TwoProcessesGiveTheSameFrames) {
  const std::string first = frames_of_a_run();
  const std::string second = frames_of_a_run();
  EXPECT_GT(first.size(), 40U * 500U);
  EXPECT_TRUE(first == second);
}

}  // namespace
}  // namespace hvp::vp::composition_test
