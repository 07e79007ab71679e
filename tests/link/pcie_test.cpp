#include "models/link/pcie.h"

#include <array>
#include <cstddef>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::link::pcie_test {
namespace {

Pcie link(PcieGeneration generation, int lanes) {
  Pcie pcie;
  pcie.generation = generation;
  pcie.lanes = lanes;
  // The table is about the wire.
  pcie.posted_header_credits = 1024;
  pcie.posted_data_credits = 65'536;
  return pcie;
}

// A figure as it is printed: half a unit of its last digit either way.
struct Printed {
  double value;
  double unit;
};
void expect_printed(double value, Printed printed) {
  EXPECT_NEAR(value, printed.value, 0.5 * printed.unit);
}

// Computed with pcie-bench's model (Neugebauer et al., SIGCOMM'18) at an MPS of 256: GB/s raw, for
// TLPs, of payload in 256-byte writes; and 3000 bytes, us.
struct Row {
  PcieGeneration generation;
  int lanes;
  Printed raw;
  Printed tlp;
  Printed effective;
  Printed block_us;
};

class PcieTable : public testing::TestWithParam<Row> {};

TEST_P(PcieTable, Row) {
  const Row& row = GetParam();
  const Pcie pcie = link(row.generation, row.lanes);
  expect_printed(pcie.raw_rate() * 1e-9, row.raw);
  expect_printed(pcie.tlp_rate() * 1e-9, row.tlp);
  expect_printed(pcie.write_throughput(256) * 1e-9, row.effective);
  expect_printed(static_cast<double>(pcie.transfer_ps(pcie.write_wire_bytes(3000))) * 1e-6,
                 row.block_us);
}

using G = PcieGeneration;
INSTANTIATE_TEST_SUITE_P(
    Facts, PcieTable,
    testing::Values(Row{G::gen1, 1, {.25, .01}, {.24, .01}, {.22, .01}, {13.7, .1}},
                    Row{G::gen1, 4, {1, 1}, {.86, .01}, {.79, .01}, {3.8, .1}},
                    Row{G::gen1, 8, {2, 1}, {1.70, .01}, {1.55, .01}, {1.9, .1}},
                    Row{G::gen2, 4, {2, 1}, {1.81, .01}, {1.65, .01}, {1.8, .1}},
                    Row{G::gen2, 8, {4, 1}, {3.58, .01}, {3.28, .01}, {.92, .01}},
                    Row{G::gen3, 8, {7.88, .01}, {7.24, .01}, {6.62, .01}, {.45, .01}},
                    Row{G::gen3, 16, {15.75, .01}, {14.2, .1}, {13.0, .1}, {.23, .01}},
                    Row{G::gen4, 8, {15.75, .01}, {14.5, .1}, {13.2, .1}, {.23, .01}},
                    Row{G::gen4, 16, {31.5, .1}, {28.4, .1}, {26.0, .1}, {.12, .01}},
                    Row{G::gen5, 16, {63, 1}, {56.9, .1}, {52, 1}, {.06, .01}}));

TEST(Pcie, Gen3x8HasThePublishedTlpRate) {
  EXPECT_NEAR(link(G::gen3, 8).tlp_rate() * 8e-9, 57.88, 0.005);  // Gb/s, SIGCOMM'18
}

TEST(Pcie, Gen6SendsFlits) {
  const Pcie pcie = link(G::gen6, 16);
  expect_printed(pcie.raw_rate() * 1e-9, {121, 1});
  // 236 of 256 bytes, and SKIP: 128 GB/s · 236/256 · (1 − 4/1538).
  EXPECT_NEAR(pcie.tlp_rate() * 1e-9, 117.69, 0.01);
  // No framing, sequence number or LCRC outside a header of 4 double words.
  EXPECT_EQ(pcie.write_wire_bytes(256), 272);
  EXPECT_EQ(pcie.completion_wire_bytes(256), 268);
  // One packet fills one or two flits.
  EXPECT_EQ(pcie.transfer_ps(20), pcie.tlp_ps(236));
  EXPECT_EQ(pcie.transfer_ps(237), pcie.tlp_ps(472));
}

// The limits as pcie-bench's model lists them from the specification's tables, at 2.5 GT/s; x16
// and x8 meet from 512 bytes on. 5 GT/s adds 51 symbol times, the faster rates 96.
TEST(PcieRate, DllpLimitsAreTheSpecificationsTable) {
  struct Line {
    int lanes;
    std::array<int, 6> limit;
  };
  constexpr std::array<Line, 5> kGen1 = {{{1, {237, 416, 559, 1071, 2095, 4143}},
                                          {2, {128, 217, 289, 545, 1057, 2081}},
                                          {4, {73, 118, 154, 282, 538, 1050}},
                                          {8, {67, 107, 86, 150, 278, 534}},
                                          {16, {48, 72, 86, 150, 278, 534}}}};
  for (const Line& line : kGen1) {
    for (std::size_t k = 0; k < line.limit.size(); ++k) {
      const int mps = 128 << k;
      EXPECT_EQ(dllp_limit(G::gen1, line.lanes, mps), line.limit[k]);
      EXPECT_EQ(dllp_limit(G::gen2, line.lanes, mps), line.limit[k] + 51);
      EXPECT_EQ(dllp_limit(G::gen3, line.lanes, mps), line.limit[k] + 96);
      EXPECT_EQ(dllp_limit(G::gen5, line.lanes, mps), line.limit[k] + 96);
    }
  }
}

TEST(PcieRate, ByteTimesAreExact) {
  EXPECT_EQ(byte_time(G::gen1, 1).ps(), 4000);
  EXPECT_EQ(byte_time(G::gen2, 16).ps(), 125);
  EXPECT_EQ(byte_time(G::gen3, 1).ps(), 1015.625);  // 8 bit at 8 GT/s · 128/130
  EXPECT_EQ(byte_time(G::gen5, 16).denominator, 512);
}

TEST(Pcie, SymbolTimesChargeEachLanesByte) {
  Pcie pcie = link(G::gen3, 8);
  pcie.dllp_accounting = DllpAccounting::symbol_times;
  // 8 bytes are one symbol time of eight lanes: 1 in 203, twice.
  EXPECT_NEAR(pcie.tlp_rate() / pcie.raw_rate(), 1 - 2.0 / 203 - 4.0 / 1538, 1e-12);
  const Pcie one = link(G::gen3, 1);
  Pcie same = one;
  same.dllp_accounting = DllpAccounting::symbol_times;
  EXPECT_EQ(one.tlp_rate(), same.tlp_rate());
}

TEST(Pcie, BytesOnTheWire) {
  Pcie pcie = link(G::gen3, 4);
  EXPECT_EQ(pcie.write_wire_bytes(3000), 3000 + 12 * 24);
  EXPECT_EQ(pcie.request_wire_bytes(3000), 6 * 24);
  EXPECT_EQ(pcie.completion_wire_bytes(3000), 3000 + 12 * 20);
  pcie.completions_of_boundary_size = true;
  EXPECT_EQ(pcie.completion_wire_bytes(3000), 3000 + 47 * 20);
  pcie.address_bits = 32;
  EXPECT_EQ(pcie.write_wire_bytes(4), 4 + 20);
  EXPECT_EQ(pcie.write_wire_bytes(0), 0);
}

TEST(Pcie, DefaultsReadHostMemoryAsFastAsMeasured) {
  // SIGCOMM'18: 64 bytes over Gen3 x8, Xeon E5, median 547 ns.
  EXPECT_NEAR(static_cast<double>(link(G::gen3, 8).read_ps(PcieSide::device, 64)) * 1e-3, 547, 1);
}

TEST(Pcie, ReadThroughputIsTheWiresOrTheReadsInFlight) {
  Pcie pcie = link(G::gen3, 8);
  pcie.outstanding_reads = 256;
  EXPECT_NEAR(pcie.read_throughput(PcieSide::device) / pcie.tlp_rate(), 512.0 / 552, 1e-9);
  pcie.outstanding_reads = 1;
  const double round_trip = static_cast<double>(pcie.read_ps(PcieSide::device, 512)) * 1e-12;
  EXPECT_NEAR(pcie.read_throughput(PcieSide::device) * round_trip, 512, 1e-3);
  pcie.outstanding_reads = 4;
  EXPECT_NEAR(pcie.read_throughput(PcieSide::device) * round_trip, 4 * 512, 1e-2);
}

TEST(Pcie, OneReadInFlightTakesARoundTripARequest) {
  Pcie pcie = link(G::gen3, 8);
  pcie.outstanding_reads = 1;
  const auto one = static_cast<double>(pcie.read_ps(PcieSide::device, 512));
  EXPECT_NEAR(static_cast<double>(pcie.read_ps(PcieSide::device, 5 * 512)), 5 * one, 10);
}

TEST(Pcie, FewCreditsThrottleWrites) {
  Pcie pcie = link(G::gen3, 8);
  const double free = pcie.write_throughput(256);
  pcie.posted_header_credits = 2;
  // Two packets in 280 B on the wire, 2 · 125 ns and 50 ns.
  const double loop = 280 / pcie.tlp_rate() + 300e-9;
  EXPECT_NEAR(pcie.write_throughput(256) * loop, 512, 0.01);
  EXPECT_LT(pcie.write_throughput(256), free);
  EXPECT_NEAR(static_cast<double>(pcie.posted_write_ps(8 * 256)) * 1e-12,
              3 * loop + 2 * 280 / pcie.tlp_rate() + 125e-9, 1e-11);
}

TEST(Pcie, SizesThatDoNotExistAreRefused) {
  const auto refuses = [](int Pcie::*member, int value) {
    Pcie pcie;
    pcie.*member = value;
    EXPECT_THROW(pcie.check(), InputError) << value;
  };
  EXPECT_NO_THROW(Pcie{}.check());
  refuses(&Pcie::lanes, 3);
  refuses(&Pcie::max_payload_bytes, 200);
  refuses(&Pcie::max_read_request_bytes, 600);
  refuses(&Pcie::read_completion_boundary_bytes, 96);
  refuses(&Pcie::address_bits, 48);
  refuses(&Pcie::posted_data_credits, 15);
  refuses(&Pcie::write_combining_bytes, 48);
}

}  // namespace
}  // namespace hvp::link::pcie_test
