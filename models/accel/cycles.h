#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/vector_passes.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"

namespace hvp::accel {

// What the clock count depends on, of a matrix in 3 × 3 blocks.
struct Pattern {
  std::vector<int> blocks_in_row;  // non-zero blocks of each block row
  // Their block columns, row after row; empty where they are not known. Only how often the banks of
  // d compete depends on them.
  std::vector<int> column = {};
  // Where these are the rows that one of several devices has: how many nodes its vectors hold, and
  // how many the vector that is multiplied. 0: as many as there are rows.
  int vector_nodes = 0;
  int direction_nodes = 0;

  int nodes() const { return static_cast<int>(blocks_in_row.size()); }
  int nodes_in_vectors() const { return vector_nodes > 0 ? vector_nodes : nodes(); }
  int nodes_in_direction() const { return direction_nodes > 0 ? direction_nodes : nodes(); }
};

// From compressed rows: row_begin has one entry more than there are block rows.
Pattern pattern_of(std::span<const int> row_begin, std::span<const int> column = {});

// Packages of `package` columns that a node's rows fill (thesis §5.4: the last one is padded), or s
// where every row has as many. Throws InputError with the key "packages_per_row" where s are too
// few.
int packages_of(const Architecture& a, int blocks_in_row);

// Packages of the fullest partition. Rows are dealt out longest first to the emptiest partition,
// which balances them as §5.3 asks.
std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& whole);

// What a solve makes that takes clocks. The defaults are the thesis' solve.
struct SolveWork {
  fixed::Method method = fixed::Method::cg;
  int iterations = 60;          // passes through the loop
  int replacements = 0;         // residuals formed anew
  bool broken_down = false;     // dᵀA·d came out at or below zero, which ended it
  bool extrapolated = false;    // the guess is formed from the last two solutions
  bool stop_test = false;       // ‖r‖ is compared with ‖b‖; takes no clocks
  bool dynamic_scaling = true;  // the size of a vector is known before the next one is written
  int scalar_bits = 64;
  int vector_bits = 16;  // of the words that several devices exchange
};
// With every iteration that the settings allow.
SolveWork longest_solve(const fixed::Settings& settings);
// As it was. Without a stop test the board makes all its passes, as the thesis' does (§4.2: the
// count is fixed); once nothing is left to do they change nothing. A breakdown ends it.
SolveWork solve_made(const fixed::Settings& settings, const fixed::Report& report);

// Clocks of a solve by phase, loosely timed: the closed form of docs/accelerator.md. The groups
// are those of Fig. 4.4; each ends when its pipeline has run empty. A division stands where what
// follows needs it, and costs only the clocks that no group covers.
struct SolveCycles {
  std::int64_t setup = 0;           // until the first iteration
  std::int64_t sparse_product = 0;  // an iteration's group a: the product and its inner product
  std::int64_t update = 0;          // group b: x, r and rᵀr (z too, in parallel, §4.4)
  std::int64_t direction = 0;       // group c: d; 0 where it is one pass with the next group b
  std::int64_t divisions = 0;       // α and β, as far as they are waited for
  std::int64_t iterations = 0;
  std::int64_t replacement = 0;  // one residual formed anew, beyond its iteration
  std::int64_t replacements = 0;
  std::int64_t breakdown = 0;  // the product that showed it

  std::int64_t iteration() const { return sparse_product + update + direction + divisions; }
  std::int64_t total() const {
    return setup + iterations * iteration() + replacements * replacement + breakdown;
  }
};
SolveCycles solve_cycles(const Architecture& a, const Pattern& p, const SolveWork& work);

// Clocks of one pass through each unit, until its pipeline is empty: what a matrix and an
// architecture decide alone.
struct UnitClocks {
  std::int64_t product = 0;  // A times a vector, inner product included
  VectorPasses vectors;      // the vector unit over all nodes
};
// `vector_nodes`: on how many nodes the vector unit works, where it is not those of the pattern.
// Throws InputError as packages_of() does.
UnitClocks unit_clocks(const Architecture& a, const Pattern& p, int vector_nodes = 0);

// The same, with what a solve's settings decide.
struct Passes {
  std::int64_t product = 0;
  VectorPasses vectors;
  std::int64_t division = 0;   // α or β
  std::int64_t scaled = 0;     // a vector brought to its size: a pass where that is looked for
  std::int64_t reduction = 0;  // sums of several devices put together; 0 with one
};
Passes passes_of(const Architecture& a, const UnitClocks& units, const SolveWork& work);
// Does not allocate.
SolveCycles solve_cycles(const Passes& pass, const SolveWork& work);

// Clocks to clear or restore the row and the column of a node (§6.2.1). The node's own packages
// are written and those of every neighbour are searched for the column; with a preconditioner the
// node's part of P⁻¹ is made anew: three divisions, six and the block's adjugate for a block.
// `neighbours` lists the block columns of the node's row, itself included.
std::int64_t node_update_cycles(const Architecture& a, const Pattern& whole, int node,
                                std::span<const int> neighbours, fixed::Method method);

// Of those, the clocks in which the node's part of P⁻¹ is made.
std::int64_t node_inverse_cycles(const Architecture& a, fixed::Method method);

// Clocks after the matrix was loaded, until the board is ready: P⁻¹, one division after the
// other, where there is a preconditioner.
std::int64_t load_cycles(const Architecture& a, const Pattern& p, fixed::Method method);

}  // namespace hvp::accel
