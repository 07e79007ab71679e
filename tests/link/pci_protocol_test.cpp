#include <gtest/gtest.h>

#include "models/link/pci.h"

namespace hvp::link::pci_protocol_test {
namespace {

Pci bus(PciKind kind) {
  Pci pci;
  pci.kind = kind;
  return pci;
}

constexpr PciKind kKinds[] = {PciKind::pci_32_33, PciKind::pci_32_66, PciKind::pci_64_66,
                              PciKind::pci_x_133};

TEST(PciClocks, WithoutExtrasABlockTakesWhatTheLooselyTimedBusSays) {
  for (const PciKind kind : kKinds) {
    const Pci pci = bus(kind);
    const PciClocks clocks(pci, {});
    for (const std::int64_t bytes : {4, 64, 66, 256, 1500, 3000, 24'000}) {
      EXPECT_EQ(clocks.alone_ps(Direction::write, bytes), pci.write_wire_ps(bytes));
      EXPECT_EQ(clocks.alone_ps(Direction::read, bytes), pci.read_wire_ps(bytes));
    }
  }
}

TEST(PciClocks, PartsOfTheOverheadSumToIt) {
  for (const PciKind kind : kKinds) {
    for (int overhead = 2; overhead <= 64; ++overhead) {
      Pci pci = bus(kind);
      pci.overhead_clocks = overhead;
      const PciClocks c(pci, {});
      EXPECT_EQ(c.arbitration() + c.address() + c.first_wait(Direction::write) + c.turnaround(),
                overhead);
      EXPECT_GE(c.address(), 1);
      EXPECT_GE(c.arbitration(), 0);
    }
  }
}

TEST(PciClocks, WaitStatesStretchEveryDataPhase) {
  PciProtocol slow;
  slow.wait_states = 2;
  const PciClocks clocks(bus(PciKind::pci_32_33), slow);
  EXPECT_EQ(clocks.alone(Direction::write, 64), 4 + 16 * 3);
}

TEST(PciClocks, DelayedReadIsRetriedUntilItsDataAreThere) {
  PciProtocol delayed;
  delayed.delayed_read_clocks = 23;  // attempts follow each other in 4 + 1 clocks
  const PciClocks clocks(bus(PciKind::pci_32_33), delayed);
  EXPECT_EQ(clocks.retries_alone(), 5);
  // Five attempts in vain; then 4 clocks of overhead and 16 words, no first wait of the target's.
  EXPECT_EQ(clocks.alone(Direction::read, 64), 5 * 5 + 4 + 16);
  EXPECT_EQ(clocks.alone(Direction::read, 128), 2 * (5 * 5 + 4 + 16));
  EXPECT_EQ(clocks.alone(Direction::write, 64), 4 + 16);  // writes are posted
}

TEST(PciClocks, PciXSplitsADelayedReadInsteadOfRetrying) {
  PciProtocol delayed;
  delayed.delayed_read_clocks = 23;
  const PciClocks clocks(bus(PciKind::pci_x_133), delayed);
  // The request takes 4 clocks, 2 of them after its address; the completer asks 23 clocks after
  // the address, and then moves 8 words of 64 bits.
  EXPECT_EQ(clocks.alone(Direction::read, 64), 2 + 23 + 4 + 8);
}

}  // namespace
}  // namespace hvp::link::pci_protocol_test
