#include "models/link/pcie.h"

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

}  // namespace hvp::link
