#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "app/results/flags.h"
#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/memory.h"
#include "models/config/declaration.h"
#include "models/fixed/settings.h"
#include "models/fixed/spectrum.h"
#include "models/host/refinement.h"
#include "models/sparse/block_matrix.h"
#include "models/sparse/spectrum.h"
#include "models/stability/flag.h"

namespace hvp::app {

// The settings that --set changes in `hvp solve`: the tables of a scenario that apply to a single
// system, with the defaults of this command. The architecture is that of scenarios/thesis-pcg.toml,
// with which Jacobi-PCG fits an EP2S60 beside the thesis' 500 nodes; that of plain CG has too many
// multipliers for any system.
struct SolveSettings {
  SolveSettings();
  // Puts z and the inverse diagonal into the device's M512 blocks, where it has such blocks and the
  // user has not chosen a memory.
  void choose_preconditioner_memory(const accel::Device& device);

  fixed::Settings solver;
  std::optional<host::Refinement> refinement;
  accel::Architecture accelerator;
  std::optional<sparse::SpectrumSettings> spectrum;

  void declare(config::Visitor& v);
  void check() const;
};

// A·x = b from a file: `rows` equations, filled up to blocks of three.
struct LinearSystem {
  sparse::BlockMatrix matrix;
  std::vector<double> b;  // matrix.rows() entries
  int rows = 0;
};

struct SolveTask {
  SolveSettings settings;
  accel::Device device;      // that settings.accelerator names
  bool range_given = false;  // else the range of x is chosen so that x and b fit their words
  double tolerance = 0;      // of error_rel, for the flags
};

// The board's counts over all its solves.
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
  std::optional<double> error_rounded;  // the same with the rounded matrix; absent: it is singular
  double residual = 0;                  // ‖b − A·x‖ / ‖b‖
  double residual_rounded = 0;          // with the rounded matrix
  BoardCounts board;
  std::int64_t clamped = 0;  // words of b that were clamped
  stability::Flags flags;
  std::optional<results::TriedRemedy> remedy;  // where one was looked for

  std::size_t nonzeros = 0;
  int rounded_nonpositive = 0;  // eigenvalues of the rounded matrix; -1: it is singular
  std::optional<fixed::SystemSpectrum> spectrum;

  fixed::Settings solver;  // as used, with the range and the static shift that were chosen
  std::string_view range_from;
  double unit = 0;  // what one unit of a word of x stands for; the coarsest of all unknowns
  accel::Usage usage;
};

// Solves the system as the accelerator would, and measures the distance from double precision.
// Throws InputError where the matrix is not positive definite or cannot be put into words.
SystemSolution solve_system(const LinearSystem& given, const SolveTask& task);

// Searches a remedy for the flags of `solution`: adds remedies and solves anew with each, takes
// back those that were not needed, and adds what the words need of the device. Absent without a
// flag, or where no flag names a setting of the solver.
std::optional<results::TriedRemedy> try_remedies(const LinearSystem& system, const SolveTask& task,
                                                 const SystemSolution& solution);

}  // namespace hvp::app
