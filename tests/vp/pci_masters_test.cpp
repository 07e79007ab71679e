// The approximately-timed bus: clocks of 33 MHz counted by hand, and what a second master does.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/pci/other_masters.h"
#include "vp/platform.h"

namespace hvp::vp::pci_masters_test {
namespace {

using test::kNs;
using test::kUs;
using test::SmallScene;
using test::Stimulus;

constexpr std::uint64_t kBase = 0x4000'0000;

class Memory : public sc_core::sc_module {
 public:
  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name), from_bus("from_bus") {
    from_bus.register_b_transport(this, &Memory::b_transport);
  }
  tlm_utils::simple_target_socket<Memory> from_bus;
  Picoseconds wait_states = 0;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
    if (transaction.is_read()) {
      std::memset(transaction.get_data_ptr(), 0, transaction.get_data_length());
    }
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    delay += to_sc_time(wait_states);
  }
};

struct Bench {
  explicit Bench(Stimulus::Script script, const BusSettings& settings = {})
      : bus("bus", settings, Timing::approximately_timed, ledger),
        memory("memory"),
        master("master", std::move(script)) {
    master.to_target.bind(bus.from_host);
    bus.attach(memory.from_bus, kBase, 4096);
    ledger.open(0, 0);
  }
  Ledger ledger;
  PciBus bus;
  Memory memory;
  Stimulus master;
};

