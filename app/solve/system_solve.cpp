#include "app/solve/system_solve.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>

#include "app/solve/exact_solution.h"
#include "models/accel/board.h"
#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/fixed/solver.h"
#include "models/fixed/system.h"
#include "models/fixed/word.h"
#include "models/host/deviation.h"
#include "models/host/refinement.h"

namespace hvp::app {

SolveSettings::SolveSettings() {
  solver.method = fixed::Method::jacobi_pcg;
  solver.start = fixed::Start::zero;
  accelerator.partitions = 3;
}

void SolveSettings::choose_preconditioner_memory(const accel::Device& device) {
  const std::string small = "M512";
  if (device.memory(small) != nullptr) accelerator.preconditioner_memory = small;
}

void SolveSettings::declare(config::Visitor& v) {
  v.table("solver", solver, {"method and words of the fixed-point solver"});
  v.effect("refinement", refinement,
           {"the host forms the residual in double precision and the board solves for the "
            "increment, in several passes"});
  v.table("accelerator", accelerator, {"the FPGA's micro-architecture"});
  v.effect("spectrum", spectrum, {"bounds the extreme eigenvalues and the condition number"});
}

void SolveSettings::check() const {
  if (solver.start == fixed::Start::zero) return;
  throw InputError("solver.start", "there is no earlier solution to start from: expected zero");
}

namespace {

using Vector = std::vector<double>;

std::size_t count_nonzeros(const LinearSystem& system) {
  std::size_t count = 0;
  for (const double entry : system.matrix.value) count += entry != 0 ? 1 : 0;
  // The rows that fill the last block have a diagonal entry each.
  return count - static_cast<std::size_t>(system.matrix.rows() - system.rows);
}

Vector residual(const sparse::BlockMatrix& a, std::span<const double> b,
                std::span<const double> x) {
  Vector r(b.size());
  a.multiply(x, r);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = b[i] - r[i];
  return r;
}

double ratio(double part, double whole) {
  if (part == 0) return 0;
  return whole > 0 ? part / whole : std::numeric_limits<double>::infinity();
}

// The matrix that the words stand for, in the coordinates in which it was rounded:
// Ã·y = S·b with x = S·y.
class RoundedSystem {
 public:
  RoundedSystem(const fixed::System& system, std::span<const double> b)
      : matrix_(fixed::dequantise(system.matrix)), scale_(system.scale), b_(b), solver_(matrix_) {}

  bool positive_definite() const { return solver_.positive_definite(); }
  int nonpositive_eigenvalues() const {
    return solver_.singular() ? -1 : solver_.negative_eigenvalues();
  }

  std::optional<Vector> solution() const {
    if (solver_.singular()) return std::nullopt;
    Vector x = scaled(b_);
    solver_.solve(x, x);
    return scaled(x);
  }

  // ‖b − S⁻¹·Ã·S⁻¹·x‖ / ‖b‖
  double residual_of(std::span<const double> x) const {
    Vector y(x.begin(), x.end());
    for (std::size_t i = 0; i < y.size(); ++i) y[i] /= scale_[i];
    Vector r = residual(matrix_, scaled(b_), y);
    for (std::size_t i = 0; i < r.size(); ++i) r[i] /= scale_[i];
    return ratio(norm(r), norm(b_));
  }

 private:
  Vector scaled(std::span<const double> v) const {
    Vector result(v.begin(), v.end());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] *= scale_[i];
    return result;
  }

  sparse::BlockMatrix matrix_;
  std::span<const double> scale_;
  std::span<const double> b_;
  fem::DirectSolver solver_;
};

// Iterates may pass beyond the solution in single entries; the bit that this costs is the last
// one of x.
constexpr double kMargin = 2;

struct Range {
  double displacement = 0;
  std::string_view from;
};

// The least range in which x has its margin and b fits its word. A board cannot know x; the host
// knows it here, because it computes the error.
Range fitting_range(const fixed::System& system, std::span<const double> b,
                    std::span<const double> x, const std::optional<Vector>& x_rounded) {
  const std::span<const double> scale = system.scale;
  double largest_x = 0;
  double largest_b = 0;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    largest_x = std::max(largest_x, std::abs(x[i]) / scale[i]);
    if (x_rounded) largest_x = std::max(largest_x, std::abs((*x_rounded)[i]) / scale[i]);
    largest_b = std::max(largest_b, std::abs(b[i]) * scale[i]);
  }
  const fixed::Settings& s = system.settings;
  const double unit_for_x =
      kMargin * largest_x / static_cast<double>(fixed::word_limit(s.vector_bits));
  const double unit_for_b =
      largest_b /
      (system.matrix.scale *
       std::ldexp(static_cast<double>(fixed::word_limit(s.residual_bits())), s.rhs_shift()));
  const double unit = std::max(unit_for_x, unit_for_b);
  if (!(unit > 0)) return {1.0, "nothing: b is zero"};
  // The scaling counts the range from the stiffest equation (fixed/system.h).
  const double least = *std::min_element(scale.begin(), scale.end());
  return {unit * least * static_cast<double>(fixed::word_limit(s.vector_bits)),
          unit_for_b > unit_for_x ? "right-hand side" : "solution"};
}

