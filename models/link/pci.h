#pragma once

#include <cstdint>

#include "models/config/declaration.h"
#include "models/link/direction.h"

namespace hvp::link {

enum class PciKind { pci_32_33, pci_32_66, pci_64_66, pci_x_133 };

// Conventional PCI as arithmetic: the time of a transaction on the wire. The scenario's table
// [bus]. All times are whole picoseconds, so that simulated time is exact.
//
// A block is cut into bursts; a burst costs its overhead clocks and one clock a data phase
// (PCI Local Bus Specification 3.0, §3.3: an address phase, wait states until the target is
// ready, data phases, and a turnaround cycle). The processor and its bridge add a latency before
// the bus, one for reads (for which the processor waits) and one for writes.
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

  // The time on the wire, from the request of the bus to its release.
  std::int64_t write_wire_ps(std::int64_t bytes) const;
  std::int64_t read_wire_ps(std::int64_t bytes) const;
  // The processor's time: the latency before the wire and the time on the wire.
  std::int64_t write_ps(std::int64_t bytes) const;
  std::int64_t read_ps(std::int64_t bytes) const;

 private:
  std::int64_t wire_ps(std::int64_t bytes, int overhead) const;
};

enum class PciArbitration { round_robin, fixed_priority };

// The settings for several masters, slow targets and delayed reads, beyond link::Pci with its one
// master and bursts without wait states. The defaults add nothing while one master is alone.
struct PciProtocol {
  PciArbitration arbitration = PciArbitration::round_robin;
  int latency_timer_clocks = 64;
  int wait_states = 0;
  int delayed_read_clocks = 0;
  int retry_gap_clocks = 1;

  void declare(config::Visitor& v);
};

// The clocks of a transaction: Pci's overhead by its parts, with PciProtocol's numbers.
//
//   arbitration | address | first wait (+ read wait) | n · (1 + wait states) | turnaround
//
// (PCI Local Bus Specification 3.0, §3.3 and §3.4.) Of the overhead one clock is the address phase
// (PCI-X: two, with the attribute phase), one the turnaround cycle, one the decoding of the
// address (DEVSEL# "medium"), and the rest is arbitration on an idle bus. With the default of four
// clocks PCI-X has none left: its next owner is granted before the bus is free.
class PciClocks {
 public:
  PciClocks(const Pci& bus, const PciProtocol& protocol);

  std::int64_t period_ps() const { return period_ps_; }
  int arbitration() const { return arbitration_; }
  int address() const { return address_; }
  int turnaround() const { return turnaround_; }
  // The clocks from the address phase to the first data phase.
  int first_wait(Direction direction) const;
  int per_phase() const { return 1 + protocol_.wait_states; }
  // The data phases of the longest burst, after which the target disconnects.
  std::int64_t burst_phases() const { return burst_phases_; }
  // A preempted PCI-X burst ends at an allowable disconnect boundary of 128 bytes (PCI-X Addendum
  // 1.0a); a conventional one after any data phase.
  std::int64_t disconnect_phases() const { return disconnect_phases_; }
  std::int64_t phases(std::int64_t bytes) const { return (bytes + width_ - 1) / width_; }
  bool delays(Direction direction) const;
  // PCI-X answers a slow read with a split completion instead of retries (PCI-X Addendum 1.0a).
  bool splits() const { return splits_; }
  const PciProtocol& protocol() const { return protocol_; }

  // All clocks of a block without other masters, from REQ# to the release of the bus.
  std::int64_t alone(Direction direction, std::int64_t bytes) const;
  std::int64_t alone_ps(Direction direction, std::int64_t bytes) const {
    return alone(direction, bytes) * period_ps_;
  }
  // The attempts that end in a retry before a delayed read has its data, without other masters.
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
