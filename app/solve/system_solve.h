#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "app/results/tried_remedy.h"
#include "app/solve/solve_settings.h"
#include "models/accel/memory.h"
#include "models/fixed/settings.h"
#include "models/fixed/spectrum.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::app {

// A·x = b as a file states it: `rows` equations, filled up to blocks of three.
struct LinearSystem {
  sparse::BlockMatrix matrix;
  std::vector<double> b;  // matrix.rows() entries
  int rows = 0;
};

struct SolveTask {
  SolveSettings settings;
  accel::Device device;  // that settings.accelerator names
  // Otherwise the range of x is chosen so that x and b fit their words.
  bool range_given = false;
  double tolerance = 0;  // of error_rel, for the flags
};

// What the board did, over all its solves.
struct BoardCounts {
  int solves = 0;  // one, or the passes of the refinement
  int iterations = 0;
  std::int64_t saturations = 0;
  std::int64_t wraps = 0;
  int breakdowns = 0;
  double residual_recursive = 0;  // of the last solve, relative to its own right-hand side
  std::int64_t cycles = 0;
  std::int64_t time_ps = 0;
};

struct SystemSolution {
  std::vector<double> x;                // `rows` entries
  double error = 0;                     // ‖x − x*‖ / ‖x*‖, A·x* = b
  std::optional<double> error_rounded;  // the same with the rounded matrix; none: it is singular
  double residual = 0;                  // ‖b − A·x‖ / ‖b‖
  double residual_rounded = 0;          // with the rounded matrix
  BoardCounts board;
  std::int64_t clamped = 0;  // words of b that did not fit
  stability::Flags flags;
  std::optional<results::TriedRemedy> remedy;  // where one was looked for

  std::size_t nonzeros = 0;
  int rounded_nonpositive = 0;  // eigenvalues of the rounded matrix; -1: it is singular
  std::optional<fixed::SystemSpectrum> spectrum;

  fixed::Settings solver;  // in force: the range and the static shift that were chosen
  std::string_view range_from;
  double unit = 0;  // of a word of x, the coarsest of all unknowns
  accel::Usage usage;
};

// What the accelerator makes of the system, and how far that is from double precision. Throws
// InputError where the matrix is not positive definite or cannot be put into words.
SystemSolution solve_system(const LinearSystem& given, const SolveTask& task);

}  // namespace hvp::app
