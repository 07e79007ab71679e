// The link as a module: against models/link's Cost without contention, the order of what passes it,
// and the platform with the solver board on it.
#include "vp/pcie/pcie_bus.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/link/interconnect.h"
#include "tests/vp/path_of.h"
#include "tests/vp/recording_target.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/bus/host_memory.h"
#include "vp/platform.h"

namespace hvp::vp::pcie_bus_test {
namespace {

using link::PcieGeneration;
using test::kNs;
using test::kUs;
using test::LineProbe;
using test::RecordingTarget;
using test::SmallScene;
using test::Stimulus;

constexpr std::array<PcieGeneration, 6> kGenerations = {PcieGeneration::gen1, PcieGeneration::gen2,
                                                        PcieGeneration::gen3, PcieGeneration::gen4,
                                                        PcieGeneration::gen5, PcieGeneration::gen6};

link::Pcie wire(PcieGeneration generation = PcieGeneration::gen3, int lanes = 4) {
  link::Pcie pcie;
  pcie.generation = generation;
  pcie.lanes = lanes;
  return pcie;
}

// A link with a board's registers on one side and the host's memory on the other.
struct Bench {
  Bench(const std::string& tail, const link::Pcie& pcie, Timing level, Stimulus::Script processor,
        Stimulus::Script master)
      : link(("link" + tail).c_str(), pcie, level, ledger),
        registers(("registers" + tail).c_str()),
        memory(("memory" + tail).c_str()),
        line(("line" + tail).c_str()),
        host(("host" + tail).c_str(), std::move(processor)),
        board(("board" + tail).c_str(), std::move(master)) {
    host.to_target.bind(link.from_host);
    board.to_target.bind(link.from_board);
    link.attach(registers.from_bus, kSolverBase, 8'192);
    link.attach_memory(memory.from_bus);
    link.interrupt_line.bind(line);
    ledger.open(0, 0);
  }
  const std::vector<Span>& spans() { return ledger.frame(0).spans; }

  Ledger ledger;
  PcieBus link;
  RecordingTarget registers;
  RecordingTarget memory;
  LineProbe line;
  Stimulus host;
  Stimulus board;
};

void idle(Stimulus& /*m*/) {}

// The mean of so many transfers of a kind with rests between them, from their begin until their
// data are where they go: a DLLP stands before one packet and not before the next. Of a processor's
// loads so many words.
constexpr int kTransfers = 400;
constexpr Picoseconds kRest = 20 * kUs;
int blocks_of_loads(int bytes) { return std::max(1, 4 * kTransfers / bytes); }

struct Times {
  Picoseconds processor_write = 0;
  Picoseconds processor_busy = 0;
  Picoseconds processor_read = 0;
  Picoseconds dma_write = 0;
  Picoseconds dma_read = 0;
};

class Transfers {
 public:
  Transfers(int number, const link::Pcie& pcie, Timing level, int bytes)
      : bytes_(bytes),
        bench_(
            "_" + std::to_string(number), pcie, level, [this](Stimulus& m) { processor(m); },
            [this](Stimulus& m) { board(m); }) {}
  Times means() const {
    const auto mean = [](Picoseconds sum) { return sum / kTransfers; };
    return {mean(sums_.processor_write), mean(sums_.processor_busy),
            sums_.processor_read / blocks_of_loads(bytes_), mean(sums_.dma_write),
            mean(sums_.dma_read)};
  }

 private:
  void processor(Stimulus& m) {
    std::vector<std::uint8_t> block(static_cast<std::size_t>(bytes_));
    for (int k = 0; k < kTransfers; ++k) {
      const Picoseconds began = now_ps();
      m.write(kSolverBase, block.data(), block.size());
      sums_.processor_busy += now_ps() - began;
      m.sleep(kRest);
      sums_.processor_write += bench_.registers.accesses.back().time - began;
    }
    for (int k = 0; k < blocks_of_loads(bytes_); ++k) {
      const Picoseconds began = now_ps();
      m.read(kSolverBase, block.data(), block.size());
      sums_.processor_read += now_ps() - began;
      m.sleep(kRest);
    }
    over_ = true;
    done_.notify();
  }
  // When the processor is done: alone on the link.
  void board(Stimulus& m) {
    std::vector<std::uint8_t> block(static_cast<std::size_t>(bytes_));
    while (!over_) sc_core::wait(done_);
    for (int k = 0; k < kTransfers; ++k) {
      const Picoseconds began = now_ps();
      m.write(64, block.data(), block.size());
      m.sleep(kRest);
      sums_.dma_write += bench_.memory.accesses.back().time - began;
    }
    for (int k = 0; k < kTransfers; ++k) {
      const Picoseconds began = now_ps();
      m.read(64, block.data(), block.size());
      sums_.dma_read += now_ps() - began;
      m.sleep(kRest);
    }
  }

