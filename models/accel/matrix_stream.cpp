#include "models/accel/matrix_stream.h"

#include "models/accel/board_clocks.h"
#include "models/time/picoseconds.h"

namespace hvp::accel {

namespace {

std::int64_t ceil_div(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

// Of so long a stream: between two pauses it has every − pause, and where it is in that when it
// begins is not known, so that the last pause counts by its share.
Picoseconds pausing(const std::optional<Refresh>& refresh, Picoseconds streaming) {
  if (!refresh) return 0;
  const Picoseconds pause = to_picoseconds(refresh->pause_s);
  const Picoseconds between = to_picoseconds(refresh->every_s) - pause;
  return streaming / between * pause + ceil_div(streaming % between * pause, between);
}

}  // namespace

std::int64_t matrix_stream_clocks(const Architecture& a, std::int64_t packages, int matrix_bits) {
  if (!a.external_memory) return 0;
  const ExternalMemory& memory = *a.external_memory;
  const std::int64_t bits = packages * a.partitions * 3 * a.package * matrix_bits;
  const Picoseconds streaming = ceil_div(bits, memory.width_bits) * to_period(memory.transfers_hz);
  return ceil_div(streaming + pausing(memory.refresh, streaming), a.clock_period_ps());
}

RefreshLoss refresh_loss(const Architecture& a, const Pattern& p, const SolveWork& work) {
  if (!a.external_memory || !a.external_memory->refresh) return {};
  Architecture without = a;
  without.external_memory->refresh.reset();
  RefreshLoss loss;
  loss.clocks = BoardClocks(a, p).solve(work).total() - BoardClocks(without, p).solve(work).total();
  loss.pauses = ceil_div(loss.clocks * a.clock_period_ps(),
                         to_picoseconds(a.external_memory->refresh->pause_s));
  return loss;
}

}  // namespace hvp::accel
