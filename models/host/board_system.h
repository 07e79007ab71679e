#pragma once

#include <cstdint>

#include "models/fixed/settings.h"
#include "models/fixed/system.h"
#include "models/sparse/block_matrix.h"

namespace hvp::host {

// A system as the board has it: the matrix in words, the settings of the board's solver, and the
// conversion of vectors. Only a solver on the board has one: a host that solves needs no words.
class BoardSystem {
 public:
  // `contact_diagonal` is the value on the diagonal of a contact node, N/m. `increments`: the board
  // is asked for increments, and starts each solve at zero. The words leave room for entries
  // `headroom` times the largest. Throws InputError for a matrix that
  // cannot be put into words.
  BoardSystem(const sparse::BlockMatrix& matrix, const fixed::Settings& settings,
              double contact_diagonal, bool increments, double headroom = 1);

  // Replaces the words by those of a matrix with the same pattern, at the same scale, unless one of
  // them does not fit.
  fixed::Fit renew(const sparse::BlockMatrix& matrix) {
    return fixed::replace_values(matrix, system_);
  }

  const fixed::System& words() const { return system_; }
  const fixed::QuantisedMatrix& matrix() const { return system_.matrix; }
  // With the static shift in force, and the start of a solve.
  const fixed::Settings& settings() const { return settings_; }
  const fixed::Scaling& scaling() const { return scaling_; }
  // The word on the diagonal of a contact node.
  std::int32_t diagonal_word() const { return diagonal_word_; }

 private:
  fixed::System system_;
  fixed::Settings settings_;
  fixed::Scaling scaling_;
  std::int32_t diagonal_word_;
};

}  // namespace hvp::host
