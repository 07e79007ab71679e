#pragma once

#include <cstdint>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/solver.h"

namespace hvp::fixed::test {

// A matrix of words given row by row (a multiple of three rows), all blocks stored.
QuantisedMatrix dense_matrix(const std::vector<std::vector<std::int32_t>>& rows, int bits);

// Everything an observer can see of one iteration.
struct Words {
  std::vector<std::int32_t> x, r, z, d, q;
  Int128 d_q = 0, z_r = 0;
  Coefficient alpha, beta;
  int residual_exponent = 0, direction_exponent = 0;
  friend bool operator==(const Words&, const Words&) = default;
};

class Recorder : public Observer {
 public:
  void iteration(const IterationState& s) override;
  std::vector<Words> history;
};

// Solves with the reference solver, from the given guess.
struct Solution {
  Report report;
  std::vector<std::int32_t> x;
  std::vector<Words> history;
};
Solution solve(const Settings& settings, const QuantisedMatrix& matrix,
               const std::vector<std::int32_t>& b, std::vector<std::int32_t> guess = {});

}  // namespace hvp::fixed::test
