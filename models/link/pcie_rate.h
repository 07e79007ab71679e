#pragma once

#include <cstdint>

namespace hvp::link {

enum class PcieGeneration { gen1, gen2, gen3, gen4, gen5, gen6 };

// A byte's time of numerator/denominator picoseconds, which is no whole number.
struct ByteTime {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;

  double ps() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
};

// The transfer rate of a lane: 2.5, 5, 8, 16, 32 and 64 GT/s.
double gigatransfers_per_second(PcieGeneration generation);
// The time of a byte behind the encoding, on all lanes together: 8b/10b (Gen1, Gen2), 128b/130b
// (Gen3 to Gen5). Gen6 sends flits of 256 bytes; with `flit_bytes` of them counted (242 without CRC
// and FEC, 236 of transaction layer) the others are overhead. `flit_bytes` is for Gen6 alone.
ByteTime byte_time(PcieGeneration generation, int lanes, int flit_bytes = 242);

// The symbol times within which a receiver acknowledges, and within which it returns credits; the
// specification has the same limit for both:
//   ⌊(MPS + 28) · factor / lanes + delay⌋
// with the factor by width and MPS and the receiver's internal delay by generation (PCI Express
// Base Specification 5.0, tables 2-46 to 2-48 and 3-7 to 3-9; §3.6.3.1). Gen6 acknowledges in its
// flits and has no limit; Gen5's is a guess of pcie-bench's model, which this function follows.
int dllp_limit(PcieGeneration generation, int lanes, int max_payload_bytes);

// A flit's bytes: 236 of TLPs, 6 of data link layer, 8 of CRC, 6 of FEC (PCI Express Base
// Specification 6.0; PCI-SIG, PCIe 6.0 webinar Q&A).
inline constexpr int kFlitBytes = 256;
inline constexpr int kFlitTlpBytes = 236;
inline constexpr int kFlitTlpAndDlpBytes = 242;
// The bytes of an Ack or UpdateFC: 2 bytes of framing, 4 of content, 2 of CRC.
inline constexpr int kDllpBytes = 8;
// SKIP ordered sets for clock compensation: kSkipBytes in kSkipInterval bytes.
inline constexpr int kSkipBytes = 4;
inline constexpr int kSkipInterval = 1538;

}  // namespace hvp::link