TEST(PciMasters, AloneItIsTheLooselyTimedBusFromTheNextEdgeOn) {
  Bench bench([](Stimulus& m) {
    std::array<std::uint32_t, 750> words{};
    m.write(kBase, words.data(), 4);
    // 100 ns to the bus, the edge at 120 ns, five clocks.
    EXPECT_EQ(now_ps(), (120 + 5 * 30) * kNs);
    m.sleep_until(1'020 * kNs);
    m.read(kBase, words.data(), 4);
    // 700 ns: 1720, the edge at 1740, 13 clocks.
    EXPECT_EQ(now_ps(), (1'740 + 13 * 30) * kNs);
    m.sleep_until(3'020 * kNs);
    m.write(kBase, words.data(), 3'000);
    // At 3120 ns, on an edge: 47 bursts of four clocks more than their words.
    EXPECT_EQ(now_ps(), (3'120 + (47 * 4 + 750) * 30) * kNs);
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.bus.transactions(), 3);
  // Owned: all but arbitration, a clock a burst.
  EXPECT_EQ(bench.bus.busy(), (4 + 12 + 47 * 3 + 750) * 30 * kNs);
}

TEST(PciMasters, WordWaitsForTheBurstUnderWayAndTheLedgerSaysSo) {
  BusTraffic traffic;
  traffic.bytes = 256;
  Tag tag{0, kBirth};
  Bench bench([&tag](Stimulus& m) {
    // On the bus at 120 ns, edge 4; the traffic's first burst, asked at 0, has its address at
    // clock 1, 16 words from 3 to 18, and releases the bus at 20.
    m.sleep_until(20 * kNs);
    const std::uint32_t word = 0;
    m.write(kBase, &word, 4, &tag);
    // Address 20, decoding, word, turnaround: free at 24.
    EXPECT_EQ(now_ps(), 24 * 30 * kNs);
  });
  TrafficMaster other("traffic", traffic, bench.bus);
  sc_core::sc_start(to_sc_time(100 * kUs));
  EXPECT_EQ(other.blocks(), 1);
  const std::vector<Span>& spans = bench.ledger.frame(0).spans;
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[0].phase, Phase::arbitration);
  EXPECT_EQ(spans[0].start, 20 * kNs);
  // Alone it would have taken 100 ns and five clocks.
  EXPECT_EQ(spans[0].end - spans[0].start, (24 * 30 - 20 - 250) * kNs);
  EXPECT_EQ(spans[1].phase, Phase::bus_write);
  EXPECT_EQ(spans[1].end, 24 * 30 * kNs);
  EXPECT_EQ(spans[1].cause, 0);
}

TEST(PciMasters, LatencyTimerEndsALongBurst) {
  BusSettings settings;
  settings.pci.burst_bytes = 4'096;
  settings.protocol.emplace();
  settings.protocol->latency_timer_clocks = 8;
  BusTraffic traffic;
  traffic.bytes = 400;
  Bench bench(
      [](Stimulus& m) {
        m.sleep_until(200 * kNs);  // on the bus at 300 ns, edge 10
        const std::uint32_t word = 0;
        m.write(kBase, &word, 4);
        // As tests/link/pci_arbiter_test.cpp counts it: the word is over at edge 17.
        EXPECT_EQ(now_ps(), 17 * 30 * kNs);
      },
      settings);
  TrafficMaster other("traffic", traffic, bench.bus);
  sc_core::sc_start(to_sc_time(100 * kUs));
}

TEST(PciMasters, WaitStatesOfATargetKeepOthersOut) {
  BusTraffic traffic;
  traffic.start_s = 150e-9;
  traffic.bytes = 4;
  Bench bench([](Stimulus& m) {
    m.sleep_until(20 * kNs);
    const std::uint32_t word = 0;
    m.write(kBase, &word, 4);
    EXPECT_EQ(now_ps(), (270 + 1'000) * kNs);
  });
  bench.memory.wait_states = 1'000 * kNs;
  TrafficMaster other("traffic", traffic, bench.bus);
  // Asked at 150 ns; the bus is free at 1270 ns, the edge after it at 1290; four clocks.
  sc_core::sc_start(to_sc_time((1'290 + 4 * 30) * kNs - 1));
  EXPECT_EQ(other.blocks(), 0);
  sc_core::sc_start(to_sc_time(1));
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  EXPECT_EQ(other.blocks(), 1);
}

TEST(PciMasters, BlockThatIsDueDuringTheLastOneIsLeftOut) {
  BusTraffic traffic;
  traffic.period_s = 10e-6;
  traffic.bytes = 3'000;  // 28 us
  Bench bench([](Stimulus&) {});
  TrafficMaster other("traffic", traffic, bench.bus);
  sc_core::sc_start(to_sc_time(89 * kUs));
  // At 0, 30 and 60 us.
  EXPECT_EQ(other.blocks(), 3);
  EXPECT_EQ(other.left_out(), 6);
}

// The longest that a transaction of any frame has waited for the bus.
struct LongestWait : FrameObserver {
  void closed(const Frame& frame, const CriticalPath& /*critical_path*/) override {
    ++frames;
    for (const Span& span : frame.spans) {
      if (span.phase == Phase::arbitration) time = std::max(time, span.end - span.start);
    }
  }
  int frames = 0;
  Picoseconds time = 0;
};

TEST(PciMasters, AloneAFramesTransactionsWaitForTheClocksEdgeOnly) {
  SmallScene scene;
  scene.settings.frames = 20;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(platform.traffic(), nullptr);
  EXPECT_EQ(Platform::processes(), 3U);
  LongestWait wait;
  platform.add_observer(wait);
  platform.run();
  EXPECT_EQ(wait.frames, 20);
  EXPECT_GT(wait.time, 0);
  EXPECT_LT(wait.time, 30 * kNs);
}

TEST(PciMasters, TrafficIsAModuleAndAProcessOfItsOwnAndIsWaitedFor) {
  SmallScene scene;
  scene.settings.frames = 20;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.traffic.emplace();
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::processes(), 4U);
  LongestWait wait;
  platform.add_observer(wait);
  platform.run();
  EXPECT_GT(platform.traffic()->blocks(), 300);  // 20 frames of 2 ms, a block each 123 us
  EXPECT_GT(wait.time, 30 * kNs);
}

}  // namespace
}  // namespace hvp::vp::pci_masters_test
