// Who had cores and buses, and when: clocks of 33 MHz counted by hand, and what the buses say of
// their use.
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/expected_frame.h"
#include "tests/vp/recording_target.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "tests/vp/tenure_log.h"
#include "vp/pci/other_masters.h"
#include "vp/pci/pci_bus.h"
#include "vp/pcie/pcie_bus.h"
#include "vp/platform.h"

namespace hvp::vp::tenure_test {
namespace {

using test::kMs;
using test::kNs;
using test::kUs;
using test::RecordingTarget;
using test::SmallScene;
using test::Stimulus;
using test::TenureLog;

constexpr Picoseconds kClock = 30 * kNs;

void expect_tenure(const Tenure& t, std::string_view user, Phase what, std::int64_t frame,
                   Picoseconds start, Picoseconds end) {
  EXPECT_EQ(t.user, user);
  EXPECT_EQ(t.what, name(what));
  EXPECT_EQ(t.frame, frame);
  EXPECT_EQ(t.start, start);
  EXPECT_EQ(t.end, end);
}

struct Bench {
  Bench(Stimulus::Script script, const BusSettings& settings, Timing level)
      : bus("bus", settings, level, ledger), target("target"), host("host", std::move(script)) {
    host.to_target.bind(bus.from_host);
    bus.attach(target.from_bus, kSolverBase, 8'192);
    ledger.open(5, 0);
    ledger.add_tenure_sink(log);
  }

  Ledger ledger;
  TenureLog log;
  PciBus bus;
  RecordingTarget target;
  Stimulus host;
};

TEST(Tenures, LooselyTimedTheBusIsTakenForAWholeTransaction) {
  Tag tag{5, kBirth};
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint8_t, 64> block{};
        m.write(kSolverBase, block.data(), 4, &tag);
        m.read(kSolverBase, block.data(), 64);
      },
      {}, Timing::loosely_timed);
  bench.target.wait_states = 1 * kUs;
  sc_core::sc_start();
  const std::vector<Tenure>& log = bench.log.tenures;
  ASSERT_EQ(log.size(), 4U);
  const Picoseconds written = 100 * kNs + 5 * kClock;
  expect_tenure(log[0], "processor", Phase::bus_write, 5, 0, written);
  expect_tenure(log[1], "processor", Phase::bus_write, 5, written, written + 1 * kUs);
  const Picoseconds read = written + 1 * kUs + 700 * kNs + (12 + 16) * kClock;
  expect_tenure(log[2], "processor", Phase::block_read, -1, written + 1 * kUs, read);
  EXPECT_EQ(bench.log.busy(Resource::bus), bench.bus.busy());
}

TEST(Tenures, OfAPostedWriteAreTheWiresAlone) {
  Tag tag{5, kBirth};
  BusSettings settings;
  settings.posted_writes.emplace();
  Bench bench(
      [&](Stimulus& m) {
        const std::uint32_t word = 7;
        m.write(kSolverBase, &word, 4, &tag);
      },
      settings, Timing::loosely_timed);
  sc_core::sc_start();
  ASSERT_EQ(bench.log.tenures.size(), 1U);
  expect_tenure(bench.log.tenures[0], "processor", Phase::bus_write, 5, 100 * kNs,
                100 * kNs + 5 * kClock);
}

// 100 ns to the bus, the edge at 120, one clock of arbitration. Bursts of 16 words: an address
// phase, its decoding, and a turnaround. The next one is asked for when the bus is released.
TEST(Tenures, ApproximatelyTimedItIsTakenBurstByBurst) {
  Tag tag{5, kBirth};
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint8_t, 80> block{};
        m.write(kSolverBase, block.data(), 80, &tag);
      },
      {}, Timing::approximately_timed);
  bench.target.wait_states = 60 * kNs;
  sc_core::sc_start();
  const std::vector<Tenure>& log = bench.log.tenures;
  ASSERT_EQ(log.size(), 3U);
  const Picoseconds first = 120 * kNs + kClock;
  expect_tenure(log[0], "processor", Phase::block_write, 5, first, first + 19 * kClock);
  const Picoseconds second = first + 20 * kClock;
  expect_tenure(log[1], "processor", Phase::block_write, 5, second, second + 7 * kClock);
  // The target's two clocks.
  expect_tenure(log[2], "processor", Phase::block_write, 5, second + 7 * kClock,
                second + 9 * kClock);
  EXPECT_EQ(bench.log.busy(Resource::bus), bench.bus.busy());
}

TEST(Tenures, OfSeveralMastersAddUpToTheirUse) {
  BusTraffic traffic;
  traffic.period_s = 10e-6;
  traffic.bytes = 300;
  Tag tag{5, kBirth};
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint8_t, 2'000> block{};
        for (int i = 0; i < 5; ++i) m.read(kSolverBase, block.data(), block.size(), &tag);
        sc_core::sc_stop();
      },
      {}, Timing::approximately_timed);
  TrafficMaster other("other", traffic, bench.bus);
  sc_core::sc_start();
  bench.log.expect_no_overlap();
  for (const BusUse& use : bench.bus.uses()) {
    Picoseconds sum = 0;
    for (const Tenure& t : bench.log.tenures) sum += t.user == use.name ? t.end - t.start : 0;
    EXPECT_EQ(sum, use.busy) << use.name;
  }
  for (const Tenure& t : bench.log.tenures) {
    EXPECT_EQ(t.frame, t.user == "traffic" ? -1 : 5);
    EXPECT_EQ(t.what, name(t.user == "traffic" ? Phase::dma_write : Phase::block_read));
  }
  EXPECT_GT(other.blocks(), 10);
}

