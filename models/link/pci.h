#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::link {

enum class PciKind { pci_32_33, pci_32_66, pci_64_66, pci_x_133 };

// Conventional PCI as arithmetic: what a transaction costs on the wire. The scenario's table
// [bus]. All times are whole picoseconds, so that simulated time is exact.
//
// A block is cut into bursts; a burst costs its overhead clocks and one clock a data phase
// (PCI Local Bus Specification 3.0, §3.3: an address phase, wait states until the target is
// ready, data phases, and a turnaround cycle). What the processor and its bridge add before the
// bus is reached is a latency of its own, for reads (which the processor waits for) and writes.
struct Pci {
  PciKind kind = PciKind::pci_32_33;
  int burst_bytes = 64;
  int overhead_clocks = 4;
  int read_wait_clocks = 8;
  double read_latency_s = 700e-9;
  double write_latency_s = 100e-9;

  void declare(config::Visitor& v);
  void check() const;

  int width_bytes() const;
  std::int64_t clock_period_ps() const;

  // On the wire: from the request of the bus to its release.
  std::int64_t write_wire_ps(std::int64_t bytes) const;
  std::int64_t read_wire_ps(std::int64_t bytes) const;
  // As the processor sees it: the latency before the wire and the wire.
  std::int64_t write_ps(std::int64_t bytes) const;
  std::int64_t read_ps(std::int64_t bytes) const;

 private:
  std::int64_t wire_ps(std::int64_t bytes, int overhead) const;
};

}  // namespace hvp::link
