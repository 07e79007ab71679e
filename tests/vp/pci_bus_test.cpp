#include "vp/pci/pci_bus.h"

#include <array>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/vp/expected_time.h"
#include "tests/vp/stimulus.h"

namespace hvp::vp::pci_bus_test {
namespace {

using test::kNs;
using test::Stimulus;

// 4 KiB of memory that answers at once, or holds the bus for `wait_states`.
class Memory : public sc_core::sc_module {
 public:
  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name), from_bus("from_bus") {
    from_bus.register_b_transport(this, &Memory::b_transport);
  }
  tlm_utils::simple_target_socket<Memory> from_bus;
  Picoseconds wait_states = 0;
  Picoseconds last_access = -1;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
    last_access = now_ps();
    unsigned char* word = bytes_.data() + transaction.get_address();
    if (transaction.is_write()) {
      std::memcpy(word, transaction.get_data_ptr(), transaction.get_data_length());
    } else {
      std::memcpy(transaction.get_data_ptr(), word, transaction.get_data_length());
    }
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    delay += to_sc_time(wait_states);
  }
  std::array<unsigned char, 4096> bytes_{};
};

constexpr std::uint64_t kBase = 0x4000'0000;

struct Bench {
  explicit Bench(Stimulus::Script script, bool untimed = false, const link::Pci& model = {})
      : bus("bus", model, untimed, ledger), memory("memory"), master("master", std::move(script)) {
    master.to_target.bind(bus.from_host);
    bus.attach(memory.from_bus, kBase, 4096);
  }
  Ledger ledger;
  PciBus bus;
  Memory memory;
  Stimulus master;
};

TEST(PciBus, SingleAccessesTakeLatencyOverheadAndOneDataPhase) {
  Bench bench([&](Stimulus& m) {
    const std::uint32_t written = 0x12345678;
    std::uint32_t read = 0;
    EXPECT_EQ(m.write(kBase + 8, &written, 4), tlm::TLM_OK_RESPONSE);
    // 100 ns to the bus; overhead 4, one data phase: 5 clocks of 30 ns.
    EXPECT_EQ(now_ps(), 250 * kNs);
    EXPECT_EQ(m.read(kBase + 8, &read, 4), tlm::TLM_OK_RESPONSE);
    // 700 ns; 4 and 8 clocks until the first word, one data phase.
    EXPECT_EQ(now_ps(), (250 + 700 + 13 * 30) * kNs);
    EXPECT_EQ(read, written);
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.bus.transactions(), 2);
  EXPECT_EQ(bench.bus.bytes_moved(), 8);
  EXPECT_EQ(bench.bus.busy(), (250 + 1090) * kNs);
}

TEST(PciBus, BlocksAreCutIntoBursts) {
  Bench bench([&](Stimulus& m) {
    std::array<std::uint32_t, 50> words{};
    m.write(kBase, words.data(), 200);
    // Bursts of 64, 64, 64 and 8 bytes: 4·4 clocks of overhead and 50 data phases.
    EXPECT_EQ(now_ps(), (100 + 66 * 30) * kNs);
    m.read(kBase, words.data(), 64);
    EXPECT_EQ(now_ps(), (100 + 66 * 30 + 700 + 28 * 30) * kNs);
  });
  sc_core::sc_start();
}

TEST(PciBus, WiderAndFasterBusUsesItsOwnClock) {
  link::Pci fast;
  fast.kind = link::PciKind::pci_64_66;
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint32_t, 50> words{};
        m.write(kBase, words.data(), 200);
        EXPECT_EQ(now_ps(), (100 + (4 * 4 + 25) * 15) * kNs);
      },
      false, fast);
  sc_core::sc_start();
}

