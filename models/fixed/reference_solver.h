#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/solver.h"

namespace hvp::fixed {

// The solver as the thesis' FPGA computes it, written for the reader: one word, one statement.
// Thesis §4.2 (CG) and §4.3 (Jacobi-PCG) are one loop here; CG is the case z = r.
// docs/fixed-point.md derives the exponents.
class ReferenceSolver final : public Solver {
 public:
  // Checks the settings (InputError) and allocates everything a solve needs.
  ReferenceSolver(const Settings& settings, int block_rows);

  Report solve(const QuantisedMatrix& matrix, Job job, Observer* observer = nullptr) override;

 private:
  void require_fitting(const QuantisedMatrix& matrix, const Job& job) const;
  void invert_diagonal(const QuantisedMatrix& matrix);
  void start(const QuantisedMatrix& matrix, const Job& job);
  // Returns false where there is no step to make.
  bool step(const QuantisedMatrix& matrix, std::span<std::int32_t> x);
  void multiply(const QuantisedMatrix& matrix, std::span<const std::int32_t> vector);
  void precondition();
  std::int64_t inner_product(std::span<const std::int32_t> a, std::span<const std::int32_t> b);
  std::int32_t clamp(std::int64_t value, std::int64_t limit);
  void judge(const QuantisedMatrix& matrix, const Job& job);

  Settings settings_;
  std::int64_t vector_limit_;
  std::int64_t residual_limit_;
  std::int64_t product_limit_;
  // Bits of magnitude: re-scaling up fills the target, re-scaling down starts beyond what is
  // available (for d, its word).
  int direction_target_;
  int residual_target_;
  int residual_available_;

  std::vector<std::int32_t> r_, z_, d_, q_;  // q = A·d
  std::vector<std::int32_t> inverse_diagonal_;
  int preconditioner_shift_ = 0;  // z = r · inverse_diagonal · 2^-shift

  std::int64_t z_r_ = 0;
  std::int64_t d_q_ = 0;
  Coefficient alpha_, beta_;
  int residual_exponent_ = 0;   // f: the residual is r · 2^(rhs_shift - f) in units of A·x
  int direction_exponent_ = 0;  // e: the direction is d · 2^-e in units of z
  bool stopped_ = false;
  double smallest_ = 0;    // zᵀr so far, in units that do not move with the exponent
  int last_progress_ = 0;  // the iteration that reached it
  Report report_;
};

}  // namespace hvp::fixed
