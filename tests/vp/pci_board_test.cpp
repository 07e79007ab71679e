// The board as master of the PCI bus: clocks of 33 MHz counted by hand.
#include <array>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/stimulus.h"
#include "vp/bus/host_memory.h"
#include "vp/pci/other_masters.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp::pci_board_test {
namespace {

using test::kNs;
using test::kUs;
using test::LineProbe;
using test::Stimulus;

constexpr std::uint64_t kBuffer = 0x1000;
// A clock of 33 MHz. A burst of 64 bytes has 4 clocks of overhead; a read waits for 8 more.
constexpr Picoseconds kClock = 30 * kNs;
constexpr std::int64_t kWrite3000 = 47 * 4 + 750;
constexpr std::int64_t kRead3000 = 47 * 12 + 750;

// A board and a host's memory; the processor does nothing.
struct Bench {
  explicit Bench(Stimulus::Script script, Timing level = Timing::loosely_timed)
      : bus("bus", BusSettings{}, level, ledger),
        memory("memory", 16'384),
        target("target", 64),
        line("line"),
        board("board", std::move(script)),
        host("host", [](Stimulus&) {}) {
    board.to_target.bind(bus.from_board);
    host.to_target.bind(bus.from_host);
    bus.attach(target.from_bus, 0x4000'0000, 64);
    bus.attach_memory(memory.from_bus);
    memory.interrupt.bind(line);
    ledger.open(0, 0);
  }
  BusUse use(PciBus::Master master) const { return bus.uses()[static_cast<std::size_t>(master)]; }
  const std::vector<Span>& spans() { return ledger.frame(0).spans; }

  Ledger ledger;
  PciBus bus;
  HostMemory memory;
  HostMemory target;
  LineProbe line;
  Stimulus board;
  Stimulus host;
};

TEST(PciBoard, ReadsAndWritesTheHostsMemoryInTheWiresTimeAlone) {
  std::array<std::uint8_t, 3'000> words{};
  words[2'999] = 42;
  Tag tag{0, kBirth};
  Bench bench([&](Stimulus& m) {
    EXPECT_EQ(m.write(kBuffer, words.data(), words.size(), &tag), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), kWrite3000 * kClock);
    words.fill(0);
    EXPECT_EQ(m.read(kBuffer, words.data(), words.size(), &tag), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), (kWrite3000 + kRead3000) * kClock);
    EXPECT_EQ(words[2'999], 42);
  });
  sc_core::sc_start();
  ASSERT_EQ(bench.spans().size(), 2U);
  EXPECT_EQ(bench.spans()[0].phase, Phase::dma_write);
  EXPECT_EQ(bench.spans()[1].phase, Phase::dma_read);
  EXPECT_EQ(bench.spans()[1].cause, 0);
  EXPECT_EQ(bench.use(PciBus::kBoard).busy, (kWrite3000 + kRead3000) * kClock);
  EXPECT_EQ(bench.use(PciBus::kBoard).bytes, 6'000);
  EXPECT_EQ(bench.use(PciBus::kBoard).transactions, 2);
  EXPECT_EQ(bench.use(PciBus::kProcessor).transactions, 0);
  EXPECT_EQ(bench.bus.busy(), (kWrite3000 + kRead3000) * kClock);
}

TEST(PciBoard, AMessageIsAWriteThatTheHostHearsWhenItsDataPhaseIsOver) {
  Tag tag{0, kBirth};
  Bench bench([&](Stimulus& m) {
    const std::uint32_t vector = 1;
    m.write(kMessageAddress, &vector, 4, &tag);
  });
  sc_core::sc_start();
  ASSERT_EQ(bench.line.up, (std::vector<Picoseconds>{5 * kClock}));
  ASSERT_EQ(bench.spans().size(), 1U);
  EXPECT_EQ(bench.spans()[0].phase, Phase::message);
  // Who hears it follows that span.
  EXPECT_EQ(bench.line.tags[0].frame, 0);
  EXPECT_EQ(bench.line.tags[0].cause, 0);
}

TEST(PciBoard, ATransactionMaySayWhatItIsFor) {
  Tag tag{0, kBirth};
  Bench bench([&](Stimulus& m) {
    std::array<std::uint8_t, 32> descriptor{};
    m.read_as(Phase::descriptor, kBuffer, descriptor.data(), descriptor.size(), &tag);
    EXPECT_EQ(now_ps(), (12 + 8) * kClock);
  });
  sc_core::sc_start();
  ASSERT_EQ(bench.spans().size(), 1U);
  EXPECT_EQ(bench.spans()[0].phase, Phase::descriptor);
}

TEST(PciBoard, WithoutMemoryItIsAMasterAbort) {
  Ledger ledger;
  PciBus bus("bus", BusSettings{}, Timing::loosely_timed, ledger);
  HostMemory target("target", 64);
  bus.attach(target.from_bus, 0x4000'0000, 64);
  Stimulus host("host", [](Stimulus&) {});
  Stimulus board("board", [](Stimulus& m) {
    std::uint32_t word = 0;
    EXPECT_EQ(m.read(0, &word, 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(word, 0xffffffffU);
    EXPECT_EQ(now_ps(), 13 * kClock);
    EXPECT_EQ(m.write(0, &word, 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  });
  host.to_target.bind(bus.from_host);
  board.to_target.bind(bus.from_board);
  sc_core::sc_start();
}

TEST(PciBoard, TheProcessorWaitsForTheBoardsTransactionUnderWay) {
  Tag tag{0, kBirth};
  Bench bench([&](Stimulus& m) {
    std::array<std::uint8_t, 3'000> words{};
    m.write(kBuffer, words.data(), words.size());
  });
  test::Program processor("processor", [&](test::Program& p) {
    p.sleep(20 * kNs);
    const std::uint32_t word = 0;
    bench.host.write(0x4000'0000, &word, 4, &tag);
    EXPECT_EQ(now_ps(), kWrite3000 * kClock + 250 * kNs);
  });
  sc_core::sc_start();
  ASSERT_EQ(bench.spans().size(), 2U);
  EXPECT_EQ(bench.spans()[0].phase, Phase::arbitration);
  EXPECT_EQ(bench.spans()[0].end, kWrite3000 * kClock);
}

// The kernel runs the board first: it was built first.
TEST(PciBoard, OfTwoWhoAskAtOneInstantTheProcessorIsServedFirst) {
  std::vector<Picoseconds> ended;
  Bench bench([&](Stimulus& m) {
    std::array<std::uint8_t, 64> words{};
    m.sleep_until(1 * kUs);
    m.write(kBuffer, words.data(), words.size());
    ended.push_back(now_ps());
    m.write(kBuffer, words.data(), words.size());
    ended.push_back(now_ps());
  });
  test::Program processor("processor", [&](test::Program& p) {
    const std::uint32_t word = 0;
    p.sleep(1 * kUs);
    bench.host.write(0x4000'0000, &word, 4);
    EXPECT_EQ(now_ps(), 1 * kUs + 250 * kNs);
    // It waits with the board's next one, for the bus to be free.
    p.sleep(1 * kNs);
    bench.host.write(0x4000'0000, &word, 4);
    EXPECT_EQ(now_ps(), 1 * kUs + 250 * kNs + 20 * kClock + 250 * kNs);
  });
  sc_core::sc_start();
  const std::vector<Picoseconds> expected = {1 * kUs + 250 * kNs + 20 * kClock,
                                             1 * kUs + 500 * kNs + 40 * kClock};
  EXPECT_EQ(ended, expected);
}

TEST(PciBoard, ApproximatelyTimedItIsMasterNumberTwo) {
  Tag tag{0, kBirth};
  Bench bench(
      [&](Stimulus& m) {
        m.sleep(10 * kNs);  // seen at the edge of 30 ns
        std::array<std::uint8_t, 3'000> words{};
        m.write(kBuffer, words.data(), words.size(), &tag);
        // Alone, from that edge on.
        EXPECT_EQ(now_ps(), (1 + kWrite3000) * kClock);
        m.sleep_until(40 * kUs);  // 1333 clocks and a third
        m.read(kBuffer, words.data(), words.size(), &tag);
        EXPECT_EQ(now_ps(), (1'334 + kRead3000) * kClock);
      },
      Timing::approximately_timed);
  sc_core::sc_start();
  ASSERT_EQ(bench.spans().size(), 4U);
  EXPECT_EQ(bench.spans()[0].phase, Phase::arbitration);  // until the edge
  EXPECT_EQ(bench.spans()[0].end - bench.spans()[0].start, 20 * kNs);
  EXPECT_EQ(bench.spans()[1].phase, Phase::dma_write);
  // Owned: all but arbitration, a clock a burst.
  EXPECT_EQ(bench.use(PciBus::kBoard).busy, (kWrite3000 + kRead3000 - 2 * 47) * kClock);
  EXPECT_EQ(bench.use(PciBus::kBoard).bytes, 6'000);
}

TEST(PciBoard, TheProcessorGetsTheBusBetweenTwoBurstsOfADma) {
  Tag tag{0, kBirth};
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint8_t, 3'000> words{};
        m.write(kBuffer, words.data(), words.size());
        // The word owns the bus for four clocks, behind which the next burst's clock of arbitration
        // is hidden.
        EXPECT_EQ(now_ps(), (kWrite3000 + 4 - 1) * kClock);
      },
      Timing::approximately_timed);
  test::Program processor("processor", [&](test::Program& p) {
    p.sleep(20 * kNs);
    const std::uint32_t word = 0;
    bench.host.write(0x4000'0000, &word, 4, &tag);
    // At the bus at 120 ns. The DMA's first burst: address 1, words 3 to 18, free at 20. The word:
    // address 20, decoding 21, data 22, turnaround 23.
    EXPECT_EQ(now_ps(), 24 * kClock);
  });
  sc_core::sc_start();
}

}  // namespace
}  // namespace hvp::vp::pci_board_test
