// Latencies that are drawn: the spans of frames at the times that the effects' sources say.
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/random/distribution.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_frame.h"
#include "tests/vp/recording_target.h"
#include "vp/latency_draws.h"
#include "vp/platform.h"

namespace hvp::vp::drawn_latencies_test {
namespace {

using test::kNs;
using test::kUs;
using test::Simulated;
using test::SmallScene;
using test::Stimulus;
using Kind = random::TimeDistribution::Kind;

Picoseconds ps(double seconds) { return std::llround(seconds * 1e12); }

template <class Table>
Table uniform(double from_s, double to_s) {
  Table table;
  table.kind = Kind::uniform;
  table.minimum_s = from_s;
  table.maximum_s = to_s;
  return table;
}

template <class Table>
Table constant(double seconds) {
  Table table;
  table.kind = Kind::constant;
  table.mean_s = seconds;
  return table;
}

std::vector<Picoseconds> spans_of(const Frame& frame, Phase phase) {
  std::vector<Picoseconds> times;
  for (const Span& span : frame.spans) {
    if (span.phase == phase) times.push_back(span.end - span.start);
  }
  return times;
}

// When set-up was over and all spans of all frames, of a run in a process of its own.
std::string run(const std::function<void(SmallScene&)>& change) {
  return test::output_of_child([&](std::string& text) {
    SmallScene scene;
    change(scene);
    const Simulated simulated(scene);
    text = std::to_string(simulated.platform.servo().set_up_time());
    for (const Frame& frame : simulated.log.frames) {
      for (const Span& span : frame.spans) {
        text += ' ' + std::string(name(span.phase)) + ' ' +
                std::to_string(span.start - frame.born) + ' ' +
                std::to_string(span.end - frame.born);
      }
    }
  });
}

TEST(DrawnInterrupts, EachFrameWaitsForItsOwn) {
  SmallScene scene;
  scene.settings.seed = 42;
  scene.settings.host.interrupt_latencies = uniform<host::InterruptLatencies>(2e-6, 20e-6);
  const Simulated run(scene);
  const random::Source source(uniform<random::TimeDistribution>(2e-6, 20e-6), 42,
                              "host.interrupt_latencies");
  ASSERT_EQ(run.log.frames.size(), 10U);
  for (const Frame& frame : run.log.frames) {
    const Picoseconds drawn = ps(source.time_s(frame.number));
    EXPECT_EQ(spans_of(frame, Phase::interrupt), std::vector<Picoseconds>{drawn});
    EXPECT_EQ(frame.latency(), test::latency(scene) - 5 * kUs + drawn);
  }
}

// A frame's reads of PCI: the position, STATUS, U; each has a draw of its own.
TEST(DrawnReads, EachReadOfTheProcessorHasItsOwn) {
  SmallScene scene;
  scene.settings.seed = 7;
  scene.settings.bus.read_latencies = uniform<link::PciReadLatencies>(500e-9, 2e-6);
  const Simulated run(scene);
  const random::Source source(uniform<random::TimeDistribution>(500e-9, 2e-6), 7,
                              "bus.read_latencies");
  for (const Frame& frame : run.log.frames) {
    const auto drawn = [&](std::uint32_t draw) {
      return ps(source.time_s(frame.number, draw)) - 700 * kNs;
    };
    EXPECT_EQ(spans_of(frame, Phase::block_read),
              (std::vector<Picoseconds>{test::pci_read(12) + drawn(0),
                                        test::pci_read(2 * SmallScene::kUnknowns) + drawn(2)}));
    EXPECT_EQ(spans_of(frame, Phase::bus_read),
              std::vector<Picoseconds>{test::pci_read(4) + drawn(1)});
    EXPECT_EQ(frame.latency(), test::latency(scene) + drawn(0) + drawn(1) + drawn(2));
  }
}

// On the clocked bus the wire's part waits for the next edge: that is arbitration, not the read.
TEST(DrawnReads, ApproximatelyTimedTheReadIsDrawnAndTheWireIsClocked) {
  SmallScene scene;
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.read_latencies = uniform<link::PciReadLatencies>(500e-9, 2e-6);
  const Simulated run(scene);
  const random::Source source(uniform<random::TimeDistribution>(500e-9, 2e-6), 1,
                              "bus.read_latencies");
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(spans_of(frame, Phase::bus_read),
              std::vector<Picoseconds>{test::pci_read(4) - 700 * kNs +
                                       ps(source.time_s(frame.number, 1))});
  }
}

// Looks in vain leave no spans, and are reads all the same.
TEST(DrawnReads, ALookOfAPollingHostIsARead) {
  const auto looks = [](double seconds) {
    SmallScene scene;
    scene.settings.transfer.notification = link::Notification::polling;
    scene.settings.bus.read_latencies = constant<link::PciReadLatencies>(seconds);
    const Simulated run(scene);
    const Frame& frame = run.log.frames.back();
    Picoseconds from = 0;
    Picoseconds until = 0;
    for (const Span& span : frame.spans) {
      if (span.phase == Phase::wait) from = span.start;
      if (span.phase == Phase::polling) until = span.end;
    }
    return until - from;
  };
  // k looks and k − 1 pauses, a microsecond each.
  const Picoseconds look = test::pci_read(4) - 700 * kNs + 2'500 * kNs;
  EXPECT_EQ((looks(2.5e-6) + kUs) % (look + kUs), 0);
}

void by_dma_over_a_link(SmallScene& scene) {
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = Transfer::Method::dma;
}

class Drawn : public testing::TestWithParam<Timing> {};
INSTANTIATE_TEST_SUITE_P(Level, Drawn,
                         testing::Values(Timing::loosely_timed, Timing::approximately_timed),
                         [](const auto& level) {
                           return level.param == Timing::loosely_timed ? "loosely"
                                                                       : "approximately";
                         });

TEST_P(Drawn, OfTheConstantsLengthIsTheRunWithoutThem) {
  const auto times = [](bool drawn) {
    return run([drawn](SmallScene& scene) {
      scene.touch();
      by_dma_over_a_link(scene);
      scene.settings.fidelity.bus = GetParam();
      if (!drawn) return;
      scene.settings.host.interrupt_latencies = constant<host::InterruptLatencies>(5e-6);
      scene.settings.bus.read_latencies = constant<link::PciReadLatencies>(700e-9);
      scene.settings.bus.pcie->root_complex_latencies =
          constant<link::RootComplexLatencies>(282e-9);
    });
  };
  const std::string without = times(false);
  EXPECT_GT(without.size(), 1'000U);
  EXPECT_EQ(times(true), without);
}

TEST(DrawnLatencies, ASeedGivesTheSameAndAnotherGivesOthers) {
  const auto times = [](std::int64_t seed) {
    return run([seed](SmallScene& scene) {
      scene.settings.seed = seed;
      by_dma_over_a_link(scene);
      scene.settings.bus.pcie->root_complex_latencies.emplace();
    });
  };
  const std::string first = times(1);
  EXPECT_GT(first.size(), 1'000U);
  EXPECT_EQ(times(1), first);
  EXPECT_NE(times(2), first);
}

// Set-up waits for the matrix' check, and reads STATUS: 90 µs would show.
TEST(DrawnLatencies, SetUpIsNoFrameAndDrawsNothing) {
  const auto set_up_time = [](double longer_s) {
    const std::string text = run([longer_s](SmallScene& scene) {
      scene.settings.host.interrupt_latencies = constant<host::InterruptLatencies>(5e-6 + longer_s);
      scene.settings.bus.read_latencies = constant<link::PciReadLatencies>(700e-9 + longer_s);
    });
    return text.substr(0, text.find(' '));
  };
  EXPECT_FALSE(set_up_time(0).empty());
  EXPECT_EQ(set_up_time(90e-6), set_up_time(0));
}

// Frames that overlap count their draws apart.
TEST(LatencyDraws, FramesThatOverlapCountTheirOwn) {
  LatencyDraws draws(uniform<random::TimeDistribution>(0, 1e-3), 1, "test");
  const random::Source source(uniform<random::TimeDistribution>(0, 1e-3), 1, "test");
  EXPECT_EQ(draws.next(5), ps(source.time_s(5, 0)));
  EXPECT_EQ(draws.next(6), ps(source.time_s(6, 0)));
  EXPECT_EQ(draws.next(5), ps(source.time_s(5, 1)));
  EXPECT_EQ(draws.take(6, 3), 1U);
  EXPECT_EQ(draws.next(6), ps(source.time_s(6, 4)));
  EXPECT_EQ(draws.next(9), ps(source.time_s(9, 0)));
  EXPECT_EQ(draws.ps(9, (1U << 16U) + 3), ps(source.time_s(9, 3)));
}

class OfDrawn : public link::CompleterTimes {
 public:
  OfDrawn(const random::Source& source, std::int64_t frame, std::uint32_t first)
      : source_(source), frame_(frame), first_(first) {}
  std::int64_t ps(std::int64_t request) const override {
    return drawn_latencies_test::ps(
        source_.time_s(frame_, first_ + static_cast<std::uint32_t>(request)));
  }

 private:
  const random::Source& source_;
  std::int64_t frame_;
  std::uint32_t first_;
};

class DrawnRootComplex : public testing::TestWithParam<Timing> {};
INSTANTIATE_TEST_SUITE_P(Level, DrawnRootComplex,
                         testing::Values(Timing::loosely_timed, Timing::approximately_timed),
                         [](const auto& level) {
                           return level.param == Timing::loosely_timed ? "loosely" : "packets";
                         });

// Two reads of a frame, then one of none: each request of a frame's reads has its draw, a frame's
// second read goes on with them, and all that the read took is its span.
TEST_P(DrawnRootComplex, EachRequestOfTheBoardHasItsOwn) {
  PcieSettings settings;
  settings.root_complex_latencies = uniform<link::RootComplexLatencies>(1e-6, 9e-6);
  const random::Source source(uniform<random::TimeDistribution>(1e-6, 9e-6), 3,
                              "bus.pcie.root_complex_latencies");
  Ledger ledger;
  PcieBus link("link", settings, GetParam(), ledger, 3);
  test::RecordingTarget registers("registers");
  test::RecordingTarget memory("memory");
  ledger.open(4, 0);
  Tag tag{4, kBirth};
  std::vector<Picoseconds> took;
  Stimulus host("host", [](Stimulus&) {});
  Stimulus board("board", [&](Stimulus& m) {
    std::array<std::uint8_t, 3'000> block{};
    for (Tag* of : {&tag, &tag, static_cast<Tag*>(nullptr)}) {
      const Picoseconds began = now_ps();
      m.read(0, block.data(), block.size(), of);
      took.push_back(now_ps() - began);
      m.sleep(20 * kUs);
    }
  });
  host.to_target.bind(link.from_host);
  board.to_target.bind(link.from_board);
  link.attach(registers.from_bus, kSolverBase, 8'192);
  link.attach_memory(memory.from_bus);
  sc_core::sc_start();
  ASSERT_EQ(took.size(), 3U);
  // 3000 bytes are six requests. Packet by packet a few bytes of the link layer come with them.
  const double tolerance = GetParam() == Timing::loosely_timed ? 0 : 20e3;
  const auto alone = [&](std::uint32_t first) {
    return settings.read_ps(link::PcieSide::device, 3'000, OfDrawn(source, 4, first));
  };
  EXPECT_NEAR(static_cast<double>(took[0]), static_cast<double>(alone(0)), tolerance);
  EXPECT_NEAR(static_cast<double>(took[1]), static_cast<double>(alone(6)), tolerance);
  EXPECT_NEAR(static_cast<double>(took[2]),
              static_cast<double>(settings.read_ps(link::PcieSide::device, 3'000)), tolerance);
  const std::vector<Picoseconds> spans = spans_of(ledger.frame(4), Phase::dma_read);
  ASSERT_EQ(spans.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE(spans[i], took[i]);
    EXPECT_NEAR(static_cast<double>(spans[i]), static_cast<double>(took[i]), tolerance);
  }
}

}  // namespace
}  // namespace hvp::vp::drawn_latencies_test
