#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/reference_machine.h"
#include "models/fixed/reference_preconditioner.h"
#include "models/fixed/solver.h"

namespace hvp::fixed {

// The solver as the thesis' FPGA computes it, written for the reader: one word, one statement.
// Thesis §4.2 (CG) and §4.3 (PCG) are one loop here; CG is the case z = r. The two variants with
// fewer synchronisations have a loop each. docs/fixed-point.md derives the exponents.
class ReferenceSolver final : public Solver {
 public:
  // Checks the settings (InputError).
  explicit ReferenceSolver(const Settings& settings);
  ReferenceSolver(const ReferenceSolver&) = delete;
  ReferenceSolver& operator=(const ReferenceSolver&) = delete;

  using Solver::solve;
  void load(const QuantisedMatrix& matrix) override;
  void update(int node) override;
  Report solve(Job job, Observer* observer = nullptr) override;

 private:
  enum class Step { made, stopped };

  void require_fitting(const QuantisedMatrix& matrix) const;
  bool pipelined() const { return settings_.method == Method::pipelined_cg; }
  bool by_recurrence() const {
    return pipelined() || settings_.method == Method::chronopoulos_gear;
  }

  void start(const Job& job);
  void form_residual(const Job& job);
  void start_recurrences();
  void form_recurrences();
  Step step(const Job& job);                // thesis §4.2, §4.3
  Step step_by_recurrence(const Job& job);  // Chronopoulos-Gear, pipelined

  bool reached() const;
  bool nothing_left();
  bool negative_curvature();
  bool replaces();
  void form_alpha();
  void form_beta(const ScaledScalar& z_r_old);
  void follow_curvature(const ScaledScalar& delta);
  void advance_solution(const Job& job);
  void advance(ScaledVector& r, const ScaledVector& q, int bits, int target, int available);
  void follow(ScaledVector& d, const ScaledVector& z);
  void follow_product(ScaledVector& q, const ScaledVector& w, int vector_exponent);
  void multiply(std::span<const std::int32_t> vector, int exponent, ScaledVector& product);
  void fill(const ScaledVector& from, ScaledVector& to);
  void precondition();

  void observe(const Job& job, Observer* observer) const;
  void judge(const Job& job);

  Settings settings_;
  Report report_;
  ReferenceMachine machine_{settings_, report_};
  ReferencePreconditioner preconditioner_;
  const QuantisedMatrix* matrix_ = nullptr;

  // Bits of magnitude. Re-scaling up fills the target; re-scaling down starts beyond the available
  // bits (for d, those of its word).
  int direction_target_;
  int residual_target_;
  int residual_available_;

  ScaledVector r_, z_, d_, q_;  // q = A·d
  ScaledVector w_, n_, v_;      // A·r; A·w; A·q by recurrence (IterationState)
  ScaledVector product_;        // A·x and other products, before they are scaled

  // α is mantissa · 2^exponent, exponents of vectors included.
  Coefficient alpha_, beta_;
  Coefficient shown_alpha_;
  ScaledScalar z_r_, d_q_;
  bool stopped_ = false;
  std::vector<std::int32_t> b_;  // the right-hand side, in its word
  double rhs_square_ = 0;        // ‖b‖²
  double residual_squares_ = 0;  // ‖b - A·x‖² when r was last formed
  double smallest_ = 0;          // the smallest zᵀr so far
  int last_progress_ = 0;        // the iteration that reached it
};

}  // namespace hvp::fixed
