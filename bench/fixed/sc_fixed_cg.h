#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "models/fixed/quantised_matrix.h"

namespace hvp::fixed::bench {

// Conjugate gradients in SystemC's own fixed-point types, as a model is usually written: every word
// is an sc_fixed<> that rounds (SC_RND_INF) and saturates (SC_SAT_SYM) when it is assigned. Words
// and rules are the thesis' (the defaults of Settings), and the results equal those of every other
// kernel.
class ScFixedCg {
 public:
  explicit ScFixedCg(const QuantisedMatrix& matrix);
  ~ScFixedCg();
  ScFixedCg(const ScFixedCg&) = delete;
  ScFixedCg& operator=(const ScFixedCg&) = delete;

  // Starts from zero and writes the solution's words to x.
  void solve(std::span<const std::int32_t> b, std::span<std::int32_t> x, int iterations);

 private:
  struct Words;
  std::unique_ptr<Words> words_;
};

}  // namespace hvp::fixed::bench