// A platform's run with its tenures.
struct Audited {
  explicit Audited(SmallScene& scene)
      : platform(scene.settings, scene.body, scene.computation, scene.contacts) {
    platform.add_observer(frames);
    platform.add_tenure_sink(log);
    platform.run();
    log.expect_no_overlap();
    EXPECT_EQ(log.busy(Resource::bus), platform.bus().busy());
  }
  // A frame's spans on the host's processor lie in the servo process' time on its core.
  void expect_host_on_its_core() const {
    const std::vector<Tenure> core = log.of(Resource::core_0);
    for (const Frame& frame : frames.frames) {
      for (const Span& s : frame.spans) {
        if (s.part != Part::host || waits(s.phase) || s.start == s.end) continue;
        EXPECT_TRUE(std::ranges::any_of(core,
                                        [&s](const Tenure& t) {
                                          return t.user == "servo process" && t.start <= s.start &&
                                                 s.end <= t.end;
                                        }))
            << name(s.phase) << " of frame " << frame.number;
      }
    }
  }
  static bool waits(Phase phase) {
    return phase == Phase::release || phase == Phase::wake_up || phase == Phase::blocked ||
           phase == Phase::wait || phase == Phase::interrupt || phase == Phase::pipeline;
  }

  test::FrameLog frames;
  TenureLog log;
  Platform platform;
};

TEST(Tenures, OfTwoCoresAreTheServosRunsAndThePasses) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 40;
  const Audited run(scene);
  run.expect_host_on_its_core();
  const std::vector<Tenure> passes = run.log.of(Resource::core_1);
  ASSERT_EQ(static_cast<std::int64_t>(passes.size()), run.platform.collision()->passes());
  Picoseconds longest = 0;
  for (const Tenure& t : passes) {
    EXPECT_EQ(t.what, "collision pass");
    longest = std::max(longest, t.end - t.start);
  }
  EXPECT_EQ(longest, run.platform.collision()->longest_pass());
  EXPECT_EQ(passes[0].start, run.platform.session().begin);
  // Set-up is the first thing that core 0 does, and from the tick to the job's start the second.
  const std::vector<Tenure> servo = run.log.of(Resource::core_0);
  EXPECT_EQ(servo.front().what, "set-up");
  EXPECT_EQ(servo.front().start, 0);
  const auto first = std::ranges::find(servo, 0, &Tenure::frame);
  ASSERT_NE(first, servo.end());
  EXPECT_EQ(first->start, run.platform.session().begin);
}

TEST(Tenures, OfOneCoreAreThePiecesOfPassesAndTheSwitches) {
  SmallScene scene;
  scene.settings.host.cores = 1;
  scene.settings.host.graphics.drawing_s = 10e-3;
  scene.settings.host.graphics.non_preemptible_s = 100e-6;
  scene.settings.host.graphics.non_preemptible_every_s = 1e-3;
  const Audited run(scene);
  run.expect_host_on_its_core();
  EXPECT_TRUE(run.log.of(Resource::core_1).empty());
  Picoseconds worked = 0;
  for (const Tenure& t : run.log.of(Resource::core_0)) {
    if (t.what == "collision pass") worked += t.end - t.start;
    if (t.what != name(Phase::context_switch)) continue;
    EXPECT_LE(t.end - t.start, 3'800'000);
  }
  // The pass that is over has had its own time, in pieces; the run ends before the next.
  ASSERT_EQ(run.platform.collision()->passes(), 1);
  EXPECT_EQ(worked, test::compute(scene.contacts.pass_flops()) + 10 * kMs);
}

TEST(Tenures, OfPipelinedFramesToo) {
  SmallScene scene;
  scene.settings.host.pipeline_depth = 1;
  scene.settings.budget = 2 * scene.settings.period;
  const Audited run(scene);
  run.expect_host_on_its_core();
}

TEST(Tenures, OfALinkAreItsPackets) {
  SmallScene scene;
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = Transfer::Method::dma;
  const Audited run(scene);
  for (const auto& [resource, side] : {std::pair(Resource::link_to_board, link::PcieSide::root),
                                       std::pair(Resource::link_to_host, link::PcieSide::device)}) {
    EXPECT_EQ(run.log.busy(resource), run.platform.pcie()->busy(side));
    EXPECT_GT(run.log.busy(resource), 0);
  }
}

TEST(Tenures, OfALinkPacketByPacketToo) {
  SmallScene scene;
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = Transfer::Method::dma;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  const Audited run(scene);
  for (const auto& [resource, side] : {std::pair(Resource::link_to_board, link::PcieSide::root),
                                       std::pair(Resource::link_to_host, link::PcieSide::device)}) {
    EXPECT_EQ(run.log.busy(resource), run.platform.pcie()->busy(side));
    EXPECT_GT(run.log.busy(resource), 0);
  }
  // The board's reads: requests one way, their completions the other.
  const auto reads = [&run](Resource resource) {
    return std::ranges::count(run.log.of(resource), name(Phase::dma_read), &Tenure::what);
  };
  EXPECT_EQ(reads(Resource::link_to_host), 10);
  EXPECT_GE(reads(Resource::link_to_board), 10);
}

}  // namespace
}  // namespace hvp::vp::tenure_test
