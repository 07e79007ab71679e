#include "models/link/pcie_rate.h"

#include <array>
#include <numeric>

namespace hvp::link {

namespace {

// Megatransfers a second, so that they are whole.
std::int64_t megatransfers(PcieGeneration generation) {
  constexpr std::array<std::int64_t, 6> kRates = {2'500, 5'000, 8'000, 16'000, 32'000, 64'000};
  return kRates[static_cast<std::size_t>(generation)];
}

struct Encoding {
  int payload;
  int all;
};

Encoding encoding(PcieGeneration generation, int flit_bytes) {
  switch (generation) {
    case PcieGeneration::gen1:
    case PcieGeneration::gen2:
      return {8, 10};
    case PcieGeneration::gen6:
      return {flit_bytes, kFlitBytes};
    default:
      return {128, 130};
  }
}

// AckFactor and UpdateFactor in tenths: for MPS of 128, 256, and of 512 and more.
struct Factor {
  int lanes;
  std::array<int, 3> tenths;
};
constexpr std::array<Factor, 5> kFactors = {{{1, {14, 14, 10}},
                                             {2, {14, 14, 10}},
                                             {4, {14, 14, 10}},
                                             {8, {25, 25, 10}},
                                             {16, {30, 30, 20}}}};
constexpr int kTlpOverhead = 28;  // symbols, as the specification's formula has it

int internal_delay(PcieGeneration generation) {
  if (generation == PcieGeneration::gen1) return 19;
  return generation == PcieGeneration::gen2 ? 70 : 115;
}

}  // namespace

double gigatransfers_per_second(PcieGeneration generation) {
  return static_cast<double>(megatransfers(generation)) * 1e-3;
}

ByteTime byte_time(PcieGeneration generation, int lanes, int flit_bytes) {
  const Encoding code = encoding(generation, flit_bytes);
  const std::int64_t numerator = 8'000'000 * static_cast<std::int64_t>(code.all);
  const std::int64_t denominator = megatransfers(generation) * lanes * code.payload;
  const std::int64_t common = std::gcd(numerator, denominator);
  return {numerator / common, denominator / common};
}

int dllp_limit(PcieGeneration generation, int lanes, int max_payload_bytes) {
  int tenths = 0;
  for (const Factor& f : kFactors) {
    if (f.lanes <= lanes)
      tenths = f.tenths[max_payload_bytes <= 128 ? 0 : max_payload_bytes <= 256 ? 1 : 2];
  }
  return (max_payload_bytes + kTlpOverhead) * tenths / (10 * lanes) + internal_delay(generation);
}

}  // namespace hvp::link
