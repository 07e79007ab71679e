#include "models/link/pcie.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::link {

namespace {

constexpr std::string_view kUnverified =
    "unverified: enough that the defaults do not throttle a link up to Gen3 x16";

}  // namespace

void Pcie::declare(config::Visitor& v) {
  using config::between;
  using config::Dimension;
  v.choice("generation", generation,
           {{"gen1", PcieGeneration::gen1},
            {"gen2", PcieGeneration::gen2},
            {"gen3", PcieGeneration::gen3},
            {"gen4", PcieGeneration::gen4},
            {"gen5", PcieGeneration::gen5},
            {"gen6", PcieGeneration::gen6}},
           {"2.5, 5, 8, 16, 32 or 64 GT/s a lane", "what FPGA boards of the time have"});
  v.integer("lanes", lanes, {1, 16}, {"1, 2, 4, 8 or 16", "a small board's connector"});
  v.integer("max_payload_bytes", max_payload_bytes, {128, 4096},
            {"largest payload of a packet (MPS)",
             "common on PCs, and what the figures of SIGCOMM'18 are at"});
  v.integer("max_read_request_bytes", max_read_request_bytes, {128, 4096},
            {"largest read request (MRRS)", "the reset value, PCIe 5.0 section 7.5.3.4"});
  v.integer("read_completion_boundary_bytes", read_completion_boundary_bytes, {64, 128},
            {"64 or 128: where a completer may split", "PCIe 5.0 section 2.3.1.1: root ports"});
  v.boolean("completions_of_boundary_size", completions_of_boundary_size,
            {"completions are as small as the boundary allows instead of MPS",
             "older chipsets do; pcie-bench's model has both"});
  v.integer("address_bits", address_bits, {32, 64},
            {"32 or 64: headers of 3 or 4 double words", "pcie-bench's model"});
  v.integer("outstanding_reads", outstanding_reads, {1, 256},
            {"read requests that may be on their way", "tags without extension, PCIe 5.0 2.2.6.2"});
  v.integer("posted_header_credits", posted_header_credits, {1, 1024},
            {"memory writes that the receiver buffers", kUnverified});
  v.integer("posted_data_credits", posted_data_credits, {8, 65'536},
            {"their payload, in units of 16 bytes", kUnverified});
  v.integer("nonposted_header_credits", nonposted_header_credits, {1, 1024},
            {"read requests that the receiver buffers", kUnverified});
  v.choice(
      "dllp_accounting", dllp_accounting,
      {{"published", DllpAccounting::published}, {"symbol-times", DllpAccounting::symbol_times}},
      {"what Ack and UpdateFC cost: 8 bytes of the link in each limit's number of bytes, or "
       "in each limit's symbol times, a byte a lane each",
       "pcie-bench's model, to which the figures of docs/pcie.md belong"});
  v.quantity("link_latency", link_latency_s, Dimension::time, between(0, 1e-3),
             {"one way through both ports, beyond the time on the wire",
              "unverified: with root_complex_latency it makes the read of SIGCOMM'18"});
  v.quantity("credit_return", credit_return_s, Dimension::time, between(0, 1e-3),
             {"from a packet's arrival until its credits are on their way back", "unverified"});
  v.quantity("root_complex_latency", root_complex_latency_s, Dimension::time, between(0, 1e-3),
             {"from a device's read to its first completion at the root port",
              "SIGCOMM'18: 547 ns for 64 bytes over Gen3 x8 on a Xeon E5; 1213 ns on an E3"});
  v.quantity("device_latency", device_latency_s, Dimension::time, between(0, 1e-3),
             {"from the processor's read to its completion at the device",
              "unverified split of an FPGA's 850 ns over Gen3 x8"});
  v.quantity("processor_latency", processor_latency_s, Dimension::time, between(0, 1e-3),
             {"between a processor's read and the root port, both ways together",
              "unverified split of an FPGA's 850 ns over Gen3 x8; over 2 us are reported too"});
  v.quantity(
      "write_gap", write_gap_s, Dimension::time, between(0, 1e-3),
      {"between two uncached stores of the processor, or two lines that its buffer has combined",
       "50 to 300 ns are reported for uncached ones"});
  v.integer("write_combining_bytes", write_combining_bytes, {8, 256},
            {"what a write-combining buffer sends at once", "a cache line of x86"});
}

namespace {

constexpr std::int64_t kPerSecond = 1'000'000'000'000;

std::int64_t quotient_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

// When the last of n packets has left that take `each` and of which `window` may be on their way,
// each for `loop`, counted from the first one's start.
std::int64_t windowed(std::int64_t n, std::int64_t each, std::int64_t last, std::int64_t window,
                      std::int64_t loop) {
  if (window * each >= loop) return (n - 1) * each + last;
  return (n - 1) / window * loop + (n - 1) % window * each + last;
}

}  // namespace

void Pcie::check() const {
  const auto require = [](bool holds, const char* key, int value, const char* expected) {
    if (!holds) throw InputError(key, std::to_string(value) + " bytes: " + expected);
  };
  const auto power_of_two = [](int value) { return (value & (value - 1)) == 0; };
  require(power_of_two(max_payload_bytes), "max_payload_bytes", max_payload_bytes,
          "a power of two is expected");
  require(power_of_two(max_read_request_bytes), "max_read_request_bytes", max_read_request_bytes,
          "a power of two is expected");
  require(read_completion_boundary_bytes == 64 || read_completion_boundary_bytes == 128,
          "read_completion_boundary_bytes", read_completion_boundary_bytes,
          "64 or 128 is expected");
  require(power_of_two(write_combining_bytes), "write_combining_bytes", write_combining_bytes,
          "a power of two is expected");
  if (lanes > 16 || !power_of_two(lanes)) {
    throw InputError("lanes", std::to_string(lanes) + " lanes; expected 1, 2, 4, 8 or 16");
  }
  if (address_bits != 32 && address_bits != 64) {
    throw InputError("address_bits", std::to_string(address_bits) + "; expected 32 or 64");
  }
  if (posted_data_credits * kCreditBytes < max_payload_bytes) {
    throw InputError("posted_data_credits",
                     std::to_string(posted_data_credits) +
                         " credits of 16 bytes do not admit one " +
                         "packet of max_payload_bytes = " + std::to_string(max_payload_bytes));
  }
}

double Pcie::raw_rate() const { return kPicosecondsPerSecond / byte_time(generation, lanes).ps(); }

std::int64_t Pcie::dllp_interval_bytes() const {
  if (flits()) return 0;
  const int limit = dllp_limit(generation, lanes, max_payload_bytes);
  return dllp_accounting == DllpAccounting::published ? limit
                                                      : static_cast<std::int64_t>(limit) * lanes;
}

double Pcie::tlp_rate() const {
  const double skip = static_cast<double>(kSkipBytes) / kSkipInterval;
  if (flits())
    return kPicosecondsPerSecond / byte_time(generation, lanes, kFlitTlpBytes).ps() * (1 - skip);
  const double dllp = static_cast<double>(kDllpBytes) / static_cast<double>(dllp_interval_bytes());
  return raw_rate() * (1 - 2 * dllp - skip);
}

std::int64_t Pcie::tlp_ps(std::int64_t wire_bytes) const {
  return static_cast<std::int64_t>(
      std::ceil(static_cast<double>(wire_bytes) * static_cast<double>(kPerSecond) / tlp_rate()));
}

std::int64_t Pcie::transfer_ps(std::int64_t wire_bytes) const {
  return tlp_ps(flits() ? quotient_up(wire_bytes, kFlitTlpBytes) * kFlitTlpBytes : wire_bytes);
}

// Outside the header stand 8 bytes: start and end of the packet or its token (2), the sequence
// number (2), the LCRC (4). A flit's packets have none of them.
int Pcie::write_header_bytes() const { return (flits() ? 0 : 8) + (address_bits == 64 ? 16 : 12); }
int Pcie::read_header_bytes() const { return write_header_bytes(); }
int Pcie::completion_header_bytes() const { return (flits() ? 0 : 8) + 12; }
int Pcie::message_wire_bytes() const { return (flits() ? 0 : 8) + 16; }

std::int64_t Pcie::packets(std::int64_t bytes) const {
  return quotient_up(bytes, max_payload_bytes);
}
std::int64_t Pcie::requests(std::int64_t bytes) const {
  return quotient_up(bytes, max_read_request_bytes);
}
std::int64_t Pcie::completions(std::int64_t bytes) const {
  const std::int64_t whole = bytes / max_read_request_bytes;
  return whole * quotient_up(max_read_request_bytes, completion_bytes()) +
         quotient_up(bytes % max_read_request_bytes, completion_bytes());
}

std::int64_t Pcie::write_wire_bytes(std::int64_t bytes) const {
  return bytes + packets(bytes) * write_header_bytes();
}
std::int64_t Pcie::request_wire_bytes(std::int64_t bytes) const {
  return requests(bytes) * read_header_bytes();
}
std::int64_t Pcie::completion_wire_bytes(std::int64_t bytes) const {
  return bytes + completions(bytes) * completion_header_bytes();
}

std::int64_t Pcie::link_ps() const { return to_picoseconds(link_latency_s); }
std::int64_t Pcie::credit_return_ps() const { return to_picoseconds(credit_return_s); }
std::int64_t Pcie::completer_ps(PcieSide requester) const {
  return to_picoseconds(requester == PcieSide::device ? root_complex_latency_s : device_latency_s);
}

// Full packets that may be on their way.
std::int64_t Pcie::posted_window() const {
  const int data = posted_data_credits * kCreditBytes / max_payload_bytes;
  return std::min(posted_header_credits, data);
}

double Pcie::write_throughput(std::int64_t bytes_a_write) const {
  const auto payload = static_cast<double>(bytes_a_write);
  const auto wire_bytes = write_wire_bytes(bytes_a_write);
  const double wire = tlp_rate() * payload / static_cast<double>(wire_bytes);
  const std::int64_t packet = std::min<std::int64_t>(bytes_a_write, max_payload_bytes);
  const std::int64_t loop =
      tlp_ps(packet + write_header_bytes()) + 2 * link_ps() + credit_return_ps();
  const std::int64_t data = posted_data_credits / quotient_up(packet, kCreditBytes);
  const auto window = static_cast<double>(std::min<std::int64_t>(posted_header_credits, data));
  return std::min(wire, window * static_cast<double>(packet) * kPicosecondsPerSecond /
                            static_cast<double>(loop));
}

std::int64_t Pcie::round_trip_ps(PcieSide requester, std::int64_t bytes) const {
  return transfer_ps(read_header_bytes()) + 2 * link_ps() + completer_ps(requester) +
         transfer_ps(completion_wire_bytes(bytes));
}

std::int64_t Pcie::request_loop_ps() const {
  return tlp_ps(read_header_bytes()) + 2 * link_ps() + credit_return_ps();
}

double Pcie::read_throughput(PcieSide requester) const {
  const int request = max_read_request_bytes;
  const double wire = tlp_rate() * request / static_cast<double>(completion_wire_bytes(request));
  const auto in_flight = [request](int window, std::int64_t loop_ps) {
    return static_cast<double>(window) * request * kPicosecondsPerSecond /
           static_cast<double>(loop_ps);
  };
  return std::min({wire, in_flight(outstanding_reads, round_trip_ps(requester, request)),
                   in_flight(nonposted_header_credits, request_loop_ps())});
}

std::int64_t Pcie::posted_write_ps(std::int64_t bytes) const {
  const std::int64_t n = packets(bytes);
  const std::int64_t last = bytes - (n - 1) * max_payload_bytes;
  const std::int64_t each = tlp_ps(max_payload_bytes + write_header_bytes());
  const std::int64_t loop = each + 2 * link_ps() + credit_return_ps();
  if (posted_window() * each >= loop) return transfer_ps(write_wire_bytes(bytes)) + link_ps();
  return windowed(n, each, transfer_ps(last + write_header_bytes()), posted_window(), loop) +
         link_ps();
}

std::int64_t Pcie::read_ps(PcieSide requester, std::int64_t bytes) const {
  const std::int64_t n = requests(bytes);
  const std::int64_t last = bytes - (n - 1) * max_read_request_bytes;
  const std::int64_t each = tlp_ps(completion_wire_bytes(max_read_request_bytes));
  const std::int64_t loop = round_trip_ps(requester, max_read_request_bytes);
  const std::int64_t before =
      transfer_ps(read_header_bytes()) + 2 * link_ps() + completer_ps(requester);
  if (outstanding_reads * each >= loop && nonposted_header_credits * each >= request_loop_ps()) {
    return before + transfer_ps(completion_wire_bytes(bytes));
  }
  const std::int64_t tail = transfer_ps(completion_wire_bytes(last));
  return before + std::max(windowed(n, each, tail, outstanding_reads, loop),
                           windowed(n, each, tail, nonposted_header_credits, request_loop_ps()));
}

// Reads whose requests are answered in different times.

namespace {
class SameTime : public CompleterTimes {
 public:
  explicit SameTime(std::int64_t ps) : ps_(ps) {}
  std::int64_t ps(std::int64_t /*request*/) const override { return ps_; }

 private:
  std::int64_t ps_;
};

}  // namespace

// From the first request's start until the last completion is back. A request waits for the one
// before it, for a tag and for a credit; a completion for the ones before it.
std::int64_t Pcie::request_by_request_ps(std::int64_t bytes, const CompleterTimes& times) const {
  const std::int64_t n = requests(bytes);
  const std::int64_t request = tlp_ps(read_header_bytes());
  std::vector<std::int64_t> starts;
  std::vector<std::int64_t> ends;
  std::int64_t wire_free = 0;
  for (std::int64_t k = 0; k < n; ++k) {
    std::int64_t start = k == 0 ? 0 : starts.back() + request;
    if (k >= outstanding_reads) {
      start = std::max(start, ends[static_cast<std::size_t>(k - outstanding_reads)]);
    }
    if (k >= nonposted_header_credits) {
      start = std::max(start, starts[static_cast<std::size_t>(k - nonposted_header_credits)] +
                                  request_loop_ps());
    }
    const std::int64_t payload =
        std::min<std::int64_t>(max_read_request_bytes, bytes - k * max_read_request_bytes);
    const std::int64_t ready = start + request + link_ps() + times.ps(k);
    wire_free = std::max(ready, wire_free) + tlp_ps(completion_wire_bytes(payload));
    starts.push_back(start);
    ends.push_back(wire_free + link_ps());
  }
  return ends.back();
}

// The formula of equal times, and by how much these differ from them: so that equal times are the
// formula's to the picosecond.
std::int64_t Pcie::read_ps(PcieSide requester, std::int64_t bytes,
                           const CompleterTimes& times) const {
  return read_ps(requester, bytes) + request_by_request_ps(bytes, times) -
         request_by_request_ps(bytes, SameTime(completer_ps(requester)));
}

}  // namespace hvp::link
