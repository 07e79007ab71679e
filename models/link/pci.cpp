#include "models/link/pci.h"

#include <string>

#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::link {

void Pci::declare(config::Visitor& v) {
  using config::Dimension;
  v.choice("kind", kind,
           {{"pci-32/33", PciKind::pci_32_33},
            {"pci-32/66", PciKind::pci_32_66},
            {"pci-64/66", PciKind::pci_64_66},
            {"pci-x-133", PciKind::pci_x_133}},
           {"width in bits and clock in MHz", "thesis appendix A: the board sits on PCI"});
  v.integer("burst_bytes", burst_bytes, {4, 4096},
            {"longest burst before the bus is released",
             "one 64-byte cache line, what a host bridge of the time combines"});
  v.integer("overhead_clocks", overhead_clocks, {2, 64},
            {"clocks of a burst that carry no data: arbitration, address, first wait, turnaround",
             "PCI 3.0 section 3.3"});
  v.integer("read_wait_clocks", read_wait_clocks, {0, 16},
            {"further clocks until the target of a read has its first word",
             "PCI 3.0 section 3.5.1.1 allows 16; half of it is assumed"});
  v.quantity("read_latency", read_latency_s, Dimension::time, config::between(0, 1e-3),
             {"from the processor's read to the bus and back, once a transaction",
              "single reads take 0.5 to 1 us (docs/pci.md)"});
  v.quantity("write_latency", write_latency_s, Dimension::time, config::between(0, 1e-3),
             {"from the processor's write to the bus, once a transaction",
              "uncached writes follow each other in 50 to 300 ns (docs/pci.md)"});
}

void Pci::check() const {
  if (burst_bytes % width_bytes() != 0) {
    throw InputError("burst_bytes", "a burst of " + std::to_string(burst_bytes) +
                                        " bytes is no whole number of data phases of " +
                                        std::to_string(width_bytes()) + " bytes");
  }
}

int Pci::width_bytes() const {
  return kind == PciKind::pci_64_66 || kind == PciKind::pci_x_133 ? 8 : 4;
}

std::int64_t Pci::clock_period_ps() const {
  switch (kind) {
    case PciKind::pci_32_33:
      return 30'000;
    case PciKind::pci_x_133:
      return 7'500;
    default:
      return 15'000;
  }
}

std::int64_t Pci::wire_ps(std::int64_t bytes, int overhead) const {
  const std::int64_t bursts = (bytes + burst_bytes - 1) / burst_bytes;
  // Only the last burst can be short, and it is the only one that can end inside a data phase.
  const std::int64_t data_phases = (bytes + width_bytes() - 1) / width_bytes();
  return (bursts * overhead + data_phases) * clock_period_ps();
}

std::int64_t Pci::write_wire_ps(std::int64_t bytes) const {
  return wire_ps(bytes, overhead_clocks);
}

std::int64_t Pci::read_wire_ps(std::int64_t bytes) const {
  return wire_ps(bytes, overhead_clocks + read_wait_clocks);
}

std::int64_t Pci::write_ps(std::int64_t bytes) const {
  return to_picoseconds(write_latency_s) + write_wire_ps(bytes);
}

std::int64_t Pci::read_ps(std::int64_t bytes) const {
  return to_picoseconds(read_latency_s) + read_wire_ps(bytes);
}

}  // namespace hvp::link
