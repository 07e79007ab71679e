#pragma once

#include <cstdint>

#include "models/config/declaration.h"
#include "models/link/direction.h"
#include "models/link/pci.h"

namespace hvp::link {

enum class PciArbitration { round_robin, fixed_priority };

// What several masters, slow targets and delayed reads add to link::Pci, which knows one master
// and bursts without wait states. The defaults add nothing while one master is alone.
struct PciProtocol {
  PciArbitration arbitration = PciArbitration::round_robin;
  int latency_timer_clocks = 64;
  int wait_states = 0;
  int delayed_read_clocks = 0;
  int retry_gap_clocks = 1;

  void declare(config::Visitor& v);
};

// A transaction by clocks: Pci's overhead taken apart, with PciProtocol's numbers.
//
//   arbitration | address | first wait (+ read wait) | n · (1 + wait states) | turnaround
//
// (PCI Local Bus Specification 3.0, §3.3 and §3.4.) Of the overhead one clock is the address phase
// (PCI-X: two, with the attribute phase), one the turnaround cycle, one the decoding of the
// address (DEVSEL# "medium"), and what is left is arbitration on an idle bus. With the default of
// four clocks PCI-X has none left: its next owner is granted before the bus is free.
class PciClocks {
 public:
  PciClocks(const Pci& bus, const PciProtocol& protocol);

  std::int64_t period_ps() const { return period_ps_; }
  int arbitration() const { return arbitration_; }
  int address() const { return address_; }
  int turnaround() const { return turnaround_; }
  // From the address phase to the first data phase.
  int first_wait(Direction direction) const;
  int per_phase() const { return 1 + protocol_.wait_states; }
  // Data phases of a longest burst, after which the target disconnects.
  std::int64_t burst_phases() const { return burst_phases_; }
  // A preempted PCI-X burst ends at an allowable disconnect boundary of 128 bytes (PCI-X Addendum
  // 1.0a); a conventional one after any data phase.
  std::int64_t disconnect_phases() const { return disconnect_phases_; }
  std::int64_t phases(std::int64_t bytes) const { return (bytes + width_ - 1) / width_; }
  bool delays(Direction direction) const;
  // PCI-X answers a slow read with a split completion instead of retries (PCI-X Addendum 1.0a).
  bool splits() const { return splits_; }
  const PciProtocol& protocol() const { return protocol_; }

  // All clocks of a block with nobody else on the bus, from REQ# to the bus' release.
  std::int64_t alone(Direction direction, std::int64_t bytes) const;
  std::int64_t alone_ps(Direction direction, std::int64_t bytes) const {
    return alone(direction, bytes) * period_ps_;
  }
  // Attempts that end in a retry before a delayed read has its data, nobody else on the bus.
  std::int64_t retries_alone() const;

 private:
  std::int64_t delay_alone() const;

  PciProtocol protocol_;
  std::int64_t period_ps_;
  int width_;
  int overhead_;
  int read_wait_;
  int arbitration_;
  int address_;
  int decode_;
  int turnaround_ = 1;
  std::int64_t burst_phases_;
  std::int64_t disconnect_phases_;
  bool splits_;
};

}  // namespace hvp::link
