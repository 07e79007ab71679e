#include <algorithm>

#include "models/accel/bits.h"
#include "models/accel/engine_logic.h"

namespace hvp::accel {

namespace {

using fixed::Method;

constexpr int kShiftBits = 7;  // of an aligner's distance
// The ranks of engine.sv that the numbers of a phase's clocks leave over for delays.
constexpr int kLaneRanks = 17;
constexpr int kRowRanks = 13;
constexpr int kMagnitude = kProductBits - 1;
// A block RAM's port: a wider word of a shallow memory is inferred, whose second register is logic.
constexpr int kPortBits = 18;
constexpr int kShallowBits = 9;

// rounding_shift.sv: two shifters with what falls out of them, and a rounding.
UnitLogic aligner(int in, int out, int select, int inputs) {
  return {shifter_cells(in + 1, select, inputs) + in + 1 + 2 * out, 2 * (in + 1) + out + 4};
}

void add(UnitLogic& all, const UnitLogic& one, int times = 1) {
  all.tables += times * one.tables;
  all.registers += times * one.registers;
}

// wide_multiplier.sv: four parts in two ranks, and their sum.
UnitLogic wide_product(int bits) { return {3 * bits, 10 * bits}; }

// Terms of x, d and r beyond those of CG, each aligned and added (multipliers.cpp).
int further_terms(const WordLengths& w) {
  if (w.method == Method::chronopoulos_gear) return w.dynamic_scaling ? 0 : 2;
  if (w.method == Method::pipelined_cg) return w.dynamic_scaling ? 1 : 4;
  return 0;
}

// A row of P⁻¹'s block times r: three products of four parts each, with signs, which are summed
// part by part (block_preconditioner_lane.sv).
UnitLogic block_row() {
  constexpr int kParts = 3 * 4;
  constexpr int kPartBits = kProductBits + 3;
  constexpr int kSumBits = 2 * kProductBits;
  UnitLogic all;
  all.registers += 3 * kMagnitude + 9 + kParts * kMagnitude + 3 * kPartBits + kSumBits + 6;
  all.tables += (2 * kParts + kParts - 3) * kPartBits + 6 * kProductBits + 6 * kSumBits;
  return all;
}

// z = P⁻¹·r and z·r, with what waits beside them.
UnitLogic preconditioner(int inputs, const WordLengths& w, const EngineWords& e) {
  UnitLogic all;
  if (!w.preconditioned()) return all;
  const bool blocks = w.method == Method::block_jacobi_pcg;
  add(all, blocks ? block_row() : wide_product(kMagnitude));
  add(all, aligner(2 * kMagnitude, kProductBits, kShiftBits - 1, inputs));
  add(all, wide_product(kMagnitude));
  all.tables += 5 * kProductBits;
  all.registers += (blocks ? 6 : 7) * kMagnitude + 7;
  if (e.lane_address <= kShallowBits) {
    all.registers += kProductBits + (blocks ? 3 * kProductBits : kMagnitude);
  }
  return all;
}

}  // namespace

UnitLogic lane_logic(int inputs, const Architecture& a, const WordLengths& w,
                     const EngineWords& e) {
  const int v = w.vector_bits;
  const int c = w.coefficient_bits;
  const int r = e.residual;
  const int factor = std::max(v, c) - 1;
  const int scaled = kMagnitude + factor;
  // Places behind the point.
  const int below_d = e.direction > c ? e.direction - c + 1 : 2;
  const int below_q = r > c ? r - c + 1 : 2;
  const int term = std::max(scaled + below_q, e.difference + r - 2);
  const int out = e.direction + 2;
  const int sum = out + 2;

  UnitLogic all;
  // Words and magnitudes, products of d and of A·d's halves, one magnitude a term.
  all.registers += 3 * v + r + 33 + factor + e.difference;
  all.registers += 2 * (v + c - 2) + 2 * (kMagnitude + 2 * factor) + 2 * e.difference + 6;
  all.registers += v + c - 2 + term - std::min(below_q, r - 2) + 2 + kProductBits + v;
  all.tables += 2 * (2 * v + 2 * r + kProductBits) + 7 * e.difference + 2 * (v + 2);
  all.tables += scaled + 2 * (kProductBits + v) + term;
  // What waits beside the multipliers.
  all.registers += 6 * (v + 2) + 3 * (r - 1) + 6 + 9 * v;
  add(all, aligner(v + c - 2 + below_d, out, kShiftBits, inputs));
  add(all, aligner(term, out, kShiftBits, inputs), 1 + further_terms(w));
  add(all, aligner(2 * r - 2, out, kShiftBits, inputs));
  // Sums, clamps, r·r.
  all.registers += 7 + 2 * sum + v + 2 * r;
  all.tables += 13 * sum + 3 * v + 2 * r + further_terms(w) * 2 * sum;
  if (r > v) {
    add(all, {0, wide_product(r - 1).registers});
  } else {
    all.registers += 2 * (2 * r - 2);
  }
  // Until they are written, and a row of A·d.
  all.registers += (2 * v + r) * std::max(0, a.phase_clocks() - kLaneRanks) + v;
  all.registers += e.sum + 2 + kProductBits * (1 + std::max(0, a.phase_clocks() - kRowRanks));
  all.tables += 2 * e.sum + (e.dropped > 0 ? e.sum : 0) + e.sum / 3 + 2 * kProductBits;
  // The host's words.
  all.tables += 3 * v + 10;
  if (e.lane_address <= kShallowBits) {
    all.registers += kProductBits + (v > kPortBits ? 2 * v : 0) + (r > kPortBits ? 2 * r : 0);
  }
  add(all, preconditioner(inputs, w, e));
  return all;
}

UnitLogic sums_logic(int inputs, const Architecture& a, const WordLengths& w,
                     const EngineWords& e) {
  const int lanes = a.nodes_per_clock;
  const int words = 3 * lanes;
  const int product = kProductBits + w.vector_bits;
  const int square = 2 * e.residual;
  const int counter = bits_to_number(9 * lanes + 1);
  // The words of all levels of a tree of comparisons, and what there was.
  int kept = 1;
  for (int level = words; level > 1; kept += level) level = ceil_div(level, 2);

  UnitLogic all;
  const int magnitudes = kMagnitude + e.residual - 1 + w.vector_bits - 1;
  all.registers += 3 * lanes + (words + kept) * magnitudes;
  all.tables += 4 * words * magnitudes;
  all.registers += lanes * (product + 2) + product + 3 + e.dot;
  all.tables += words * (product + 2) + lanes * (product + 3) + e.dot;
  all.registers += lanes * square + square + 3 + e.squares;
  all.tables += words * square + lanes * (square + 3) + e.squares;
  all.registers += e.difference + (lanes + 1) * counter + 32;
  all.tables += e.difference * gate_cells(words + 1, inputs);
  all.tables += 6 * words + 4 * counter * lanes + 32;
  if (w.preconditioned()) {
    all.registers += kept * kMagnitude + square + 3 + e.squares;
    all.tables += words * (2 * kMagnitude + square) + 2 * e.squares + 2 * kMagnitude;
  }
  return all;
}

UnitLogic between_logic(int inputs, const Architecture& a, const WordLengths& w,
                        const EngineWords& e) {
  const int lanes = a.nodes_per_clock;
  const int clocks = a.phase_clocks();
  const int row_ranks = std::max(0, clocks - 11);
  const int node_ranks = std::max(clocks - 4, w.preconditioned() ? 19 : 0);
  UnitLogic all;
  // Nodes and rows on their way through the ranks, and the words of d at a row's own node.
  all.registers += node_ranks * e.node + lanes * (clocks - 1) + row_ranks * lanes * (1 + e.node);
  all.registers += 6 * lanes * w.vector_bits + 3 * (e.node + 1) + lanes;
  all.tables += 3 * lanes * w.vector_bits * multiplexer_cells(2, inputs);
  // A row of a package and an index word that the host collects, counters of packages and waits.
  all.registers += a.package * w.matrix_bits + e.package_nodes * e.node;
  all.registers +=
      std::int64_t{a.partitions} * (e.package + 1) + 64 + 4 * bits_to_number(a.partitions + 1);
  all.tables +=
      3 * std::int64_t{a.partitions} * a.package * w.matrix_bits * multiplexer_cells(2, inputs);
  all.tables += 200;
  // What all partitions have alike is there once: the words of d that are written. |r| serves the
  // preconditioner and the largest magnitude.
  all.registers -= (a.partitions - 1) * std::int64_t{3 * lanes * w.vector_bits + 5 + lanes};
  if (w.preconditioned()) {
    all.registers += 10 * lanes - 3 * lanes * std::int64_t{kMagnitude};
  }
  return all;
}

}  // namespace hvp::accel