  int bytes_;
  Times sums_;
  bool over_ = false;
  sc_core::sc_event done_;
  Bench bench_;
};

// Sizes, generations, widths and directions, each level against the closed forms.
void expect_formulas(Timing level, double relative) {
  struct Case {
    link::Pcie pcie;
    int bytes;
    std::unique_ptr<Transfers> transfers;
  };
  std::vector<Case> cases;
  for (const PcieGeneration generation : kGenerations) {
    for (const int lanes : {1, 4, 16}) {
      for (const int bytes : {4, 64, 1'500, 3'000}) {
        cases.push_back({wire(generation, lanes), bytes, nullptr});
      }
    }
  }
  for (std::size_t i = 0; i < cases.size(); ++i) {
    cases[i].transfers =
        std::make_unique<Transfers>(static_cast<int>(i), cases[i].pcie, level, cases[i].bytes);
  }
  sc_core::sc_start();
  for (const Case& c : cases) {
    const link::PcieInterconnect formulas(c.pcie);
    const Times times = c.transfers->means();
    const auto near = [&](Picoseconds time, Picoseconds formula, const char* what) {
      EXPECT_NEAR(static_cast<double>(time) / static_cast<double>(formula), 1, relative)
          << what << ", " << c.bytes << " bytes, gen" << 1 + static_cast<int>(c.pcie.generation)
          << " x" << c.pcie.lanes;
    };
    near(times.processor_write, formulas.processor_write(c.bytes, true).latency_ps, "store");
    near(times.processor_busy, formulas.processor_write(c.bytes, true).processor_ps, "processor");
    near(times.processor_read, formulas.processor_read(c.bytes).latency_ps, "load");
    near(times.dma_write, formulas.dma_write(c.bytes).latency_ps, "DMA write");
    near(times.dma_read, formulas.dma_read(c.bytes).latency_ps, "DMA read");
  }
}

TEST(PcieBus, LooselyTimedItTakesTheFormulasTime) { expect_formulas(Timing::loosely_timed, 1e-5); }

TEST(PcieBus, ApproximatelyTimedWithinAPercent) {
  expect_formulas(Timing::approximately_timed, 0.01);
}

TEST(PcieBus, UntimedTakesNone) {
  Bench bench(
      "", wire(), Timing::untimed,
      [](Stimulus& m) {
        std::uint32_t word = 5;
        m.write(kSolverBase + 8, &word, 4);
        word = 0;
        m.read(kSolverBase + 8, &word, 4);
        EXPECT_EQ(word, 5U) << "a read is behind the write before it";
        EXPECT_EQ(now_ps(), 0);
      },
      idle);
  sc_core::sc_start();
}

class PcieBusAt : public testing::TestWithParam<Timing> {};
INSTANTIATE_TEST_SUITE_P(Level, PcieBusAt,
                         testing::Values(Timing::loosely_timed, Timing::approximately_timed),
                         [](const auto& level) {
                           return level.param == Timing::loosely_timed ? "loosely" : "packets";
                         });

TEST_P(PcieBusAt, StoresAreAWriteGapApartForTheProcessorAndKeepTheirOrder) {
  Bench bench(
      "", wire(), GetParam(),
      [](Stimulus& m) {
        for (std::uint32_t i = 0; i < 100; ++i) m.write(kSolverBase + 4 * i, &i, 4);
        EXPECT_EQ(now_ps(), 100 * 100 * kNs);
      },
      idle);
  sc_core::sc_start();
  ASSERT_EQ(bench.registers.accesses.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(bench.registers.accesses[i].address, 4 * i);
    // 150 ns to the port, the packet of 28 bytes, 125 ns of the link: a picosecond or a DLLP apart.
    const Picoseconds alone = link::PcieInterconnect(wire()).processor_write(4, false).latency_ps;
    EXPECT_NEAR(static_cast<double>(bench.registers.accesses[i].time),
                static_cast<double>(static_cast<Picoseconds>(i) * 100 * kNs + alone), 6e3);
  }
}

TEST_P(PcieBusAt, AReadIsAnsweredWithWhatTheTargetHoldsWhenItsRequestIsThere) {
  const link::Pcie pcie = wire();
  Bench bench(
      "", pcie, GetParam(),
      [](Stimulus& m) {
        std::uint32_t word = 0;
        m.read(kSolverBase, &word, 4);
        EXPECT_EQ(word, 0U) << "what came after the request is not in the answer";
      },
      idle);
  // The request is there after 150 ns, its 24 bytes and 125 ns; the answer 300 ns later and more.
  test::Program later("later", [&](test::Program& p) {
    p.sleep(320 * kNs);
    bench.registers.bytes[0] = 9;
  });
  sc_core::sc_start();
  const Picoseconds arrival =
      150 * kNs + pcie.transfer_ps(pcie.read_header_bytes()) + pcie.link_ps();
  ASSERT_EQ(bench.registers.accesses.size(), 1U);
  EXPECT_NEAR(static_cast<double>(bench.registers.accesses[0].time), static_cast<double>(arrival),
              1e3);
}

TEST_P(PcieBusAt, AReadStaysBehindThePostedWrites) {
  Bench bench(
      "", wire(), GetParam(),
      [](Stimulus& m) {
        std::array<std::uint8_t, 2'048> block{};
        block[2'047] = 3;
        m.write(kSolverBase, block.data(), block.size());
        std::uint32_t word = 0;
        m.read(kSolverBase + 2'044, &word, 4);
        EXPECT_EQ(word, 0x0300'0000U);
      },
      idle);
  bench.registers.wait_states = 5 * kUs;
  sc_core::sc_start();
  ASSERT_EQ(bench.registers.accesses.size(), 2U);
  EXPECT_EQ(bench.registers.accesses[1].time, bench.registers.accesses[0].time + 5 * kUs);
}

TEST_P(PcieBusAt, AnAnswerPushesTheBoardsWritesAheadOfItself) {
  Bench* b = nullptr;
  Bench bench(
      "", wire(PcieGeneration::gen1, 1), GetParam(),
      [&](Stimulus& m) {
        m.sleep(1 * kUs);
        std::uint32_t word = 0;
        m.read(kSolverBase, &word, 4);
        EXPECT_EQ(b->memory.bytes[4'000], 7) << "3000 bytes on Gen1 x1 need 13.7 us";
        EXPECT_GT(now_ps(), 13 * kUs);
      },
      [](Stimulus& m) {
        std::array<std::uint8_t, 3'000> block{};
        block.back() = 7;
        m.write(1'001, block.data(), block.size());
      });
  b = &bench;
  sc_core::sc_start();
}

TEST_P(PcieBusAt, ALineIsAMessageBehindTheDataThatItAnnounces) {
  Tag tag{0, kBirth};
  Bench* b = nullptr;
  Bench bench("", wire(PcieGeneration::gen1, 1), GetParam(), idle, [&](Stimulus& m) {
    std::array<std::uint8_t, 3'000> block{};
    m.write(1'000, block.data(), block.size(), &tag);
    b->link.interrupt(tag);
    b->link.lowered();
  });
  b = &bench;
  sc_core::sc_start();
  ASSERT_EQ(bench.line.up.size(), 1U);
  ASSERT_EQ(bench.line.down.size(), 1U);
  EXPECT_GT(bench.line.up[0], bench.memory.accesses.at(0).time);
  EXPECT_GT(bench.line.down[0], bench.line.up[0]);
  // Who hears it follows the message, the message the data.
  const std::vector<Span>& spans = bench.spans();
  const Span& message = spans.at(static_cast<std::size_t>(bench.line.tags[0].cause));
  EXPECT_EQ(message.phase, Phase::message);
  EXPECT_EQ(message.end, bench.line.up[0]);
  Frame& frame = bench.ledger.frame(0);
  frame.force_at_motor = bench.line.tags[0].cause;
  EXPECT_NO_THROW(critical_path(frame));
}

TEST_P(PcieBusAt, AMessageSignalledInterruptIsAWriteBehindTheData) {
  Ledger ledger;
  PcieBus link("link", wire(), GetParam(), ledger);
  HostMemory memory("memory", 4'096);
  RecordingTarget registers("registers");
  LineProbe line("line");
  ledger.open(0, 0);
  Tag tag{0, kBirth};
  Stimulus host("host", idle);
  Stimulus board("board", [&](Stimulus& m) {
    std::array<std::uint8_t, 3'000> block{};
    m.write(0, block.data(), block.size(), &tag);
    const std::uint32_t vector = 1;
    m.write(kMessageAddress, &vector, 4, &tag);
  });
  host.to_target.bind(link.from_host);
  board.to_target.bind(link.from_board);
  link.attach(registers.from_bus, kSolverBase, 8'192);
  link.attach_memory(memory.from_bus);
  memory.interrupt.bind(line);
  sc_core::sc_start();
  ASSERT_EQ(line.up.size(), 1U);
  // Back to back on the wire, and one way through the link.
  const link::Pcie p = wire();
  EXPECT_NEAR(static_cast<double>(line.up[0]),
              static_cast<double>(p.tlp_ps(p.write_wire_bytes(3'000) + p.write_wire_bytes(4)) +
                                  p.link_ps()),
              10e3);
  Frame& frame = ledger.frame(0);
  frame.force_at_motor = line.tags[0].cause;
  std::vector<Phase> phases;
  for (const SpanId id : critical_path(frame)) {
    const Phase phase = frame.spans[static_cast<std::size_t>(id)].phase;
    if (phase != Phase::arbitration) phases.push_back(phase);
  }
  EXPECT_EQ(phases, (std::vector<Phase>{Phase::dma_write, Phase::message, Phase::to_memory}));
}

// Both ways at once share nothing but what goes the same way.
TEST_P(PcieBusAt, AReadWaitsForTheDirectionThatItsAnswerTakes) {
  const link::Pcie pcie = wire(PcieGeneration::gen1, 1);
  Picoseconds alone = 0;
  Picoseconds contended = 0;
  Bench bench(
      "", pcie, GetParam(),
      [&](Stimulus& m) {
        std::uint32_t word = 0;
        m.read(kSolverBase, &word, 4);
        alone = now_ps();
        m.sleep_until(100 * kUs + 100 * kNs);
        m.read(kSolverBase, &word, 4);
        contended = now_ps() - 100 * kUs - 100 * kNs;
      },
      [](Stimulus& m) {
        m.sleep_until(100 * kUs);
        std::array<std::uint8_t, 3'000> block{};
        m.write(0, block.data(), block.size());
      });
  sc_core::sc_start();
  // The board's 12 packets of up to 256 bytes are before the answer.
  EXPECT_GT(contended, alone + 10 * kUs);
  EXPECT_LT(contended, alone + 14 * kUs);
}

TEST_P(PcieBusAt, NobodyAtTheAddress) {
  Bench bench(
      "", wire(), GetParam(),
      [](Stimulus& m) {
        std::uint32_t word = 0;
        EXPECT_EQ(m.write(0, &word, 4), tlm::TLM_OK_RESPONSE) << "posted: nobody hears of it";
        EXPECT_EQ(m.read(0, &word, 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
        EXPECT_EQ(word, 0xffff'ffffU);
      },
      idle);
  sc_core::sc_start();
  EXPECT_TRUE(bench.registers.accesses.empty());
}

TEST_P(PcieBusAt, EachInitiatorsUseIsCounted) {
  const link::Pcie pcie = wire();
  Bench bench(
      "", pcie, GetParam(),
      [](Stimulus& m) {
        std::array<std::uint8_t, 128> block{};
        m.write(kSolverBase, block.data(), block.size());
      },
      [](Stimulus& m) {
        std::array<std::uint8_t, 512> block{};
        m.read(0, block.data(), block.size());
      });
  sc_core::sc_start();
  const BusUses uses = bench.link.uses();
  ASSERT_EQ(uses.size(), 2U);
  EXPECT_EQ(uses[0].name, "processor");
  EXPECT_EQ(uses[0].bytes, 128);
  EXPECT_EQ(uses[0].busy, pcie.tlp_ps(2 * pcie.write_wire_bytes(64)));
  EXPECT_EQ(uses[1].name, "board");
  EXPECT_EQ(uses[1].transactions, 1);
  EXPECT_EQ(uses[1].busy, pcie.tlp_ps(pcie.completion_wire_bytes(512)));
  // To the board: both writes and the completions. To the host: the requests. By the formulas every
  // packet carries its share of Ack, UpdateFC and SKIP; packet by packet they come when they are
  // due.
  const auto expect_taken = [&](link::PcieSide side, std::int64_t wire_bytes) {
    const Picoseconds taken = bench.link.busy(side);
    if (GetParam() == Timing::loosely_timed) {
      EXPECT_NEAR(static_cast<double>(taken), static_cast<double>(pcie.tlp_ps(wire_bytes)), 3);
    } else {
      const double alone = 1e12 * static_cast<double>(wire_bytes) / pcie.raw_rate();
      EXPECT_GE(static_cast<double>(taken), alone - 3);
      EXPECT_LE(static_cast<double>(taken), 1.5 * alone);
    }
  };
  expect_taken(link::PcieSide::root,
               2 * pcie.write_wire_bytes(64) + pcie.completion_wire_bytes(512));
  expect_taken(link::PcieSide::device, pcie.request_wire_bytes(512));
}

// The whole platform with the board on a link.
class OnPcie : public testing::TestWithParam<Timing> {};
INSTANTIATE_TEST_SUITE_P(Level, OnPcie,
                         testing::Values(Timing::untimed, Timing::loosely_timed,
                                         Timing::approximately_timed),
                         [](const auto& level) {
                           return level.param == Timing::untimed         ? "untimed"
                                  : level.param == Timing::loosely_timed ? "loosely"
                                                                         : "packets";
                         });

TEST_P(OnPcie, FramesGoOverBothBusesAndNothingIsLost) {
  SmallScene scene;
  scene.touch();
  scene.settings.bus.pcie.emplace();
  scene.settings.fidelity.bus = GetParam();
  const test::Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 10U);
  EXPECT_EQ(run.platform.servo().counts().driver_errors, 0);
  EXPECT_EQ(run.platform.board()->illegal_accesses(), 0);
  ASSERT_NE(run.platform.pcie(), nullptr);
  // Position and force over PCI; everything of the solver over the link.
  EXPECT_EQ(run.platform.bus().transactions(), 3 * 10);
  EXPECT_GT(run.platform.pcie()->uses()[0].transactions, 10 * 4);
  const std::vector<std::string> modules = Platform::modules();
  EXPECT_EQ(std::ranges::count(modules, "pcie"), 1);
  EXPECT_EQ(std::ranges::count(modules, "bridge"), 1);
}

TEST_P(OnPcie, AFrameByDmaAndAMessageHasAPathWithoutAGap) {
  SmallScene scene;
  scene.touch();
  scene.settings.bus.pcie.emplace();
  scene.settings.fidelity.bus = GetParam();
  scene.settings.transfer.method = Transfer::Method::dma;
  scene.settings.transfer.notification = link::Notification::msi;
  const test::Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 10U);
  EXPECT_EQ(run.platform.servo().counts().driver_errors, 0);
  const Frame& frame = run.log.frames.back();
  std::vector<Phase> phases;
  for (const SpanId id : run.log.paths.back()) {
    phases.push_back(frame.spans[static_cast<std::size_t>(id)].phase);
  }
  // To the board, the solve, and back; the ledger has refused a path with a gap.
  auto at = phases.begin();
  for (const Phase phase : {Phase::descriptor, Phase::dma_read, Phase::solve, Phase::dma_write,
                            Phase::message, Phase::to_memory, Phase::interrupt}) {
    at = std::find(at, phases.end(), phase);
    EXPECT_NE(at, phases.end()) << name(phase);
  }
  // Descriptors and b; U, the record and the message.
  EXPECT_GE(run.platform.pcie()->uses()[1].transactions, 10 * 5);
}

}  // namespace
}  // namespace hvp::vp::pcie_bus_test
