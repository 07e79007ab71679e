#include "models/host/board_system.h"

#include <algorithm>
#include <cmath>

namespace hvp::host {

namespace {

// Rounds the diagonal to a word; one that rounds to nothing would leave the node free. Where the
// matrix is scaled its diagonal is one throughout, and so is the contact's.
std::int32_t word_of(double diagonal, const fixed::System& system) {
  const fixed::QuantisedMatrix& matrix = system.matrix;
  const bool scaled = system.settings.matrix_scaling == fixed::MatrixScaling::diagonal;
  const double limit = std::ldexp(1.0, matrix.bits - 1) - 1;
  const double entry = scaled ? 1.0 : diagonal;
  return static_cast<std::int32_t>(std::clamp(std::round(entry / matrix.scale), 1.0, limit));
}

fixed::Settings settings_of_board(const fixed::System& system, bool increments) {
  fixed::Settings settings = system.settings;
  if (increments) settings.start = fixed::Start::zero;
  return settings;
}

}  // namespace

BoardSystem::BoardSystem(const sparse::BlockMatrix& matrix, const fixed::Settings& settings,
                         double contact_diagonal, bool increments, double headroom)
    : system_(fixed::prepare(matrix, settings, headroom)),
      settings_(settings_of_board(system_, increments)),
      scaling_(system_),
      diagonal_word_(word_of(contact_diagonal, system_)) {}

}  // namespace hvp::host
