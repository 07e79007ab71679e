#pragma once

#include <cstdint>
#include <span>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/types.h"
#include "models/stability/flag.h"

namespace hvp::fixed {

// One solve: the words that go to the board and come back (scaling.h has their units). Both
// spans have 3 · block_rows entries; words beyond their width are clamped and counted.
struct Job {
  std::span<const std::int32_t> b;  // residual_bits() wide
  std::span<std::int32_t> x;        // vector_bits wide: the initial guess in, the solution out.
                                    // With Start::zero the guess is ignored.
};

// Norms are in units of the integer product A·x: multiply by matrix.scale · displacement unit
// for N. They are the model's, not the hardware's: the board has no pass to spare for them.
struct Report {
  int iterations = 0;            // updates of x that were made
  bool reached = false;          // ended by stop_residual
  int replacements = 0;          // residuals formed anew
  std::int64_t saturations = 0;  // words clamped, those of b and x on entry included
  std::int64_t wraps = 0;        // words wrapped, with Overflow::wrap
  int breakdowns = 0;            // directions of negative curvature
  stability::Flags flags;

  double rhs_norm = 0;             // ‖b‖
  double start_residual_norm = 0;  // ‖b - A·x‖ of the initial guess
  double residual_norm = 0;        // ‖r‖ of the recurrence, as the words had it at the end
  double true_residual_norm = 0;   // ‖b - A·x‖ of the solution
  // The residual that a wrong last bit of every displacement, with the worst signs, leaves: the
  // norm of the matrix' absolute row sums. Under it nothing can be said in words of x.
  double rounding_floor = 0;

  // No flag: the residual is as small as the iterations allow, and nothing was clamped.
  bool clean() const { return flags.empty(); }
};

// What an iteration leaves in the registers, for comparing two implementations word for word.
// The spans are valid during the call.
struct IterationState {
  int iteration = 0;  // from 1
  std::span<const std::int32_t> x;
  std::span<const std::int32_t> r;
  std::span<const std::int32_t> z;  // the same as r without a preconditioner
  std::span<const std::int32_t> d;  // of the next iteration
  // A·d of this iteration; with chronopoulos_gear and pipelined_cg what stands for it by
  // recurrence, of the next iteration.
  std::span<const std::int32_t> q;
  // chronopoulos_gear: A·r. pipelined_cg: A·r as a vector word, A·A·r and what stands for A·q.
  // Empty elsewhere.
  std::span<const std::int32_t> w = {};
  std::span<const std::int32_t> n = {};
  std::span<const std::int32_t> v = {};
  Int128 d_q = 0;  // dᵀAd of this iteration; by recurrence, of the next one
  Int128 z_r = 0;  // zᵀr of the new residual
  Coefficient alpha;
  Coefficient beta;
  // The residual is r · 2^(rhs_shift - residual_exponent) in units of A·x, the direction
  // d · 2^-direction_exponent in units of z.
  int residual_exponent = 0;
  int direction_exponent = 0;
};

class Observer {
 public:
  virtual ~Observer() = default;
  virtual void iteration(const IterationState& state) = 0;
};

// Solves A·x = b in the words of the settings. Every implementation gives the same words, the
// same report and the same calls of the observer: a row's sum is exact and saturates once, at
// write-back, and so do inner products, so that no order of summation shows.
class Solver {
 public:
  virtual ~Solver() = default;

  // Takes a matrix, which has to stay where it is until the next load(). Throws InputError where
  // it has other words than the settings say, or a row is so long that its sum could leave 64
  // bits. Allocates where the matrix is larger than all before.
  virtual void load(const QuantisedMatrix& matrix) = 0;

  // After set_contact() or restore_row() of a node of the loaded matrix. Does not allocate.
  virtual void update(int node) = 0;

  // Does not allocate. Throws InputError where the sizes disagree.
  virtual Report solve(Job job, Observer* observer = nullptr) = 0;

  // load() and solve().
  Report solve(const QuantisedMatrix& matrix, Job job, Observer* observer = nullptr) {
    load(matrix);
    return solve(job, observer);
  }
};

}  // namespace hvp::fixed
