#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"

namespace hvp::accel {

// The clocks of a vector pass over the nodes, its pipeline included, by what the pass does with d.
// The vector unit takes groups of L nodes. A group asks its fullest bank of d for ⌈L / banks⌉ words
// to read, and for as many, or twice as many with two copies, to write (w). A bank gives `accesses`
// of them a clock, writes first. The lanes are stalled until a write is over; accesses that are
// left in its last clock serve the next group. A group is read in one clock if the ports suffice,
// otherwise over several.
struct VectorPasses {
  std::int64_t alone = 0;  // no access to d: ⌈n/L⌉ + p
  std::int64_t reading = 0;
  std::int64_t writing = 0;
  std::int64_t moving = 0;  // read and written, as in group c
};
VectorPasses vector_passes(const Architecture& a, int nodes);

// The pattern of a matrix in 3 × 3 blocks, as far as clocks depend on it.
struct Pattern {
  std::vector<int> blocks_in_row;  // non-zero blocks of each block row
  // The block columns of these blocks, row after row; empty if they are not known. They only decide
  // how often a package reads the same bank of d.
  std::vector<int> column = {};
  // If these are the rows of one of several devices: the nodes of its vectors, and those of the
  // vector that it multiplies. 0: as many as there are rows.
  int vector_nodes = 0;
  int direction_nodes = 0;

  int nodes() const { return static_cast<int>(blocks_in_row.size()); }
  int nodes_in_vectors() const { return vector_nodes > 0 ? vector_nodes : nodes(); }
  int nodes_in_direction() const { return direction_nodes > 0 ? direction_nodes : nodes(); }
};

// The pattern of compressed rows: row_begin has one entry more than there are block rows.
Pattern pattern_of(std::span<const int> row_begin, std::span<const int> column = {});

// The packages of `package` columns that a node's rows fill (thesis §5.4: the last one is padded),
// or s if every row has s packages. Throws InputError with the key "packages_per_row" if s packages
// are too few.
int packages_of(const Architecture& a, int blocks_in_row);

// The packages of the fullest partition. Rows are dealt out longest first to the emptiest
// partition, which balances them as thesis §5.3 asks.
std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& whole);

// The operations of a solve that take clocks. The defaults are the thesis' solve.
struct SolveWork {
  fixed::Method method = fixed::Method::cg;
  int iterations = 60;          // passes through the loop
  int replacements = 0;         // residuals formed anew
  bool broken_down = false;     // a dᵀA·d at or below zero ended the solve
  bool extrapolated = false;    // the guess is formed from the last two solutions
  bool stop_test = false;       // ‖r‖ is compared with ‖b‖; takes no clocks
  bool dynamic_scaling = true;  // the size of a vector is known before the next one is written
  int scalar_bits = 64;
  int shortest_division = 68;  // clocks, fixed::shortest_division()
  int vector_bits = 16;        // width of the words that several devices exchange
};
// The work of a solve with every iteration that the settings allow.
SolveWork longest_solve(const fixed::Settings& settings);
// The work of the solve that `report` is of. Without a stop test the board makes all its
// iterations, as the thesis' board does (§4.2: the count is fixed); once nothing is left to do they
// change nothing. A breakdown ends the solve.
SolveWork solve_made(const fixed::Settings& settings, const fixed::Report& report);

// The clocks of a solve by engine phase, loosely timed: the closed form of docs/accelerator.md. The
// groups are those of Fig. 4.4; each ends when its pipeline has run empty. A division costs only
// the clocks in which what follows waits for it.
struct SolveCycles {
  std::int64_t setup = 0;           // the clocks before the first iteration
  std::int64_t sparse_product = 0;  // group a of an iteration: the product and its inner product
  std::int64_t update = 0;          // group b: x, r and rᵀr (z too, in parallel, §4.4)
  std::int64_t direction = 0;       // group c: d; 0 if it is one pass with the next group b
  std::int64_t divisions = 0;       // α and β, as far as an iteration waits for them
  std::int64_t iterations = 0;
  std::int64_t replacement = 0;  // one residual formed anew, in addition to its iteration
  std::int64_t replacements = 0;
  std::int64_t breakdown = 0;  // the product that showed it

  std::int64_t iteration() const { return sparse_product + update + direction + divisions; }
  std::int64_t total() const {
    return setup + iterations * iteration() + replacements * replacement + breakdown;
  }
};
SolveCycles solve_cycles(const Architecture& a, const Pattern& p, const SolveWork& work);

// The clocks of one pass through each unit, until its pipeline is empty. Matrix and architecture
// alone decide them.
struct UnitClocks {
  std::int64_t product = 0;  // A times a vector, inner product included
  VectorPasses vectors;      // the vector unit over all nodes
};
// `vector_nodes`: the nodes on which the vector unit works; 0: those of the pattern.
// Throws InputError as packages_of() does.
UnitClocks unit_clocks(const Architecture& a, const Pattern& p, int vector_nodes = 0);

// The clocks of a solve's passes: those of the units, and those that the solve's settings decide.
struct Passes {
  std::int64_t product = 0;
  VectorPasses vectors;
  std::int64_t division = 0;  // α or β
  std::int64_t scaled = 0;  // a vector brought to its scale: a pass if dynamic scaling looks for it
  std::int64_t reduction = 0;  // sums of several devices added up; 0 with one
};
Passes passes_of(const Architecture& a, const UnitClocks& units, const SolveWork& work);
// Does not allocate.
SolveCycles solve_cycles(const Passes& pass, const SolveWork& work);

// The clocks that it takes to clear or restore the row and the column of a node (thesis §6.2.1).
// The node's own packages are written and those of every neighbour are searched for the column;
// with a preconditioner the node's part of P⁻¹ is made anew: three divisions, six and the block's
// adjugate for a block. `neighbours` lists the block columns of the node's row, itself included.
std::int64_t node_update_cycles(const Architecture& a, const Pattern& whole, int node,
                                std::span<const int> neighbours, const fixed::Settings& settings);

// The part of these clocks in which the node's part of P⁻¹ is made.
std::int64_t node_inverse_cycles(const Architecture& a, const fixed::Settings& settings);

// The clocks from the matrix' arrival until the board is ready: P⁻¹, one division after the other,
// if there is a preconditioner.
std::int64_t load_cycles(const Architecture& a, const Pattern& p, const fixed::Settings& settings);

// Throws InputError with the key "division_clocks" where the architecture has fewer than these
// settings take.
void require_division(const Architecture& a, const fixed::Settings& settings);

}  // namespace hvp::accel
