#include "models/link/pci_protocol.h"

#include <algorithm>

namespace hvp::link {

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

// What comes before the tenure that moves a delayed burst: attempts in vain, or for PCI-X the
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
