#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "models/fixed/fast/arithmetic.h"
#include "models/fixed/fast/packed_matrix.h"
#include "models/fixed/fast/passes.h"
#include "models/fixed/fast/preconditioner.h"
#include "models/fixed/solver.h"
#include "models/fixed/stop_test.h"

namespace hvp::fixed::fast {

// Computes the words of ReferenceSolver (docs/fixed-point.md) by passes over whole vectors. A pass
// of the kernel is taken if the known magnitudes prove that nothing inside it can overflow;
// otherwise the exact pass, which can do everything.
class FastSolver final : public Solver {
 public:
  // Checks the settings (InputError). `passes` has to outlive the solver.
  FastSolver(const Settings& settings, const Passes& passes);

  using Solver::solve;
  void load(const QuantisedMatrix& matrix) override;
  void update(int node) override;
  Report solve(Job job, Observer* observer = nullptr) override;

  // The bytes of the packed matrix, which a product reads once.
  std::size_t matrix_bytes() const { return packed_.bytes(); }
  // True if every row's sum fits 32 bits, so that the narrow layout is in use.
  bool paired() const { return packed_.paired(); }

 private:
  enum class Step { made, stopped };

  // A vector in the order of the packed matrix; the words behind the last row are zero.
  struct Vector {
    Aligned<std::int32_t> word;
    int exponent = 0;
    std::uint64_t largest = 0;  // magnitude
  };
  struct Scalar {
    Int128 word = 0;
    int exponent = 0;
  };

  // One term of a new vector: factor · v · 2^exponent.
  struct Term {
    const Vector& vector;
    int exponent = 0;
    std::int32_t factor = 1;
  };
  enum class Wants { nothing, squares };

  void require_fitting(const QuantisedMatrix& matrix) const;
  bool preconditioned() const { return settings_.preconditioned(); }
  bool pipelined() const { return settings_.method == Method::pipelined_cg; }
  bool by_recurrence() const {
    return pipelined() || settings_.method == Method::chronopoulos_gear;
  }
  const Vector& z() const { return preconditioned() ? z_ : r_; }

  // fast_solver.cpp: the algorithm.
  void start(const Job& job);
  void form_residual();
  void form_recurrences();
  Step step();
  Step step_by_recurrence();
  bool reached();
  bool negative_curvature();
  bool replaces();
  void form_alpha();
  void form_beta(const Scalar& z_r_old);
  void follow_curvature(const Scalar& delta);
  void advance(Vector& r, const Vector& q, int bits, int target, int available, Wants wants);
  void advance_solution();
  Term along(const Vector& d) const;
  int rescaling_of_direction(const Vector& d, const Vector& z) const;
  void follow(Vector& d, const Vector& z);
  void advance_solution_and_follow();
  void follow_product(Vector& q, const Vector& w, int vector_exponent);
  void fill(const Vector& from, Vector& to);
  void precondition();
  void observe(Observer* observer);
  double true_residual();
  void judge(const Job& job);

  // fast_vectors.cpp: the passes and the choice between them.
  void take(const Job& job);
  void take(std::span<const std::int32_t> words, int bits, Vector& to);
  void hand_over(std::span<std::int32_t> solution) const;
  Terms terms_of(Vector& out, const Term& a, const Term& b, int bits, Wants wants) const;
  void write(Vector& out, const Term& a, const Term& b, int bits, Wants wants = Wants::nothing);
  void write_both(Vector& first, const Term& first_b, Vector& second, const Term& second_a,
                  const Term& second_b, int bits);
  bool prove(Terms& terms, const Term& a, const Term& b) const;
  Found write_exactly(Vector& out, const Term& a, const Term& b, int bits) const;
  std::optional<Int128> subtract_from_rhs(Vector& product);
  double square_sum(const Vector& vector, Int128 exact) const;
  bool dot_fits(std::uint64_t a, std::uint64_t b) const;
  Int128 dot(const Vector& a, Vector& b);
  Int128 multiply(const Vector& vector, int exponent, Vector& product);
  Int128 sum_rows(const Vector& vector, Vector& paired);
  void write_sums(Vector& out, int exponent, int bits, Wants wants = Wants::nothing);
  void count(std::int64_t overflows);

  Scalar scalar(Int128 value, int exponent);
  Coefficient divide(Int128 numerator, Int128 denominator, int fraction_bits);
  int rescaling(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent, int word_bits,
                int target_bits, int available_bits) const;

  static constexpr std::size_t kShownVectors = 8;

  Settings settings_;
  const Passes& passes_;
  Report report_;
  const QuantisedMatrix* matrix_ = nullptr;
  PackedMatrix packed_;
  Preconditioner preconditioner_;

  int direction_target_;
  int residual_target_;
  int residual_available_;
  int lane_products_bits_ = 0;  // width of the number of products in an accumulator's lane

  Vector x_, b_, r_, z_, d_, q_, w_, n_, v_, product_;
  Aligned<std::int16_t> short_;      // the vector that meets the paired matrix, four words a node
  Aligned<std::int64_t> sums_;       // sums before they become words; zero behind the last row
  std::vector<std::int32_t> shown_;  // for the observer, in the order of the matrix

  Coefficient alpha_, beta_, shown_alpha_;
  Scalar z_r_, d_q_;
  Int128 z_r_sum_ = 0;  // zᵀr, not yet a scalar
  bool stopped_ = false;
  Int128 rhs_squares_ = 0;  // Σ b² in words
  StopTest stop_test_;
  double residual_squares_ = 0;
  double smallest_ = 0;
  int last_progress_ = 0;
};

}  // namespace hvp::fixed::fast
