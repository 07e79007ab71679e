#include "vp/bus/bus_meter.h"

#include <algorithm>
#include <map>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/vp/gliding_scene.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/tenure_log.h"
#include "vp/platform.h"

namespace hvp::vp::bus_meter_test {
namespace {

// What the frames' transactions took, from the ledger.
class BusSpans : public FrameObserver {
 public:
  void closed(const Frame& frame, const CriticalPath& /*path*/) override {
    Picoseconds time = 0;
    for (const Span& span : frame.spans) {
      if (span.part == Part::bus && span.phase != Phase::arbitration) time += span.end - span.start;
    }
    last = time;
    all += time;
  }
  Picoseconds last = 0;
  Picoseconds all = 0;
};

BusMeter::Bus meter_of(const Platform& platform) {
  return {[&platform] { return platform.bus().busy(); },
          [&platform] { return platform.bus().busy_until_now(); },
          [&platform] { return platform.bus().uses(); },
          [&platform] { return platform.bus().uses_until_now(); }};
}

TEST(BusMeter, CountsTheFramesTransactionsAndNotTheSetUp) {
  test::SmallScene scene;
  scene.touch();
  scene.settings.frames = 20;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  BusSpans spans;
  BusMeter meter(meter_of(platform));
  platform.add_observer(spans);
  platform.add_observer(meter);
  platform.run();
  meter.ended();

  const Picoseconds period = scene.settings.period;
  Picoseconds counted = 0;
  for (const BusUse& use : meter.uses()) {
    counted += use.busy;
    if (use.name != "processor") {
      EXPECT_EQ(use.transactions, 0) << use.name;
    }
  }
  EXPECT_DOUBLE_EQ(meter.share(), static_cast<double>(counted) / static_cast<double>(meter.time()));
  // Besides the frames' own there is what the driver writes to close the board: less than a frame.
  EXPECT_GE(counted, spans.all);
  EXPECT_LT(counted, spans.all + spans.last);
  EXPECT_LT(counted, platform.bus().busy());
  // A frame in the hold, and at most one that moves the contact as well.
  const auto held = static_cast<double>(spans.last) / static_cast<double>(period);
  EXPECT_GE(meter.worst_share(), held);
  EXPECT_LT(meter.worst_share(), 1.5 * held);
}

TEST(BusMeter, KnowsWhoTookTheBus) {
  test::SmallScene scene;
  scene.touch();
  scene.settings.frames = 20;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.traffic = BusTraffic{};
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  BusMeter meter(meter_of(platform));
  platform.add_observer(meter);
  platform.run();
  meter.ended();
  double shares = 0;
  for (const BusUse& use : meter.uses()) {
    const bool works = use.name == "processor" || use.name == "traffic";
    EXPECT_EQ(use.transactions > 0, works) << use.name;
    EXPECT_EQ(use.busy > 0, works) << use.name;
    shares += static_cast<double>(use.busy) / static_cast<double>(meter.time());
  }
  EXPECT_NEAR(shares, meter.share(), 1e-12);
  EXPECT_LT(meter.share(), 1);
  EXPECT_GE(meter.worst_share(), meter.share());
}

// The host tabulates the surface's compliance at set-up, whatever is on the bus: of a burst that is
// under way when the loop begins, what comes after counts.
TEST(BusMeter, DividesWhatIsUnderWayWhenTheLoopBegins) {
  test::SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.solved_by = host::SolvedBy::cholesky;
  test::GlidingScene glide(options);
  PlatformSettings& settings = glide.scene.settings;
  settings.host.solver = host::SolvedBy::cholesky;
  settings.fidelity.bus = Timing::approximately_timed;
  settings.bus.traffic = BusTraffic{.period_s = 13.6e-6};
  Platform platform(settings, glide.soft(), nullptr);
  BusMeter meter(meter_of(platform));
  test::TenureLog log;
  platform.add_observer(meter);
  platform.add_tenure_sink(log);
  platform.run();
  meter.ended();
  const Picoseconds begin = platform.servo().set_up_time();
  std::map<std::string_view, Picoseconds> busy;
  int divided = 0;
  for (const Tenure& tenure : log.of(Resource::bus)) {
    if (tenure.end <= begin) continue;
    if (tenure.start < begin) ++divided;
    busy[tenure.user] += tenure.end - std::max(tenure.start, begin);
  }
  EXPECT_EQ(divided, 1);
  for (const BusUse& use : meter.uses()) EXPECT_EQ(use.busy, busy[use.name]) << use.name;
}

// Every word of a frame's data over a link of the board's own: what is taken of each direction can
// be counted from the packets.
TEST(BusMeter, KnowsEachDirectionOfALink) {
  test::SmallScene scene;
  scene.touch();
  scene.settings.frames = 20;
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = Transfer::Method::dma;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  const auto meter_of = [&platform](link::PcieSide side) {
    const auto busy = [&platform, side] { return platform.pcie()->busy(side); };
    const auto uses = [&platform] { return platform.pcie()->uses(); };
    return BusMeter::Bus{busy, busy, uses, uses};
  };
  BusMeter to_board(meter_of(link::PcieSide::root));
  BusMeter to_host(meter_of(link::PcieSide::device));
  platform.add_observer(to_board);
  platform.add_observer(to_host);
  platform.run();
  to_board.ended();
  to_host.ended();

  // The processor's writes and what the board reads go to the board, the rest to the host; each
  // request for a read goes the other way.
  double data = 0;
  for (const BusUse& use : to_board.uses()) {
    EXPECT_GT(use.transactions, 0) << use.name;
    data += static_cast<double>(use.busy);
  }
  const auto time = static_cast<double>(to_board.time());
  EXPECT_GT((to_board.share() + to_host.share()) * time, data);
  for (const BusMeter* meter : {&to_board, &to_host}) {
    EXPECT_GT(meter->share(), 0);
    EXPECT_GE(meter->worst_share(), meter->share());
    EXPECT_LT(meter->worst_share(), 1);
  }
}

}  // namespace
}  // namespace hvp::vp::bus_meter_test
