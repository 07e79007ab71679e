#include "tables/hard_cases/scene.h"

#include "models/fixed/spectrum.h"

namespace hvp::tables {

using stability::Flag;
using stability::Flags;

Flags CaseOutcome::flags() const {
  Flags all = words;
  all.merge(matrix);
  all.merge(reference);
  return all;
}

Flags CaseScene::flags_of_matrix(const fixed::System& system) {
  const auto key = std::pair(system.matrix.bits, system.settings.matrix_scaling);
  const auto found = known_.find(key);
  if (found != known_.end()) return found->second;
  Flags flags;
  if (system.matrix.zero_diagonals() > 0) flags.raise(Flag::zero_diagonal);
  if (fixed::non_positive_eigenvalues(system.matrix) != 0) flags.raise(Flag::negative_curvature);
  known_.emplace(key, flags);
  return flags;
}

}  // namespace hvp::tables
