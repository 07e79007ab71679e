#pragma once

#include <cstdint>

#include "models/config/declaration.h"
#include "models/link/direction.h"
#include "models/link/pcie_rate.h"

namespace hvp::link {

// The bytes of a data credit: four double words (PCI Express Base Specification, section 2.6.1).
inline constexpr int kCreditBytes = 16;

// The conversion of dllp_limit() to bytes.
enum class DllpAccounting {
  published,     // 8 bytes in `limit` bytes of the link, as pcie-bench's model has it
  symbol_times,  // 8 bytes in `limit` symbol times, in each of which every lane carries a byte
};

// The end of the link that requests: the processor reads and writes the device through the root
// port, the device reads and writes the host's memory.
enum class PcieSide { root, device };

// The completer's time for each request of a read, if requests differ: from the request's arrival
// until its first completion, in ps. It is a function of the request's number within the read, from
// 0, so that it may be asked for again.
class CompleterTimes {
 public:
  virtual ~CompleterTimes() = default;
  virtual std::int64_t ps(std::int64_t request) const = 0;
};

// A PCI Express link between a root port and one device, as arithmetic. All times are whole
// picoseconds, rounded up. Sizes are bytes of payload; `bytes on the wire` are those of TLPs with
// their framing, sequence number and LCRC, before the link layer's share.
//
// Sources: pcie-bench's model (Neugebauer et al., SIGCOMM'18) for packets and rates; PCI Express
// Base Specification 5.0, §2.2 (headers), §2.3.1.1 (completions split at the read completion
// boundary), §2.6.1 (credits). docs/pcie.md derives every formula.
struct Pcie {
  PcieGeneration generation = PcieGeneration::gen3;
  int lanes = 4;
  int max_payload_bytes = 256;
  int max_read_request_bytes = 512;
  int read_completion_boundary_bytes = 64;
  bool completions_of_boundary_size = false;
  int address_bits = 64;
  int outstanding_reads = 32;
  int posted_header_credits = 64;
  int posted_data_credits = 1024;
  int nonposted_header_credits = 64;
  DllpAccounting dllp_accounting = DllpAccounting::published;
  double link_latency_s = 125e-9;
  double credit_return_s = 50e-9;
  double root_complex_latency_s = 282e-9;
  double device_latency_s = 300e-9;
  double processor_latency_s = 300e-9;
  double write_gap_s = 100e-9;
  int write_combining_bytes = 64;

  void declare(config::Visitor& v);
  // Throws InputError for a size that is no power of two, a width that does not exist, or credits
  // that are too few for one packet.
  void check() const;

  bool flits() const { return generation == PcieGeneration::gen6; }

  // Bytes a second in one direction: raw_rate() behind the encoding (Gen6: 242 of 256 bytes),
  // tlp_rate() without the share of Ack, UpdateFC and SKIP. Gen6's data link layer has its place in
  // the flit.
  double raw_rate() const;
  double tlp_rate() const;
  // The time of TLP bytes back to back, that share included.
  std::int64_t tlp_ps(std::int64_t wire_bytes) const;
  // The time of one transfer on an idle link; Gen6 fills its last flit.
  std::int64_t transfer_ps(std::int64_t wire_bytes) const;
  // The bytes of the link between two Ack DLLPs, or two UpdateFC DLLPs; 0: there are none.
  std::int64_t dllp_interval_bytes() const;

  int write_header_bytes() const;  // header of a memory write TLP, framing included
  int read_header_bytes() const;
  int completion_header_bytes() const;
  // The bytes of a message TLP, such as INTx: a header of four double words alone (PCIe 5.0
  // §2.2.8).
  int message_wire_bytes() const;
  std::int64_t packets(std::int64_t bytes) const;      // memory writes
  std::int64_t requests(std::int64_t bytes) const;     // memory reads
  std::int64_t completions(std::int64_t bytes) const;  // completions of an aligned block
  int completion_bytes() const {
    return completions_of_boundary_size ? read_completion_boundary_bytes : max_payload_bytes;
  }

  // Bytes on the wire; completion_wire_bytes() counts the direction of a read's data alone.
  std::int64_t write_wire_bytes(std::int64_t bytes) const;
  std::int64_t request_wire_bytes(std::int64_t bytes) const;
  std::int64_t completion_wire_bytes(std::int64_t bytes) const;

  // Payload in bytes a second in the steady state: the wire's, or that which the credits or the
  // reads in flight allow in a round trip.
  double write_throughput(std::int64_t bytes_a_write) const;
  double read_throughput(PcieSide requester) const;

  // The time on an idle link from the first TLP's start to the last byte's arrival, at the other
  // side for a posted write, back at the requester for a read.
  std::int64_t posted_write_ps(std::int64_t bytes) const;
  std::int64_t read_ps(PcieSide requester, std::int64_t bytes) const;
  // The same with the completer's time for each request; completions keep the order of the
  // requests.
  std::int64_t read_ps(PcieSide requester, std::int64_t bytes, const CompleterTimes& times) const;
  // The completer's time between a request's arrival and its first completion.
  std::int64_t completer_ps(PcieSide requester) const;
  std::int64_t link_ps() const;
  std::int64_t credit_return_ps() const;

 private:
  std::int64_t round_trip_ps(PcieSide requester, std::int64_t bytes) const;
  std::int64_t request_by_request_ps(std::int64_t bytes, const CompleterTimes& times) const;
  std::int64_t request_loop_ps() const;
  std::int64_t posted_window() const;
};

}  // namespace hvp::link
