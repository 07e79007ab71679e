#include "models/accel/engine_words.h"

#include <algorithm>

#include "models/accel/bits.h"

namespace hvp::accel {

namespace {

// As vp/fpga/rtl/engine/ has them: the largest static shift; bits of P⁻¹ behind the point; growth
// of a row's sum (thesis §5.5).
constexpr int kStaticShift = 15;
constexpr int kInverseBits = 18;
constexpr int kGrowthBits = 4;

}  // namespace

EngineWords engine_words(const Architecture& a, const WordLengths& w, const SystemSize& s) {
  EngineWords e;
  e.node = bits_to_number(s.direction_nodes);
  e.lane_address = std::max(1, e.node - levels_over(a.nodes_per_clock));
  e.bank_address = std::max(1, e.node - levels_over(a.direction_banks));
  e.package = bits_to_number(s.packages);
  e.queue = bits_to_number(a.result_queue);
  e.package_nodes = nodes_in_package(a.package);
  e.index = (e.package_nodes + 1) * e.node + 3;
  e.product = w.matrix_bits + w.vector_bits;
  const int longest = e.node > kRowBlockBits ? e.node : e.node + 1;
  e.sum = std::max(e.product + longest, kProductBits + 1);
  e.residual = w.preconditioned() ? kProductBits : w.vector_bits;
  e.dropped = std::max(0, e.product + kGrowthBits - kProductBits);
  e.direction = w.vector_bits;
  if (w.preconditioned()) {
    const int scale = w.matrix_bits + kInverseBits;
    const int inverse = std::min(scale + 1, kProductBits - 1);
    e.direction = kProductBits + std::max(0, e.dropped + inverse - scale);
  }
  e.difference = std::max(w.vector_bits - 1 + kStaticShift, kProductBits - 1 + e.dropped) + 1;
  e.dot = kProductBits + w.vector_bits + e.node + 1;
  e.squares = 2 * e.residual + e.node;
  return e;
}

}  // namespace hvp::accel
