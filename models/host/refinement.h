#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/hold.h"
#include "models/fem/internal_forces.h"
#include "models/fixed/system.h"
#include "models/host/frame_method.h"
#include "models/host/increments.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::host {

// The scenario's effect [refinement]. Without it the board solves for u itself, as in the thesis.
struct Refinement {
  int passes = 2;
  double tolerance = 1e-3;

  // The passes of a frame's two solves, where contact is a load that only the first one tells;
  // else all are made at once.
  struct Passes {
    int before = 0;  // the force
    int after = 0;
    int most_after = 0;  // while the residual is beyond `tolerance`
  };
  Passes divided(bool goes_on) const;

  void declare(config::Visitor& v);
};

// Iterative refinement (Wilkinson 1963, Moler 1967) with the board as inner solver: a pass forms r
// = f − A·u in double precision, the board solves Ã·Δ = r for the increment, from zero and in its
// words, and u += Δ. The rounding of Ã then costs passes instead of accuracy, as long as ‖I −
// A·Ã⁻¹‖ < 1. docs/fixed-point.md, section Refinement.
//
// Where the body's forces q(u) are not A·u, r = f − q(u): the board then solves for the increments
// of a Newton's method whose matrix is that of the body at rest. docs/tissue.md.
//
// Contact rows of r and Δ are zero, whatever stands on their diagonal (increments.h). That is the
// residual of the modified system.
//
// Each pass has its own unit of a word, a power of two below that of the scenario's
// displacement_range: the board's arithmetic is linear and does not depend on it. Vectors are over
// A's rows, in m and N. Nothing allocates after construction.
class RefinedSolve final : public FrameMethod {
 public:
  // Keeps references to `forces` and to `matrix`, which is the matrix before it was rounded.
  // `system` is a result of prepare(); its settings' start says where a solve begins. `initial` is
  // the solution before the first frame.
  RefinedSolve(const Refinement& refinement, fem::InternalForces& forces,
               const sparse::BlockMatrix& matrix, const fixed::System& system,
               std::span<const double> initial);

  const Increments& increments() const { return increments_; }
  int passes() const { return passes_; }
  int passes_made() const override { return passes_made_; }

  // Takes the right-hand side f and the prescribed displacements. Throws InputError where an entry
  // of f is not finite.
  void begin(std::span<const double> f, const fem::Hold& hold) override;
  // Writes the next pass' residual in the board's words. False where nothing is left to solve: all
  // passes are through, or the residual is zero.
  bool next(std::span<std::int32_t> b) override;
  void expect_to_go_on() override;
  void go_on(std::span<const double> f, double way) override;
  // Adds the board's increment; `flags` are those of its solve.
  void accept(std::span<const std::int32_t> x, stability::Flags flags) override;
  // Computes the remaining residual and the start of the next solve. It takes a product with A,
  // which the first pass of the next solve then uses.
  void finish() override;
  // Replaces finish() where the solve has failed: the last solution stays.
  void abandon() override { increments_.abandon(); }

  std::span<const double> displacement() const override { return increments_.displacement(); }
  // Increments::remaining(), and the largest of all solves.
  double residual() const { return increments_.remaining(); }
  double worst_residual() const { return increments_.worst_remaining(); }
  // The flags of the solve that finish() ended. Trouble with the words of one pass that a later
  // pass repaired (saturation, stagnation, divergence) is no flag while residual() is within the
  // tolerance.
  stability::Flags flags() const override { return flags_; }
  // The number of passes whose increment did not fit its words, which made the unit coarser.
  std::int64_t widened() const { return widened_; }
  // The words of residuals, and displacements beyond displacement_range, that were clamped since
  // begin().
  std::int64_t clamped() const override { return clamped_; }

  double next_operations() const override { return next_operations_; }
  double finish_operations() const override;
  std::vector<Step> steps() const override;
  std::vector<Step> further_steps() const override;

 private:
  // The operations of a residual with or without q(u) (the first pass has it from finish()), and of
  // accept().
  double residual_operations(bool product) const;
  double accept_operations() const;
  int exponent_for(double largest) const;
  double conversion() const;

  const sparse::BlockMatrix& matrix_;
  fixed::Scaling scaling_;
  std::vector<double> scale_;  // s_i of the words' equations; empty: one
  double tolerance_;
  double norm_;                // ‖A‖∞
  double displacement_limit_;  // the largest value of a word of x
  double force_limit_;         // the largest value of a word of b

  Increments increments_;
  double next_operations_ = 0;
  double since_next_ = 0;              // operations of begin() and accept()
  std::vector<double> r_, increment_;  // of a pass, in its unit
  int passes_;                         // of the scenario
  Refinement::Passes divided_;
  int pass_ = 0;
  int first_pass_ = 0, end_ = 0;  // of the present solve
  int passes_made_ = 0;
  int exponent_ = 0;      // the pass' unit is 2^exponent of that of the range
  double largest_b_ = 0;  // largest word of b in the pass
  double way_ = 0;  // motion of the contact since the last solve, in words of the range's unit
  std::vector<double> gain_;  // of each pass: largest word of x over that of b
  stability::Flags pass_flags_, flags_;
  std::int64_t widened_ = 0;
  std::int64_t clamped_ = 0;
};

}  // namespace hvp::host
