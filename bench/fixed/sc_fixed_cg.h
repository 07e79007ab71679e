#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "models/fixed/quantised_matrix.h"

namespace hvp::fixed::bench {

// Conjugate gradients in SystemC's own fixed-point types, as a model is usually written: every
// word an sc_fixed<> that rounds (SC_RND_INF) and saturates (SC_SAT_SYM) when it is assigned. The
// thesis' words and rules (Settings' defaults); the same words as every other kernel.
class ScFixedCg {
 public:
  explicit ScFixedCg(const QuantisedMatrix& matrix);
  ~ScFixedCg();
  ScFixedCg(const ScFixedCg&) = delete;
  ScFixedCg& operator=(const ScFixedCg&) = delete;

  // From zero; x has the solution's words.
  void solve(std::span<const std::int32_t> b, std::span<std::int32_t> x, int iterations);

 private:
  struct Words;
  std::unique_ptr<Words> words_;
};

}  // namespace hvp::fixed::bench
