#include "models/link/pci.h"

#include <algorithm>
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

namespace {

constexpr int kDisconnectBytes = 128;  // PCI-X

}  // namespace

void PciProtocol::declare(config::Visitor& v) {
  v.choice("arbitration", arbitration,
           {{"round-robin", PciArbitration::round_robin},
            {"fixed-priority", PciArbitration::fixed_priority}},
           {"who is next of several masters; fixed-priority: in the order of their numbers",
            "PCI 3.0 section 3.4 asks for fairness and leaves the rule open"});
  v.integer("latency_timer_clocks", latency_timer_clocks, {0, 255},
            {"clocks that a master keeps the bus although another one waits",
             "what Linux writes where the firmware has left less than 16"});
  v.integer("wait_states", wait_states, {0, 8},
            {"clocks between two data phases, by master or target",
             "none; PCI 3.0 section 3.5.1.2 allows 8 a phase"});
  v.integer("delayed_read_clocks", delayed_read_clocks, {0, 100'000},
            {"clocks until a target has what a burst reads, while it retries the master; 0: it "
             "answers at once",
             "none; PCI 3.0 section 3.3.3.3"});
  v.integer("retry_gap_clocks", retry_gap_clocks, {1, 1'000},
            {"clocks after the turnaround before a retried master requests again",
             "PCI 3.0 section 3.4.1: REQ# rests two clocks, one of them the idle one"});
}

PciClocks::PciClocks(const Pci& bus, const PciProtocol& protocol)
    : protocol_(protocol),
      period_ps_(bus.clock_period_ps()),
      width_(bus.width_bytes()),
      overhead_(bus.overhead_clocks),
      read_wait_(bus.read_wait_clocks),
      splits_(bus.kind == PciKind::pci_x_133) {
  address_ = std::min(splits_ ? 2 : 1, overhead_ - turnaround_);
  const int rest = overhead_ - turnaround_ - address_;
  decode_ = std::min(rest, 1);
  arbitration_ = rest - decode_;
  burst_phases_ = bus.burst_bytes / width_;
  disconnect_phases_ = splits_ ? kDisconnectBytes / width_ : 1;
}

int PciClocks::first_wait(Direction direction) const {
  return decode_ + (direction == Direction::read && !delays(direction) ? read_wait_ : 0);
}

bool PciClocks::delays(Direction direction) const {
  return direction == Direction::read && protocol_.delayed_read_clocks > 0;
}

std::int64_t PciClocks::retries_alone() const {
  if (protocol_.delayed_read_clocks == 0) return 0;
  if (splits_) return 1;
  const std::int64_t attempt = overhead_ + protocol_.retry_gap_clocks;
  return (protocol_.delayed_read_clocks + attempt - 1) / attempt;
}

// The clocks before the tenure that moves a delayed burst: attempts in vain, or for PCI-X the
// request and the time until the completer asks for the bus itself.
std::int64_t PciClocks::delay_alone() const {
  if (splits_) {
    return overhead_ + std::max(0, protocol_.delayed_read_clocks - decode_ - turnaround_);
  }
  return retries_alone() * (overhead_ + protocol_.retry_gap_clocks);
}

std::int64_t PciClocks::alone(Direction direction, std::int64_t bytes) const {
  const std::int64_t data = phases(bytes);
  const std::int64_t bursts = (data + burst_phases_ - 1) / burst_phases_;
  std::int64_t burst = arbitration_ + address_ + first_wait(direction) + turnaround_;
  if (delays(direction)) burst += delay_alone();
  return bursts * burst + data * per_phase();
}

}  // namespace hvp::link
