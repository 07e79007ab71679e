#include "models/accel/matrix_stream.h"

#include "models/time/picoseconds.h"

namespace hvp::accel {

namespace {

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

}  // namespace

std::int64_t matrix_stream_clocks(const Architecture& a, std::int64_t packages, int matrix_bits) {
  if (!a.external_memory) return 0;
  const ExternalMemory& memory = *a.external_memory;
  const std::int64_t bits = packages * a.partitions * 3 * a.package * matrix_bits;
  const Picoseconds streaming = ceil_div(bits, memory.width_bits) * to_period(memory.transfers_hz);
  return ceil_div(streaming, a.clock_period_ps());
}

}  // namespace hvp::accel
