#include "models/link/pci.h"

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::link::pci_test {
namespace {

Pci bus(PciKind kind, int burst_bytes) {
  Pci pci;
  pci.kind = kind;
  pci.burst_bytes = burst_bytes;
  return pci;
}

double gigabytes_per_second(const Pci& pci, std::int64_t bytes) {
  return static_cast<double>(bytes) * 1e3 / static_cast<double>(pci.write_wire_ps(bytes));
}

// The figures of published PCI throughput: 256-byte writes in one burst, and 3000 bytes in
// bursts of 64 bytes.
struct Row {
  PciKind kind;
  double effective_gb_s;
  double block_us;
};

class PciTable : public testing::TestWithParam<Row> {};

TEST_P(PciTable, EffectiveRateOf256ByteWrites) {
  EXPECT_NEAR(gigabytes_per_second(bus(GetParam().kind, 256), 256), GetParam().effective_gb_s,
              0.0005);
}

TEST_P(PciTable, BlockOf3000BytesIn64ByteBursts) {
  const double us = static_cast<double>(bus(GetParam().kind, 64).write_wire_ps(3000)) * 1e-6;
  EXPECT_NEAR(us, GetParam().block_us, GetParam().block_us < 10 ? 0.05 : 0.5);
}

INSTANTIATE_TEST_SUITE_P(Facts, PciTable,
                         testing::Values(Row{PciKind::pci_32_33, 0.125, 28},
                                         Row{PciKind::pci_32_66, 0.251, 14},
                                         Row{PciKind::pci_64_66, 0.474, 8.4},
                                         Row{PciKind::pci_x_133, 0.948, 4.2}));

TEST(Pci, RawRatesAreWidthOverPeriod) {
  const auto raw = [](PciKind kind) {
    const Pci pci = bus(kind, 64);
    return pci.width_bytes() * 1e3 / static_cast<double>(pci.clock_period_ps());
  };
  EXPECT_NEAR(raw(PciKind::pci_32_33), 0.133, 0.0005);
  EXPECT_NEAR(raw(PciKind::pci_32_66), 0.267, 0.0005);
  EXPECT_NEAR(raw(PciKind::pci_64_66), 0.533, 0.0005);
  EXPECT_NEAR(raw(PciKind::pci_x_133), 1.066, 0.001);  // 8 bytes in 7.5 ns: 1.0667
}

TEST(Pci, OneWordCostsItsOverheadOneDataPhaseAndTheLatency) {
  const Pci pci;
  EXPECT_EQ(pci.write_wire_ps(4), (4 + 1) * 30'000);
  EXPECT_EQ(pci.write_ps(4), 100'000 + 150'000);
  EXPECT_EQ(pci.read_ps(4), 700'000 + (4 + 8 + 1) * 30'000);
}

TEST(Pci, ShortLastBurstCostsOnlyItsDataPhases) {
  const Pci pci;
  EXPECT_EQ(pci.write_wire_ps(66) - pci.write_wire_ps(64), (4 + 1) * 30'000);
  EXPECT_EQ(pci.write_wire_ps(0), 0);
}

TEST(Pci, BurstMustHoldWholeDataPhases) {
  EXPECT_THROW(bus(PciKind::pci_64_66, 12).check(), InputError);
  EXPECT_NO_THROW(bus(PciKind::pci_32_33, 12).check());
}

}  // namespace
}  // namespace hvp::link::pci_test
