// [bus.graphics_traffic]: a picture's data over the bus each time that drawing begins.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/recording_target.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/bus/bus_meter.h"
#include "vp/pci/other_masters.h"
#include "vp/platform.h"

namespace hvp::vp::graphics_traffic_test {
namespace {

using test::kNs;
using test::kUs;
using test::SmallScene;

struct Worst : FrameObserver {
  void closed(const Frame& frame, const CriticalPath& /*path*/) override {
    latencies.push_back(frame.latency());
    Picoseconds waited = 0;
    for (const Span& s : frame.spans) {
      if (s.phase == Phase::arbitration) waited += s.end - s.start;
    }
    waits.push_back(waited);
  }
  std::vector<Picoseconds> latencies;
  std::vector<Picoseconds> waits;
};

TEST(GraphicsTraffic, APictureIsTheSurfacesVerticesUnlessItIsSaid) {
  GraphicsTraffic traffic;
  EXPECT_EQ(traffic.picture_bytes(56), 56 * 24);
  traffic.bytes = 1'000;
  EXPECT_EQ(traffic.picture_bytes(56), 1'000);
}

TEST(GraphicsTraffic, APictureTakesItsBurstsOfTheBus) {
  Ledger ledger;
  PciBus bus("bus", BusSettings{}, Timing::approximately_timed, ledger);
  GraphicsMaster card("card", 3'000, bus);
  test::Stimulus host("host", [&](test::Stimulus& m) {
    m.sleep_until(3 * kUs);
    card.drawing().notify();
    m.sleep_until(10 * kUs);
    card.drawing().notify();  // the first is still under way
    m.sleep_until(200 * kUs);
  });
  host.to_target.bind(bus.from_host);
  test::RecordingTarget target("target");
  bus.attach(target.from_bus, 0, 64);
  // 47 bursts of reads: 12 clocks each, and 750 words.
  sc_core::sc_start(to_sc_time(3 * kUs + (47 * 12 + 750) * 30 * kNs - 1));
  EXPECT_EQ(card.pictures(), 0);
  sc_core::sc_start(to_sc_time(1 * kNs));
  EXPECT_EQ(card.pictures(), 1);
  sc_core::sc_start(to_sc_time(200 * kUs));
  EXPECT_EQ(card.pictures(), 1) << "a picture that is due during the last one is left out";
  EXPECT_EQ(bus.uses()[PciBus::kGraphics].bytes, 3'000);
}

// Frames and passes of the static scene; the 33 Hz pass begins with the servo loop, every 15th
// frame or so meets a picture.
TEST(GraphicsTraffic, ItIsInTheTailOfTheFramesAndNotInTheirMedian) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 100;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.graphics_traffic.emplace();
  scene.settings.bus.graphics_traffic->bytes = 200'000;  // 2.6 ms of bursts
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::processes(), 4U);
  EXPECT_EQ(std::ranges::count(Platform::modules(), "graphics"), 1);
  Worst worst;
  platform.add_observer(worst);
  platform.run();
  ASSERT_EQ(worst.waits.size(), 100U);
  EXPECT_GE(platform.graphics()->pictures(), 6);
  std::sort(worst.waits.begin(), worst.waits.end());
  EXPECT_LT(worst.waits[50], 10 * 30 * kNs) << "most frames wait for clock edges alone";
  EXPECT_GT(worst.waits[99], 5 * kUs);
}

// A picture of 5.2 ms in frames of 2 ms: between two solutions the bus is not taken for longer than
// there is time, whenever what the picture took is followed.
TEST(GraphicsTraffic, PicturesLongerThanAFrameFillItAndNoMore) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 100;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.graphics_traffic.emplace();
  scene.settings.bus.graphics_traffic->bytes = 400'000;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  BusMeter meter({[&platform] { return platform.bus().busy(); },
                  [&platform] { return platform.bus().busy_until_now(); },
                  [&platform] { return platform.bus().uses(); },
                  [&platform] { return platform.bus().uses_until_now(); }});
  platform.add_observer(meter);
  platform.run();
  meter.ended();
  EXPECT_GT(meter.worst_share(), 0.95);
  EXPECT_LE(meter.worst_share(), 1);
}

}  // namespace
}  // namespace hvp::vp::graphics_traffic_test
