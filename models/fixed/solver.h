#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/types.h"
#include "models/stability/flag.h"

namespace hvp::fixed {

// The words of one solve that go to the board and come back; Scaling (system.h) has their units.
// Both spans have 3 · block_rows entries. Words beyond their width are clamped and counted.
struct Job {
  std::span<const std::int32_t> b;  // residual_bits() wide
  std::span<std::int32_t> x;        // vector_bits wide: the initial guess in, the solution out.
                                    // With Start::zero the guess is ignored.
};

// Norms are in units of the integer product A·x: multiply by matrix.scale · displacement unit
// for N. Only the model computes them: the board has no pass to spare for them.
struct Report {
  int iterations = 0;            // updates of x
  bool reached = false;          // stop_residual ended the solve
  int replacements = 0;          // residuals formed anew
  std::int64_t saturations = 0;  // clamped words, those of b and x on entry included
  std::int64_t wraps = 0;        // wrapped words, with Overflow::wrap
  int breakdowns = 0;            // directions of negative curvature
  stability::Flags flags;

  double rhs_norm = 0;             // ‖b‖
  double start_residual_norm = 0;  // ‖b - A·x‖ of the initial guess
  double residual_norm = 0;        // ‖r‖ of the recurrence at the end
  double true_residual_norm = 0;   // ‖b - A·x‖ of the solution
  // The residual that is left if the last bit of every displacement is wrong, with the worst signs:
  // the norm of the matrix' absolute row sums. Words of x cannot express a smaller residual.
  double rounding_floor = 0;

  // True if no flag was raised: the residual is as small as the iterations allow, and nothing was
  // clamped.
  bool clean() const { return flags.empty(); }
};

// The registers after an iteration, for comparing two implementations word for word.
// The spans are valid during the call.
struct IterationState {
  int iteration = 0;  // from 1
  std::span<const std::int32_t> x;
  std::span<const std::int32_t> r;
  std::span<const std::int32_t> z;  // equal to r without a preconditioner
  std::span<const std::int32_t> d;  // d of the next iteration
  // A·d of this iteration; with chronopoulos_gear and pipelined_cg the recurrence's A·d of the next
  // iteration.
  std::span<const std::int32_t> q;
  // chronopoulos_gear: w = A·r. pipelined_cg: w = A·r as a vector word, n = A·A·r, and v = A·q by
  // recurrence. Empty with other methods.
  std::span<const std::int32_t> w = {};
  std::span<const std::int32_t> n = {};
  std::span<const std::int32_t> v = {};
  Int128 d_q = 0;  // dᵀAd of this iteration; by recurrence that of the next one
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

// Solves A·x = b in the words of the settings. Every implementation gives the same words, the same
// report and the same calls of the observer: sums of rows and inner products are exact and saturate
// once, at write-back, so that the order of summation does not show.
class Solver {
 public:
  virtual ~Solver() = default;

  // Takes a matrix, which has to stay in place until the next load(). Throws InputError if its
  // words differ from those of the settings, or a row is so long that its sum could exceed 64 bits.
  // Allocates if the matrix is larger than all before.
  virtual void load(const QuantisedMatrix& matrix) = 0;

  // To be called after set_contact() or restore_row() of a node of the loaded matrix. Does not
  // allocate.
  virtual void update(int node) = 0;

  // Solves for the loaded matrix. Does not allocate. Throws InputError if the sizes disagree.
  virtual Report solve(Job job, Observer* observer = nullptr) = 0;

  // Calls load() and solve().
  Report solve(const QuantisedMatrix& matrix, Job job, Observer* observer = nullptr) {
    load(matrix);
    return solve(job, observer);
  }
};

// An implementation of the solver. All give the same words, the same report and the same calls of
// the observer; they differ in time alone.
enum class Kernel {
  reference,  // ReferenceSolver: one word, one statement
  portable,   // the fast solver's passes in plain C++
  avx2,
  avx512,  // with VNNI
};

std::string_view name(Kernel kernel);

// True if this processor and this build have the kernel.
bool supported(Kernel kernel);
std::vector<Kernel> supported_kernels();

// The fastest supported kernel.
Kernel best_kernel();

// The kernel that the environment variable HVP_KERNEL names, otherwise the best one. Throws
// InputError for a name that does not exist or that this machine does not support.
Kernel chosen_kernel();

// Throws InputError as Settings::check() does, and if the kernel is not supported.
std::unique_ptr<Solver> make_solver(const Settings& settings, Kernel kernel = chosen_kernel());

}  // namespace hvp::fixed
