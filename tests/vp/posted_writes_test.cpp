// [bus.posted_writes]: who goes on when, what is where when, and what a driver that forgets about
// it sees. Clocks of 33 MHz, counted by hand.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/path_of.h"
#include "tests/vp/recording_target.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/bus/host_memory.h"
#include "vp/pci/other_masters.h"
#include "vp/pci/pci_bus.h"
#include "vp/platform.h"

namespace hvp::vp::posted_writes_test {
namespace {

using test::kNs;
using test::kUs;
using test::RecordingTarget;
using test::SmallScene;
using test::Stimulus;

constexpr Picoseconds kClock = 30 * kNs;

BusSettings posted(Picoseconds to_memory = 0) {
  BusSettings settings;
  settings.posted_writes.emplace();
  settings.posted_writes->to_memory_s = static_cast<double>(to_memory) * 1e-12;
  return settings;
}

struct Bench {
  explicit Bench(Stimulus::Script script, const BusSettings& settings = posted(),
                 Timing level = Timing::loosely_timed)
      : bus("bus", settings, level, ledger), target("target"), host("host", std::move(script)) {
    host.to_target.bind(bus.from_host);
    bus.attach(target.from_bus, kSolverBase, 8'192);
    ledger.open(0, 0);
  }
  const std::vector<Span>& spans() { return ledger.frame(0).spans; }

  Ledger ledger;
  PciBus bus;
  RecordingTarget target;
  Stimulus host;
};

void expect_span(const Span& span, Phase phase, Picoseconds start, Picoseconds end, SpanId cause) {
  EXPECT_EQ(name(span.phase), name(phase));
  EXPECT_EQ(span.start, start);
  EXPECT_EQ(span.end, end);
  EXPECT_EQ(span.cause, cause);
}

TEST(PostedWrites, TheProcessorGoesOnAndAReadStaysBehindItsWrites) {
  Tag tag{0, kBirth};
  Bench bench([&](Stimulus& m) {
    const std::uint32_t word = 7;
    std::uint32_t read = 0;
    m.write(kSolverBase, &word, 4, &tag);
    EXPECT_EQ(now_ps(), 100 * kNs);
    m.write(kSolverBase + 4, &word, 4, &tag);
    EXPECT_EQ(now_ps(), 200 * kNs);
    m.read(kSolverBase + 4, &read, 4, &tag);
    EXPECT_EQ(read, 7U);
    // The second write's last data phase, then a read as if nothing had been.
    EXPECT_EQ(now_ps(), (400 + 1'090) * kNs);
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.target.times(),
            (std::vector<Picoseconds>{250 * kNs, 400 * kNs, (400 + 1'090) * kNs}));
  // In the order in which they were over. The writes are branches: each follows what its processor
  // had done before it.
  const std::vector<Span>& spans = bench.spans();
  ASSERT_EQ(spans.size(), 7U);
  expect_span(spans[0], Phase::posting, 0, 100 * kNs, kBirth);
  expect_span(spans[1], Phase::posting, 100 * kNs, 200 * kNs, 0);
  expect_span(spans[2], Phase::bus_write, 0, 250 * kNs, kBirth);
  expect_span(spans[3], Phase::arbitration, 100 * kNs, 150 * kNs, 0);
  expect_span(spans[4], Phase::bus_write, 150 * kNs, 400 * kNs, 3);
  expect_span(spans[5], Phase::arbitration, 200 * kNs, 400 * kNs, 1);
  expect_span(spans[6], Phase::bus_read, 400 * kNs, 1'490 * kNs, 5);
  // What a target sees of a write's tag is the write's branch.
  EXPECT_EQ(bench.target.accesses[0].tag.cause, 2);
  EXPECT_EQ(bench.target.accesses[1].tag.cause, 4);
  EXPECT_FALSE(bench.ledger.holds()) << "nothing is under way";
}

// Not even where the bus is free between two of them.
TEST(PostedWrites, AReadOvertakesNoneOfManyWrites) {
  Bench bench([&](Stimulus& m) {
    std::uint32_t word = 0;
    for (std::uint32_t i = 1; i <= 10; ++i) m.write(kSolverBase + 4, &i, 4);
    m.read(kSolverBase + 4, &word, 4);
    EXPECT_EQ(word, 10U);
    // 100 ns to the bus, 150 ns each on it.
    EXPECT_EQ(now_ps(), (100 + 10 * 150 + 1'090) * kNs);
  });
  sc_core::sc_start();
  EXPECT_TRUE(bench.target.accesses.back().read);
}

TEST(PostedWrites, ApproximatelyTimedAReadOvertakesNoneOfManyWritesEither) {
  Bench bench(
      [&](Stimulus& m) {
        std::uint32_t word = 0;
        for (std::uint32_t i = 1; i <= 10; ++i) m.write(kSolverBase + 4, &i, 4);
        m.read(kSolverBase + 4, &word, 4);
        EXPECT_EQ(word, 10U);
      },
      posted(), Timing::approximately_timed);
  sc_core::sc_start();
  EXPECT_EQ(bench.target.accesses.size(), 11U);
  EXPECT_TRUE(bench.target.accesses.back().read);
}

TEST(PostedWrites, OfABlockTheLastBufferfulIsPosted) {
  Bench bench([&](Stimulus& m) {
    std::array<std::uint8_t, 3'000> block{};
    block[2'999] = 9;
    m.write(kSolverBase, block.data(), block.size());
    // 46 bursts of 16 words have left; 56 bytes are in the bridge.
    EXPECT_EQ(now_ps(), 100 * kNs + (46 * 4 + 46 * 16) * kClock);
    block.fill(0);  // the caller's again
  });
  sc_core::sc_start();
  EXPECT_EQ(bench.target.times(), (std::vector<Picoseconds>{100 * kNs + (47 * 4 + 750) * kClock}));
  EXPECT_EQ(bench.target.bytes[2'999], 9);
  EXPECT_EQ(bench.bus.transactions(), 1);
  EXPECT_EQ(bench.bus.bytes_moved(), 3'000);
}

TEST(PostedWrites, ApproximatelyTimedTheSameFromTheNextEdgeOn) {
  Bench bench(
      [&](Stimulus& m) {
        std::array<std::uint8_t, 3'000> block{};
        m.write(kSolverBase, block.data(), block.size());
        // At the bus at 100 ns, the edge at 120 ns.
        EXPECT_EQ(now_ps(), 120 * kNs + (46 * 4 + 46 * 16) * kClock);
      },
      posted(), Timing::approximately_timed);
  sc_core::sc_start();
  EXPECT_EQ(bench.target.times(), (std::vector<Picoseconds>{120 * kNs + (47 * 4 + 750) * kClock}));
}

TEST(PostedWrites, AFullBufferMakesTheProcessorWait) {
  BusSettings settings = posted();
  settings.pci.write_latency_s = 0;
  Bench bench(
      [&](Stimulus& m) {
        const std::uint32_t word = 0;
        for (int i = 0; i < 16; ++i) m.write(kSolverBase, &word, 4);
        EXPECT_EQ(now_ps(), 0);
        m.write(kSolverBase, &word, 4);
        EXPECT_EQ(now_ps(), 5 * kClock);  // until the first has left
        m.write(kSolverBase, &word, 4);
        EXPECT_EQ(now_ps(), 10 * kClock);
      },
      settings);
  sc_core::sc_start();
  EXPECT_EQ(bench.target.accesses.size(), 18U);
  EXPECT_EQ(bench.target.accesses.back().time, 18 * 5 * kClock);
}

TEST(PostedWrites, ATargetsWaitStatesKeepTheBusAndNotTheProcessor) {
  Bench bench([&](Stimulus& m) {
    const std::uint32_t word = 0;
    m.write(kSolverBase, &word, 4);
    m.write(kSolverBase, &word, 4);
    EXPECT_EQ(now_ps(), 200 * kNs);
  });
  bench.target.wait_states = 1'000 * kNs;
  sc_core::sc_start();
  EXPECT_EQ(bench.target.times(), (std::vector<Picoseconds>{250 * kNs, (250 + 1'000 + 150) * kNs}));
}

TEST(PostedWrites, AWriteThatNobodyClaimsIsNotHeardOf) {
  Bench bench([&](Stimulus& m) {
    const std::uint32_t word = 0;
    EXPECT_EQ(m.write(0x6000'0000, &word, 4), tlm::TLM_OK_RESPONSE);
    std::uint32_t read = 0;
    EXPECT_EQ(m.read(0x6000'0000, &read, 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
  });
  sc_core::sc_start();
  EXPECT_TRUE(bench.target.accesses.empty());
}

// A board with one register: any write to it lowers its interrupt line.
class Acknowledged : public sc_core::sc_module {
 public:
  explicit Acknowledged(const sc_core::sc_module_name& name)
      : sc_module(name), from_bus("from_bus") {
    from_bus.register_b_transport(this, &Acknowledged::b_transport);
  }
  tlm_utils::simple_target_socket<Acknowledged> from_bus;
  sc_core::sc_port<InterruptIf> interrupt;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    if (transaction.is_write()) {
      interrupt->lowered();
    } else {
      std::memset(transaction.get_data_ptr(), 0, transaction.get_data_length());
    }
  }
};

// A board that is master and has a line, the host's memory, and a driver.
struct Interrupting {
  explicit Interrupting(test::Program::Script driver, Stimulus::Script board,
                        Picoseconds to_memory = 1'500 * kNs)
      : bus("bus", posted(to_memory), Timing::loosely_timed, ledger),
        access("access"),
        port(access, 0, ledger),
        memory("memory", 4'096),
        registers("registers"),
        master("master", std::move(board)),
        program("program", std::move(driver)) {
    access.to_bus.bind(bus.from_host);
    bus.attach(registers.from_bus, kSolverBase, 64);
    bus.attach_memory(memory.from_bus);
    registers.interrupt.bind(access);
    memory.interrupt.bind(access);
    master.to_target.bind(bus.from_board);
    ledger.open(0, 0);
  }
  const hvp_bus& driver() const { return port.bus(); }

  Ledger ledger;
  PciBus bus;
  BoardAccess access;
  DriverPort port;
  HostMemory memory;
  Acknowledged registers;
  Stimulus master;
  test::Program program;
};

constexpr std::uint64_t kTenMicroseconds = 10'000;

TEST(PostedWrites, AnAcknowledgementThatIsNotReadBackLeavesTheLineUp) {
  Interrupting* b = nullptr;
  Interrupting bench(
      [&](test::Program& p) {
        const hvp_bus& bus = b->driver();
        ASSERT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT);
        EXPECT_EQ(now_ps(), 1 * kUs);
        bus.write32(bus.context, 0, 1);
        // The write is in the bridge; the line is up, and the same request is taken once more.
        EXPECT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT);
        EXPECT_EQ(now_ps(), 1'100 * kNs);
        p.sleep_until(20 * kUs);
        ASSERT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT);
        bus.write32(bus.context, 0, 1);
        bus.read32(bus.context, 0);  // pushes the write ahead of itself
        EXPECT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT_TIMED_OUT);
      },
      [&](Stimulus& m) {
        m.sleep_until(1 * kUs);
        b->registers.interrupt->interrupt(Tag{});
        m.sleep_until(20 * kUs);
        b->registers.interrupt->interrupt(Tag{});
      });
  b = &bench;
  sc_core::sc_start();
}

TEST(PostedWrites, ALineOvertakesTheDataThatItAnnounces) {
  Interrupting* b = nullptr;
  Interrupting bench(
      [&](test::Program& /*p*/) {
        const hvp_bus& bus = b->driver();
        ASSERT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT);
        EXPECT_EQ(now_ps(), 5 * kClock);
        EXPECT_EQ(b->memory.bytes()[16], 0) << "the data are still on their way";
        // A read of the board: 1090 ns, and the answer is behind the data, which need 1500.
        bus.read32(bus.context, 0);
        EXPECT_EQ(now_ps(), 5 * kClock + 1'500 * kNs);
        EXPECT_EQ(b->memory.bytes()[16], 42);
      },
      [&](Stimulus& m) {
        const std::uint32_t word = 42;
        m.write(16, &word, 4);
        b->registers.interrupt->interrupt(Tag{});
      });
  b = &bench;
  sc_core::sc_start();
}

TEST(PostedWrites, AMessageStaysBehindTheDataThatItAnnounces) {
  Tag tag{0, kBirth};
  Interrupting* b = nullptr;
  Interrupting bench(
      [&](test::Program& /*p*/) {
        b->access.tag() = Tag{0, kBirth};
        const hvp_bus& bus = b->driver();
        ASSERT_EQ(bus.wait_interrupt(bus.context, kTenMicroseconds), HVP_INTERRUPT);
        EXPECT_EQ(now_ps(), 2 * 5 * kClock + 1'500 * kNs);
        EXPECT_EQ(b->memory.bytes()[16], 42);
      },
      [&](Stimulus& m) {
        const std::uint32_t word = 42;
        m.write(16, &word, 4, &tag);
        m.write(kMessageAddress, &word, 4, &tag);
        EXPECT_EQ(now_ps(), 2 * 5 * kClock) << "a board does not wait for memory";
      });
  b = &bench;
  sc_core::sc_start();
  // The host follows the message to the picosecond: a gap would end a run.
  Frame& frame = bench.ledger.frame(0);
  frame.force_at_motor = bench.access.tag().cause;
  std::vector<Phase> phases;
  for (const SpanId id : critical_path(frame)) {
    phases.push_back(frame.spans[static_cast<std::size_t>(id)].phase);
  }
  EXPECT_EQ(phases, (std::vector<Phase>{Phase::dma_write, Phase::message, Phase::to_memory,
                                        Phase::interrupt}));
}

TEST(PostedWrites, TheBoardsOwnReadStaysBehindItsWrites) {
  Interrupting bench([](test::Program& /*p*/) {},
                     [&](Stimulus& m) {
                       std::uint32_t word = 42;
                       m.write(16, &word, 4);
                       word = 0;
                       m.read(16, &word, 4);
                       EXPECT_EQ(word, 42U);
                       EXPECT_EQ(now_ps(), (5 + 13) * kClock + 1'500 * kNs);
                     });
  sc_core::sc_start();
}

const Span& only(const Frame& frame, Phase phase) {
  return *std::find_if(frame.spans.begin(), frame.spans.end(),
                       [phase](const Span& s) { return s.phase == phase; });
}

// Every frame that is handed on has a path without a gap: the ledger throws otherwise.
void expect_forces_behind_the_processor(SmallScene& scene) {
  scene.settings.bus.posted_writes.emplace();
  scene.settings.frames = 20;
  const test::Simulated run(scene);
  ASSERT_EQ(run.log.frames.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) {
    const Frame& frame = run.log.frames[i];
    EXPECT_EQ(frame.number, static_cast<std::int64_t>(i));
    Picoseconds sum = 0;
    for (const SpanId id : run.log.paths[i]) {
      const Span& s = frame.spans[static_cast<std::size_t>(id)];
      sum += s.end - s.start;
    }
    EXPECT_EQ(sum, frame.latency());
    // The processor has handed the force over before the DAQ board has it.
    const Span& last_posting =
        *std::find_if(frame.spans.rbegin(), frame.spans.rend(),
                      [](const Span& s) { return s.phase == Phase::posting; });
    EXPECT_EQ(last_posting.end - last_posting.start, 100 * kNs);
    // 12 bytes: 4 clocks and 3 words.
    EXPECT_EQ(only(frame, Phase::convert).start, last_posting.start + 100 * kNs + 7 * kClock);
  }
}

TEST(PostedWrites, AFramesForceIsBehindTheProcessorAndItsPathStillSums) {
  SmallScene scene;
  scene.touch();
  expect_forces_behind_the_processor(scene);
}

// Frames at rest are all alike: the first one does not find the end of set-up on the bus.
void expect_set_up_has_left(SmallScene& scene) {
  scene.settings.frames = 3;
  const test::Simulated run(scene);
  EXPECT_EQ(run.platform.session().begin, run.platform.servo().set_up_time());
  ASSERT_EQ(run.log.frames.size(), 3U);
  for (const Frame& frame : run.log.frames) {
    SCOPED_TRACE(frame.number);
    EXPECT_EQ(frame.latency(), run.log.frames.back().latency());
    EXPECT_EQ(only(frame, Phase::bus_write).start, frame.born) << "nobody is on the bus";
  }
}

TEST(PostedWrites, OfSetUpHaveLeftBeforeTheFirstFrame) {
  SmallScene scene;
  scene.settings.bus.posted_writes.emplace();
  expect_set_up_has_left(scene);
}

TEST(PostedWrites, OfSetUpByWordsHaveLeftToo) {
  SmallScene scene;
  scene.settings.bus.posted_writes.emplace();
  scene.settings.bus.posted_writes->buffer_bytes = 4'096;
  scene.settings.transfer.method = Transfer::Method::programmed_io;
  expect_set_up_has_left(scene);
}

TEST(PostedWrites, InAPipelineToo) {
  SmallScene scene;
  scene.touch();
  scene.settings.host.pipeline_depth = 1;
  scene.settings.budget = 2 * scene.settings.period;
  expect_forces_behind_the_processor(scene);
}

TEST(PostedWrites, ApproximatelyTimedNothingIsLostEither) {
  SmallScene scene;
  scene.touch();
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.posted_writes.emplace();
  const test::Simulated run(scene);
  EXPECT_EQ(run.log.frames.size(), 10U);
  EXPECT_EQ(run.platform.servo().counts().driver_errors, 0);
}

}  // namespace
}  // namespace hvp::vp::posted_writes_test
