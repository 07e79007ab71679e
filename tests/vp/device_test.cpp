// The haptic device behind the DAQ board, in the platform.
#include "models/plant/device.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/small_scene.h"
#include "vp/platform.h"

namespace hvp::vp::device_test {
namespace {

using test::SmallScene;

// Stays inside the body and keeps what drives it.
class Recorder : public plant::Device {
 public:
  explicit Recorder(const Eigen::Vector3d& tip) : tip_{tip, Eigen::Vector3d::Zero()} {}

  // In the order in which they act; the platform asks for the tip more often than the force
  // changes.
  std::vector<std::pair<Picoseconds, Eigen::Vector3d>> changes;

 private:
  void advance(Picoseconds from, Picoseconds /*to*/, const Eigen::Vector3d& force) override {
    const Eigen::Vector3d last =
        changes.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : changes.back().second;
    if (force != last) changes.emplace_back(from, force);
  }
  plant::TipState state() const override { return tip_; }
  plant::TipState tip_;
};

// What the frames say went to the motor, and when, is what the device was driven with.
void expect_what_the_frames_say(const std::optional<host::Delay>& delay) {
  SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  scene.settings.frames = 40;
  scene.settings.host.delay = delay;
  Recorder device(SmallScene::above(-2e-3));
  scene.settings.haptic_devices = {&device};
  test::Simulated run(scene);

  // The tip is asked for last when the last frame begins.
  const Frame& asked = run.log.frames.back();
  std::vector<std::pair<Picoseconds, Eigen::Vector3d>> expected;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Frame& frame : run.log.frames) {
    Eigen::Vector3d force;
    for (int i = 0; i < 3; ++i) {
      force[i] = plant::kForce.to_value(plant::kForce.to_counts(-frame.touch().force[i]).value);
    }
    const Picoseconds settled = frame.born + frame.latency() - run.platform.session().begin;
    if (force != last && frame.born + frame.latency() < asked.born)
      expected.emplace_back(settled, force);
    last = force;
  }
  ASSERT_GT(expected.size(), 10U);
  EXPECT_EQ(device.changes, expected);
}

TEST(HapticDevice, IsDrivenByTheRegistersWordsWhenTheConverterHasSettled) {
  expect_what_the_frames_say(std::nullopt);
}

// Two and a half periods: two more forces are on their way meanwhile.
TEST(HapticDevice, IsDrivenInOrderByForcesThatAreHeldBack) {
  expect_what_the_frames_say(host::Delay{5e-3});
}

TEST(HapticDevice, WhereItIsIsWhatIsRead) {
  SmallScene scene;
  Recorder device({0.01, -0.02, 0.3});
  scene.settings.haptic_devices = {&device};
  test::Simulated run(scene);
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.touch().tip, Eigen::Vector3d(0.01, -0.02, 0.3));
  }
}

}  // namespace
}  // namespace hvp::vp::device_test
