#include "models/link/pcie_link.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/allocation_count.h"

namespace hvp::link::pcie_link_test {
namespace {

constexpr std::int64_t kNs = 1'000;
constexpr std::array<PcieSide, 3> kSides = {PcieSide::root, PcieSide::device, PcieSide::device};
constexpr std::array<PcieGeneration, 6> kGenerations = {PcieGeneration::gen1, PcieGeneration::gen2,
                                                        PcieGeneration::gen3, PcieGeneration::gen4,
                                                        PcieGeneration::gen5, PcieGeneration::gen6};

Pcie wire(PcieGeneration generation, int lanes) {
  Pcie pcie;
  pcie.generation = generation;
  pcie.lanes = lanes;
  return pcie;
}

// The mean of many transfers, each alone on the link: a DLLP stands before one of them and not
// before the next, and the formulas spread it evenly.
double mean_ps(const Pcie& pcie, int initiator, Direction direction, std::int64_t bytes) {
  constexpr int kTransfers = 400;
  PcieLink link(pcie, kSides);
  std::int64_t now = 0;
  std::int64_t sum = 0;
  for (int k = 0; k < kTransfers; ++k) {
    link.request(initiator, direction, bytes, now);
    const std::int64_t end = link.forecast(initiator);
    link.advance(end);
    EXPECT_TRUE(link.done(initiator));
    sum += end - now;
    now = end + 1'000 * kNs;
  }
  return static_cast<double>(sum) / kTransfers;
}

void expect_formulas(const Pcie& pcie, std::int64_t bytes) {
  const auto near = [&](double engine, std::int64_t formula, const char* what) {
    EXPECT_NEAR(engine / static_cast<double>(formula), 1, 0.01)
        << what << ", " << bytes << " bytes, gen" << 1 + static_cast<int>(pcie.generation) << " x"
        << pcie.lanes;
  };
  near(mean_ps(pcie, 1, Direction::write, bytes), pcie.posted_write_ps(bytes), "write");
  near(mean_ps(pcie, 1, Direction::read, bytes), pcie.read_ps(PcieSide::device, bytes), "read");
  near(mean_ps(pcie, 0, Direction::read, bytes), pcie.read_ps(PcieSide::root, bytes), "by host");
}

TEST(PcieLink, WithoutContentionItTakesTheFormulasTime) {
  for (const PcieGeneration generation : kGenerations) {
    for (const int lanes : {1, 2, 4, 8, 16}) {
      for (const std::int64_t bytes : {4, 64, 256, 300, 1500, 3000, 24'000}) {
        expect_formulas(wire(generation, lanes), bytes);
      }
    }
  }
}

TEST(PcieLink, FormulasHoldForOtherSizesAndAccounting) {
  for (const int mps : {128, 512, 4096}) {
    for (const int mrrs : {128, 4096}) {
      Pcie pcie = wire(PcieGeneration::gen3, 8);
      pcie.max_payload_bytes = mps;
      pcie.max_read_request_bytes = mrrs;
      pcie.completions_of_boundary_size = mps == 512;
      pcie.address_bits = mrrs == 128 ? 32 : 64;
      pcie.dllp_accounting = DllpAccounting::symbol_times;
      for (const std::int64_t bytes : {64, 3000, 24'000}) expect_formulas(pcie, bytes);
    }
  }
}

TEST(PcieLink, FormulasHoldWhereTagsOrCreditsAreScarce) {
  Pcie tags = wire(PcieGeneration::gen3, 8);
  tags.outstanding_reads = 2;
  Pcie headers = wire(PcieGeneration::gen3, 8);
  headers.posted_header_credits = 2;
  headers.nonposted_header_credits = 2;
  Pcie data = wire(PcieGeneration::gen3, 8);
  data.posted_data_credits = 48;
  for (const Pcie& pcie : {tags, headers, data}) {
    for (const std::int64_t bytes : {64, 3000, 24'000, 24'100}) expect_formulas(pcie, bytes);
  }
}

TEST(PcieLink, SteadyRateIsTheFormulasThroughput) {
  for (const PcieGeneration generation : kGenerations) {
    for (const int lanes : {1, 8, 16}) {
      const Pcie pcie = wire(generation, lanes);
      PcieLink link(pcie, kSides);
      constexpr std::int64_t kBytes = 16 << 20;
      link.request(1, Direction::write, kBytes, 0);
      const double write_s = static_cast<double>(link.forecast(1)) * 1e-12;
      EXPECT_NEAR(kBytes / write_s / pcie.write_throughput(kBytes), 1, 0.01);
      PcieLink other(pcie, kSides);
      other.request(1, Direction::read, kBytes, 0);
      const double read_s = static_cast<double>(other.forecast(1)) * 1e-12;
      EXPECT_NEAR(kBytes / read_s / pcie.read_throughput(PcieSide::device), 1, 0.01);
    }
  }
}

// Gen1 x1: 4 ns a byte; an MPS of 256 has a limit of 416, so that the first Ack is due after 208
// bytes, the first UpdateFC after 416, the first SKIP after 769.
TEST(PcieLink, TwoDeviceWritersTakeTurns) {
  PcieLink link(wire(PcieGeneration::gen1, 1), kSides);
  link.request(1, Direction::write, 512, 0);
  link.request(2, Direction::write, 256, 1);
  link.advance(100'000 * kNs);
  // Packets of 280 bytes: of 1, of 2 (behind an Ack), of 1 (behind UpdateFC: 568 of 416 bytes).
  EXPECT_EQ(link.completed_ps(2), ((280 + 8 + 280) * 4 + 125) * kNs);
  EXPECT_EQ(link.completed_ps(1), ((280 + 8 + 280 + 8 + 280) * 4 + 125) * kNs);
  EXPECT_EQ(link.sent_ps(1), link.completed_ps(1) - 125 * kNs);
  EXPECT_EQ(link.traffic(PcieSide::device).packets, 3);
  EXPECT_EQ(link.traffic(PcieSide::device).link_layer_bytes, 16);
}

TEST(PcieLink, ProcessorsWriteDelaysACompletionThatSharesItsDirection) {
  const Pcie pcie = wire(PcieGeneration::gen1, 1);
  PcieLink alone(pcie, kSides);
  alone.request(1, Direction::read, 64, 0);
  // Request 24 bytes, link, root complex, completion 84 bytes, link.
  const std::int64_t completion_starts = (24 * 4 + 125 + 282) * kNs;
  EXPECT_EQ(alone.forecast(1), completion_starts + (84 * 4 + 125) * kNs);

  PcieLink link(pcie, kSides);
  link.request(1, Direction::read, 64, 0);
  link.request(0, Direction::write, 64, completion_starts - 100 * kNs);
  // The processor's packet of 88 bytes began 100 ns before and takes 352.
  EXPECT_EQ(link.forecast(1), completion_starts + (252 + 84 * 4 + 125) * kNs);
}

TEST(PcieLink, DirectionsDoNotDisturbEachOther) {
  const Pcie pcie = wire(PcieGeneration::gen3, 8);
  PcieLink link(pcie, kSides);
  link.request(0, Direction::write, 24'000, 0);
  link.request(1, Direction::write, 24'000, 0);
  EXPECT_EQ(link.forecast(0), link.forecast(1));
}

TEST(PcieLink, SimultaneousRequestsDoNotDependOnTheOrderOfTheCalls) {
  const Pcie pcie = wire(PcieGeneration::gen2, 4);
  PcieLink up(pcie, kSides);
  PcieLink down(pcie, kSides);
  for (int i = 0; i < 3; ++i) {
    up.request(i, Direction::read, 1'000 + 700 * i, 50 * kNs);
    down.request(2 - i, Direction::read, 1'000 + 700 * (2 - i), 50 * kNs);
  }
  for (int i = 0; i < 3; ++i) EXPECT_EQ(up.forecast(i), down.forecast(i));
}

TEST(PcieLink, ForecastIsWhatHappensWhenNobodyElseAsks) {
  PcieLink link(wire(PcieGeneration::gen1, 4), kSides);
  link.request(0, Direction::read, 4, 0);
  link.request(1, Direction::read, 20'000, 10);
  link.request(2, Direction::write, 20'000, 20);
  const std::array<std::int64_t, 3> forecast = {link.forecast(0), link.forecast(1),
                                                link.forecast(2)};
  const std::int64_t last = *std::max_element(forecast.begin(), forecast.end());
  for (std::int64_t t = 0; t <= last; t += 7'777) link.advance(t);
  link.advance(last);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(link.done(i));
    EXPECT_EQ(link.completed_ps(i), forecast[static_cast<std::size_t>(i)]);
  }
}

TEST(PcieLink, PostedWriteHasLeftLongBeforeItArrives) {
  PcieLink link(wire(PcieGeneration::gen3, 4), kSides);
  link.request(0, Direction::write, 4, 0);
  EXPECT_EQ(link.forecast(0) - link.forecast_sent(0), 125 * kNs + 1);  // a part of a picosecond
  EXPECT_FALSE(link.done(0));
  link.advance(link.forecast(0));
  EXPECT_TRUE(link.done(0));
}

TEST(PcieLink, NothingAllocatesAfterConstruction) {
  PcieLink link(wire(PcieGeneration::gen3, 4), kSides);
  const std::size_t before = test::allocation_count();
  link.request(1, Direction::read, 24'000, 0);
  link.request(2, Direction::write, 24'000, 0);
  link.advance(link.forecast(1));
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PcieLink, WrongNumbersOfInitiatorsAreRefused) {
  EXPECT_THROW(PcieLink({}, {}), InputError);
  const std::array<PcieSide, 9> many{};
  EXPECT_THROW(PcieLink({}, many), InputError);
}

}  // namespace
}  // namespace hvp::link::pcie_link_test
