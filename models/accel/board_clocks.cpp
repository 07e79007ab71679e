#include "models/accel/board_clocks.h"

#include <utility>

namespace hvp::accel {

BoardClocks::BoardClocks(const Architecture& a, Pattern p)
    : architecture_(a), pattern_(std::move(p)), units_(unit_clocks(a, pattern_)) {
  if (a.several) several_.emplace(a, pattern_);
}

SolveCycles BoardClocks::solve(const SolveWork& work) const {
  if (several_) return several_->solve(work).solve;
  return solve_cycles(passes_of(architecture_, units_, work), work);
}

std::int64_t BoardClocks::node_update(int node, std::span<const int> neighbours,
                                      fixed::Method method) const {
  if (several_) return several_->node_update(pattern_, node, neighbours, method);
  return node_update_cycles(architecture_, pattern_, node, neighbours, method);
}

std::int64_t BoardClocks::load(fixed::Method method) const {
  if (several_) return several_->load(pattern_, method);
  return load_cycles(architecture_, pattern_, method);
}

}  // namespace hvp::accel
