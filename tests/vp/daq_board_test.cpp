#include "vp/device/daq_board.h"

#include <array>

#include <gtest/gtest.h>

#include "models/plant/moving_device.h"
#include "tests/vp/stimulus.h"

namespace hvp::vp::daq_board_test {
namespace {

using test::kNs;
using test::kUs;
using test::Stimulus;

// 1 m/s along x from the session's beginning on: a nanometre a nanosecond.
plant::Trajectory steady() {
  plant::Trajectory t;
  t.interpolation = plant::Interpolation::linear;
  plant::Segment segment;
  segment.phase = plant::Stroke::slide;
  segment.to = {1, 0, 0};
  segment.duration = 1;
  t.motion = {segment};
  return t;
}

struct Bench {
  explicit Bench(Stimulus::Script script, std::optional<plant::Encoder> steps = std::nullopt,
                 Picoseconds delay = 0)
      : settings(with(std::move(steps))),
        daq("daq", settings.daq, {&settings}, {&path}, session, ledger, delay),
        master("master", std::move(script)) {
    master.to_target.bind(daq.from_bus);
  }
  static plant::DeviceSettings with(std::optional<plant::Encoder> steps) {
    plant::DeviceSettings settings;
    settings.encoder = std::move(steps);
    return settings;
  }
  plant::DeviceSettings settings;
  plant::PrescribedPath path{steady()};
  Session session{5 * kUs};
  Ledger ledger;
  DaqBoard daq;
  Stimulus master;
};

TEST(DaqBoard, PositionIsThatOfTheLatch) {
  Bench bench([&](Stimulus& m) {
    const std::uint32_t latch = 1;
    std::array<std::int32_t, 3> position{};
    m.sleep(25 * kUs);
    EXPECT_EQ(m.write(DaqBoard::kLatch, &latch, 4), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), 26 * kUs);  // the word is there a microsecond later
    m.sleep(40 * kUs);
    EXPECT_EQ(m.read(DaqBoard::kPosition, position.data(), 12), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), 66 * kUs);
    // 20 us after the session began, in nanometres.
    EXPECT_EQ(position, (std::array<std::int32_t, 3>{20'000, 0, 0}));
  });
  sc_core::sc_start();
}

TEST(DaqBoard, AnEncoderReadsTheNearestStep) {
  Bench bench(
      [&](Stimulus& m) {
        const std::uint32_t latch = 1;
        std::array<std::int32_t, 3> position{};
        for (const auto& [after, read] :
             {std::pair{27 * kUs, 0}, std::pair{28 * kUs, 55'000}, std::pair{82 * kUs, 55'000},
              std::pair{83 * kUs, 110'000}}) {
          // The session began after 5 us; a micrometre a microsecond, steps of 55 um.
          m.sleep(5 * kUs + after - now_ps());
          m.write(DaqBoard::kLatch, &latch, 4);
          m.read(DaqBoard::kPosition, position.data(), 12);
          EXPECT_EQ(position, (std::array<std::int32_t, 3>{read, 0, 0})) << after;
        }
      },
      plant::Encoder{});
  sc_core::sc_start();
}

TEST(DaqBoard, ForceIsAtTheMotorAfterTheOutputDelayAndNobodyWaits) {
  Bench bench([&](Stimulus& m) {
    bench.ledger.open(4, 0);
    m.sleep(100 * kUs);
    Tag tag{4, kBirth};
    const std::array<std::int32_t, 3> force{1, 2, 3};
    EXPECT_EQ(m.write(DaqBoard::kForce, force.data(), 12, &tag), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(now_ps(), 100 * kUs);
    EXPECT_EQ(tag.cause, kBirth);  // what the host does next does not follow the converter
  });
  sc_core::sc_start();
  const Frame& frame = bench.ledger.frame(4);
  ASSERT_EQ(frame.spans.size(), 2U);
  EXPECT_EQ(frame.spans[0].phase, Phase::convert);
  EXPECT_EQ(frame.spans[0].start, 100 * kUs);
  EXPECT_EQ(frame.spans[0].end, 110 * kUs);
  EXPECT_EQ(frame.spans[1].phase, Phase::motor);
  EXPECT_EQ(frame.spans[1].cause, 0);
  EXPECT_EQ(frame.force_at_motor, 1);
  EXPECT_EQ(frame.latency(), 110 * kUs);
}

TEST(DaqBoard, AHeldBackForceIsAtTheMotorLaterAndNobodyWaits) {
  Bench bench(
      [&](Stimulus& m) {
        bench.ledger.open(4, 0);
        m.sleep(100 * kUs);
        Tag tag{4, kBirth};
        const std::array<std::int32_t, 3> force{1, 2, 3};
        EXPECT_EQ(m.write(DaqBoard::kForce, force.data(), 12, &tag), tlm::TLM_OK_RESPONSE);
        EXPECT_EQ(now_ps(), 100 * kUs);
      },
      std::nullopt, 7'000 * kUs);
  sc_core::sc_start();
  const Frame& frame = bench.ledger.frame(4);
  ASSERT_EQ(frame.spans.size(), 3U);
  EXPECT_EQ(frame.spans[1].phase, Phase::delay);
  EXPECT_EQ(frame.spans[1].start, 110 * kUs);
  EXPECT_EQ(frame.spans[1].end, 7'110 * kUs);
  EXPECT_EQ(frame.spans[1].cause, 0);
  EXPECT_EQ(frame.force_at_motor, 2);
  EXPECT_EQ(frame.latency(), 7'110 * kUs);
}

TEST(DaqBoard, SamplingIsASpan) {
  Bench bench([&](Stimulus& m) {
    bench.ledger.open(4, 0);
    Tag tag{4, kBirth};
    const std::uint32_t latch = 1;
    m.write(DaqBoard::kLatch, &latch, 4, &tag);
    EXPECT_EQ(tag.cause, 0);
  });
  sc_core::sc_start();
  ASSERT_EQ(bench.ledger.frame(4).spans.size(), 1U);
  EXPECT_EQ(bench.ledger.frame(4).spans[0].phase, Phase::sample);
  EXPECT_EQ(bench.ledger.frame(4).spans[0].end, 1 * kUs);
}

TEST(DaqBoard, OtherAccessesAreRefused) {
  Bench bench([&](Stimulus& m) {
    std::array<std::uint32_t, 3> words{};
    EXPECT_EQ(m.read(DaqBoard::kLatch, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(m.write(DaqBoard::kLatch, words.data(), 8), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(m.read(DaqBoard::kPosition, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(m.write(DaqBoard::kForce, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(m.write(0x3c, words.data(), 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(now_ps(), 0);
  });
  sc_core::sc_start();
}

}  // namespace
}  // namespace hvp::vp::daq_board_test