// The accelerator with a system in its memory: it solves, and counts clocks and iterations.
class Board {
 public:
  Board(const fixed::System& system, const SolveTask& task)
      : settings_(system.settings),
        architecture_(task.settings.accelerator),
        device_(task.device),
        clocks_(architecture_, accel::pattern_of(system.matrix.row_begin, system.matrix.column)),
        solver_(fixed::make_solver(settings_)) {
    solver_->load(system.matrix);
  }

  fixed::Report solve(fixed::Job job) {
    const fixed::Report report = solver_->solve(job);
    ++counts_.solves;
    counts_.iterations += report.iterations;
    counts_.saturations += report.saturations;
    counts_.wraps += report.wraps;
    counts_.breakdowns += report.breakdowns;
    counts_.residual_recursive = ratio(report.residual_norm, report.rhs_norm);
    counts_.cycles += clocks_.solve(accel::solve_made(settings_, report)).total();
    counts_.time_ps = counts_.cycles * architecture_.clock_period_ps();
    return report;
  }

  const BoardCounts& counts() const { return counts_; }
  accel::Usage usage() const {
    return accel::board_usage(device_, architecture_, accel::word_lengths(settings_), clocks_);
  }

 private:
  fixed::Settings settings_;
  accel::Architecture architecture_;
  const accel::Device& device_;
  accel::BoardClocks clocks_;
  std::unique_ptr<fixed::Solver> solver_;
  BoardCounts counts_;
};

Board make_board(const fixed::System& system, const SolveTask& task) {
  try {
    accel::require_division(task.settings.accelerator, system.settings);
    return {system, task};
  } catch (const InputError& e) {
    throw InputError(e.key().empty() ? "accelerator" : "accelerator." + e.key(), e.what());
  }
}

void solve_once(const fixed::System& system, std::span<const double> b, Board& board,
                SystemSolution& s) {
  const fixed::Scaling scaling(system);
  std::vector<std::int32_t> b_words(b.size());
  std::vector<std::int32_t> x_words(b.size(), 0);
  s.clamped = scaling.right_hand_side(b, b_words);
  s.flags.merge(board.solve({b_words, x_words}).flags);
  s.x.resize(b.size());
  scaling.displacements(x_words, s.x);
}

void solve_refined(const host::Refinement& refinement, const LinearSystem& given,
                   const fixed::System& system, Board& board, SystemSolution& s) {
  const Vector zero(given.b.size(), 0.0);
  fem::LinearForces forces(given.matrix);
  host::RefinedSolve refined(refinement, forces, given.matrix, system, zero);
  std::vector<std::int32_t> b_words(given.b.size());
  std::vector<std::int32_t> x_words(given.b.size());
  refined.begin(given.b, {});
  while (refined.next(b_words)) {
    const fixed::Report report = board.solve({b_words, x_words});
    refined.accept(x_words, report.flags);
  }
  refined.finish();
  s.clamped = refined.clamped();
  // Where equations differ in size the residual says less than the error, which is known here.
  stability::Flags flags = refined.flags();
  s.flags.merge(flags.without(stability::Flag::not_converged));
  s.x.assign(refined.displacement().begin(), refined.displacement().end());
}

}  // namespace

SystemSolution solve_system(const LinearSystem& given, const SolveTask& task) {
  SystemSolution s;
  const Vector exact = exact_solution(given.matrix, given.b, given.rows);
  fixed::System system = fixed::prepare(given.matrix, task.settings.solver);
  const RoundedSystem rounded(system, given.b);
  const std::optional<Vector> exact_rounded = rounded.solution();
  s.range_from = "given";
  if (!task.range_given) {
    const bool usable = rounded.positive_definite();
    const Range range =
        fitting_range(system, given.b, exact, usable ? exact_rounded : std::nullopt);
    system.settings.displacement_range = range.displacement;
    s.range_from = range.from;
  }
  Board board = make_board(system, task);
  if (task.settings.refinement) {
    solve_refined(*task.settings.refinement, given, system, board, s);
  } else {
    solve_once(system, given.b, board, s);
  }
  s.board = board.counts();
  s.usage = board.usage();

  s.unit = fixed::Scaling(system).displacement_unit() *
           *std::max_element(system.scale.begin(), system.scale.end());
  s.solver = system.settings;
  s.nonzeros = count_nonzeros(given);
  s.rounded_nonpositive = rounded.nonpositive_eigenvalues();
  s.error = relative_distance(s.x, exact);
  if (exact_rounded) s.error_rounded = relative_distance(s.x, *exact_rounded);
  s.residual = ratio(norm(residual(given.matrix, given.b, s.x)), norm(given.b));
  s.residual_rounded = rounded.residual_of(s.x);
  if (task.settings.spectrum) {
    s.spectrum = fixed::bound_spectrum(given.matrix, system, *task.settings.spectrum);
  }

  if (s.clamped > 0) s.flags.raise(stability::Flag::range_exceeded);
  if (!rounded.positive_definite()) s.flags.raise(stability::Flag::negative_curvature);
  const host::Reference defaults;
  // Refinement leads to the true solution, so that the way to it is the solver's own error.
  s.flags.merge(
      host::accuracy_flags({1, task.tolerance, defaults.solver_tolerance, {}}, s.error,
                           task.settings.refinement ? std::optional(s.error) : s.error_rounded));
  s.x.resize(static_cast<std::size_t>(given.rows));
  return s;
}

}  // namespace hvp::app