TEST(PciBus, UntimedTakesNoTime) {
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint32_t, 64> words{};
        words[3] = 7;
        m.write(kBase, words.data(), sizeof(words));
        std::uint32_t read = 0;
        m.read(kBase + 12, &read, 4);
        EXPECT_EQ(now_ps(), 0);
        EXPECT_EQ(read, 7U);
      },
      true);
  sc_core::sc_start();
  EXPECT_EQ(bench.bus.busy(), 0);
}

TEST(PciBus, NobodyClaimsTheAddress) {
  Bench bench([&](Stimulus& m) {
    std::array<std::uint32_t, 2> words{};
    EXPECT_EQ(m.read(kBase - 4, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(words[0], 0xffffffffU);
    EXPECT_EQ(now_ps(), test::pci_read(4));  // a master abort takes its time too
    EXPECT_EQ(m.read(kBase + 4096, words.data(), 8), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(words[1], 0xffffffffU);
    EXPECT_EQ(m.write(kBase + 4096, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.memory.last_access, -1);
}

TEST(PciBus, TargetSeesTheAccessWhenItsLastDataPhaseIsOver) {
  Bench bench([&](Stimulus& m) {
    m.sleep(17 * kNs);
    const std::uint32_t word = 1;
    m.write(kBase, &word, 4);
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.memory.last_access, (17 + 250) * kNs);
}

TEST(PciBus, SecondMasterWaitsAndTheWaitIsItsSpan) {
  Ledger ledger;
  PciBus bus("bus", {}, false, ledger);
  Memory memory("memory");
  bus.attach(memory.from_bus, kBase, 4096);
  ledger.open(1, 0);
  ledger.open(2, 0);
  // Two masters on one socket stand for two agents: each blocks in its own process.
  Stimulus first("first", [&](Stimulus& m) {
    std::array<std::uint32_t, 16> words{};
    Tag tag{1, kBirth};
    m.write(kBase, words.data(), 64, &tag);
    EXPECT_EQ(now_ps(), (100 + 20 * 30) * kNs);
  });
  Tag late{2, kBirth};
  test::Program second("second", [&](test::Program& p) {
    p.sleep(300 * kNs);
    std::uint32_t word = 0;
    first.read(kBase, &word, 4, &late);
    EXPECT_EQ(now_ps(), (700 + 1090) * kNs);
  });
  first.to_target.bind(bus.from_host);
  sc_core::sc_start();

  const std::vector<Span>& spans = ledger.frame(2).spans;
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[0].part, Part::bus);
  EXPECT_EQ(spans[0].phase, Phase::arbitration);
  EXPECT_EQ(spans[0].start, 300 * kNs);
  EXPECT_EQ(spans[0].end, 700 * kNs);
  EXPECT_EQ(spans[0].cause, kBirth);
  EXPECT_EQ(spans[1].phase, Phase::bus_read);
  EXPECT_EQ(spans[1].start, 700 * kNs);
  EXPECT_EQ(spans[1].cause, 0);
  EXPECT_EQ(late.cause, 1);
  EXPECT_EQ(ledger.frame(1).spans.size(), 1U);
}

TEST(PciBus, WaitStatesOfATargetKeepTheBus) {
  Ledger ledger;
  PciBus bus("bus", {}, false, ledger);
  Memory memory("memory");
  memory.wait_states = 1'000 * kNs;
  bus.attach(memory.from_bus, kBase, 4096);
  Stimulus first("first", [&](Stimulus& m) {
    const std::uint32_t word = 0;
    m.write(kBase, &word, 4);
    EXPECT_EQ(now_ps(), 1'250 * kNs);
  });
  test::Program second("second", [&](test::Program& p) {
    p.sleep(300 * kNs);
    const std::uint32_t word = 0;
    first.write(kBase, &word, 4);
    EXPECT_EQ(now_ps(), (1'250 + 250 + 1'000) * kNs);
  });
  first.to_target.bind(bus.from_host);
  sc_core::sc_start();
  EXPECT_EQ(bus.busy(), 2 * 1'250 * kNs);
}

}  // namespace
}  // namespace hvp::vp::pci_bus_test
