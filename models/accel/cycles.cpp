#include "models/accel/cycles.h"

#include <algorithm>
#include <string>

#include "models/accel/bank_conflicts.h"
#include "models/accel/partition.h"
#include "models/accel/symmetric.h"
#include "models/config/input_error.h"

namespace hvp::accel {

Pattern pattern_of(std::span<const int> row_begin, std::span<const int> column) {
  Pattern p;
  p.column.assign(column.begin(), column.end());
  for (std::size_t i = 1; i < row_begin.size(); ++i) {
    p.blocks_in_row.push_back(row_begin[i] - row_begin[i - 1]);
  }
  return p;
}

int packages_of(const Architecture& a, int blocks_in_row) {
  const int needed = (3 * blocks_in_row + a.package - 1) / a.package;
  if (a.packages_per_row == 0) return needed;
  if (needed <= a.packages_per_row) return a.packages_per_row;
  throw InputError("packages_per_row", "a row of " + std::to_string(blocks_in_row) +
                                           " blocks fills " + std::to_string(needed) +
                                           " packages; " + std::to_string(a.packages_per_row) +
                                           " were given to every row");
}

std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& whole) {
  Pattern scratch;
  const Pattern& p = stored_pattern(a, whole, scratch);
  return balance_of(a, p, deal_rows(a, p, a.partitions), a.partitions).fullest;
}

namespace {

using fixed::Method;

// Reciprocals that P⁻¹ of a node takes: its block is symmetric, so that six of nine are different.
int divisions_a_node(Method method) {
  if (method == Method::jacobi_pcg) return 3;
  return method == Method::block_jacobi_pcg ? 6 : 0;
}

// A shift-and-subtract divider takes a clock a bit; division_clocks are those of 64-bit scalars.
std::int64_t division_clocks(const Architecture& a, int scalar_bits) {
  return std::int64_t{a.division_clocks} * scalar_bits / 64;
}

// β²·dᵀA·d of the methods that carry it: two products of a mantissa and a scalar, in one
// multiplier of 18 × 18 that takes 17 bits of the scalar's magnitude a clock.
std::int64_t curvature_clocks(int scalar_bits) { return 2 * ((scalar_bits - 1 + 16) / 17); }

// Clocks between two groups of L nodes in the vector unit: what the ports of d allow. A group that
// is read and one that is written share a clock where the ports suffice for both.
struct GroupClocks {
  std::int64_t reading, writing, moving;
};
GroupClocks group_clocks(const Architecture& a) {
  const int nodes_a_bank = (a.nodes_per_clock + a.direction_banks - 1) / a.direction_banks;
  const int ports = a.direction_accesses();
  const int write = nodes_a_bank * a.direction_write_accesses();
  const auto clocks = [ports](int accesses) { return (accesses + ports - 1) / ports; };
  const int both = nodes_a_bank + write;
  return {clocks(nodes_a_bank), clocks(write),
          both <= ports ? 1 : clocks(nodes_a_bank) + clocks(write)};
}

// A pass that reads and writes d. Where the ports do not serve both at once, groups are read while
// the first is on its way; then their writes keep further groups out, and so on in turn.
std::int64_t moving_clocks(const Architecture& a, std::int64_t groups) {
  const auto [reading, writing, moving] = group_clocks(a);
  if (moving == 1) return groups + a.phase_clocks();
  const std::int64_t way = std::max(1, a.phase_clocks() - a.adder_tree_clocks - 1);
  const std::int64_t on_the_way = std::min(groups, way / reading);
  const std::int64_t tail = a.adder_tree_clocks + 1;
  if (reading == 1) {
    const std::int64_t rest = groups % way;
    return groups / way * way * moving + (rest > 0 ? way + rest * writing : 0) + tail;
  }
  return way + (groups - on_the_way) * moving + on_the_way * (moving - 1) + tail;
}

// The vector unit takes L finished rows a clock, one a partition, once the first are there.
std::int64_t collection_clocks(const Architecture& a, int nodes, std::int64_t issue_clocks) {
  if (nodes == 0) return 0;
  const int rows_a_clock = std::min(a.nodes_per_clock, a.partitions);
  const std::int64_t first = std::min(issue_clocks, issue_clocks * a.partitions / nodes);
  return first + (nodes + rows_a_clock - 1) / rows_a_clock;
}

// One after the other: α needs dᵀA·d, β needs the new residual, d needs β.
void conjugate_gradients(const Passes& pass, SolveCycles& c) {
  c.direction = pass.moving;
  c.divisions = 2 * (pass.reduction + pass.division);
  c.setup = pass.product + pass.vectors + pass.writing;
  c.replacement = pass.product + pass.vectors;
}

// β needs the residual alone: it is there before the product A·r, and its division and β²·dᵀA·d
// hide behind that; group c waits for both, since a curvature that rounding has used up sets β to
// zero. α hides behind group c, which does not need it. Without
// dynamic scaling c and the next b are one pass; then α has to be waited for.
void chronopoulos_gear(const Passes& pass, const SolveWork& work, SolveCycles& c) {
  const std::int64_t beta = pass.reduction + pass.division + curvature_clocks(work.scalar_bits);
  const std::int64_t alpha = pass.reduction + pass.division;
  c.divisions = std::max(pass.product, beta) - pass.product;
  if (work.dynamic_scaling) {
    c.direction = pass.moving;
    c.divisions += std::max(pass.moving, alpha) - pass.moving;
  } else {
    c.divisions += alpha;
  }
  // r and d as everywhere, then A·r, A·d and the first α.
  c.setup = 3 * pass.product + 2 * pass.vectors + alpha;
  c.replacement = pass.product + pass.vectors;
}

// Both inner products are formed with group b, so that both divisions hide behind the product
// A·w. Again c and the next b are one pass without dynamic scaling.
void pipelined(const Passes& pass, const SolveWork& work, SolveCycles& c) {
  const std::int64_t both = pass.reduction + 2 * pass.division + curvature_clocks(work.scalar_bits);
  c.divisions = std::max(pass.product, both) - pass.product;
  if (work.dynamic_scaling) c.direction = pass.moving;
  // r and d, then A·r and A·d brought to vector words, A·(A·r) and A·(A·d); the first α beside.
  const std::int64_t recurrences = 4 * pass.product + 2 * pass.scaled;
  c.setup = pass.product + 2 * pass.vectors + recurrences;
  // The iteration has A·(A·r) anyway.
  c.replacement = pass.vectors + recurrences;
}

}  // namespace

SolveWork longest_solve(const fixed::Settings& s) {
  SolveWork work;
  work.method = s.method;
  work.iterations = s.iterations;
  work.replacements = s.replace_residual_every == 0 ? 0 : s.iterations / s.replace_residual_every;
  work.extrapolated = s.start == fixed::Start::extrapolated;
  work.stop_test = s.stop_residual > 0;
  work.dynamic_scaling = s.dynamic_scaling;
  work.scalar_bits = s.scalar_bits;
  work.vector_bits = s.vector_bits;
  return work;
}

SolveWork solve_made(const fixed::Settings& s, const fixed::Report& report) {
  SolveWork work = longest_solve(s);
  if (report.reached || report.breakdowns > 0) work.iterations = report.iterations;
  work.replacements = report.replacements;
  work.broken_down = report.breakdowns > 0;
  return work;
}

SolveCycles solve_cycles(const Architecture& a, const Pattern& p, const SolveWork& work) {
  return solve_cycles(a, p.nodes(), issue_clocks_of_fullest_partition(a, p), work);
}

Passes passes_of(const Architecture& a, int rows, std::int64_t issue_clocks, int vector_nodes,
                 const SolveWork& work) {
  Passes pass;
  if (a.matrix_storage == MatrixStorage::symmetric) {
    // No row is done before the last package.
    pass.product = issue_clocks + a.phase_clocks() + gathering_clocks(a, rows);
  } else {
    pass.product =
        std::max(issue_clocks, collection_clocks(a, rows, issue_clocks)) + a.phase_clocks();
  }
  const GroupClocks group = group_clocks(a);
  const std::int64_t groups = (vector_nodes + a.nodes_per_clock - 1) / a.nodes_per_clock;
  pass.vectors = groups + a.phase_clocks();
  pass.reading = groups * group.reading + a.phase_clocks();
  pass.writing = groups * group.writing + a.phase_clocks();
  pass.moving = moving_clocks(a, groups);
  pass.division = division_clocks(a, work.scalar_bits);
  pass.scaled = work.dynamic_scaling ? pass.vectors : 0;
  return pass;
}

SolveCycles solve_cycles(const Architecture& a, int nodes, std::int64_t issue_clocks,
                         const SolveWork& work) {
  return solve_cycles(passes_of(a, nodes, issue_clocks, nodes, work), work);
}

SolveCycles solve_cycles(const Passes& pass, const SolveWork& work) {
  SolveCycles c;
  c.sparse_product = pass.product;
  c.update = pass.reading;
  switch (work.method) {
    case Method::chronopoulos_gear:
      chronopoulos_gear(pass, work, c);
      break;
    case Method::pipelined_cg:
      pipelined(pass, work, c);
      break;
    default:
      conjugate_gradients(pass, c);
      // Here dᵀA·d is known only after the product; the others know it before an iteration.
      if (work.broken_down) c.breakdown = pass.product;
  }
  if (work.extrapolated) c.setup += pass.vectors;
  c.iterations = work.iterations;
  c.replacements = work.replacements;
  return c;
}

std::int64_t node_update_cycles(const Architecture& a, const Pattern& whole, int node,
                                std::span<const int> neighbours, Method method) {
  const bool symmetric = a.matrix_storage == MatrixStorage::symmetric;
  Pattern scratch;
  const Pattern& p = stored_pattern(a, whole, scratch);
  std::int64_t clocks = a.phase_clocks();
  clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(node)]);
  for (const int n : neighbours) {
    // The node's column right of the diagonal stands in its own row.
    const bool searched = n != node && !(symmetric && n > node);
    if (searched) clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(n)]);
  }
  return clocks + node_inverse_cycles(a, method);
}

std::int64_t node_inverse_cycles(const Architecture& a, Method method) {
  const std::int64_t adjugate = method == Method::block_jacobi_pcg ? a.phase_clocks() : 0;
  return adjugate + std::int64_t{divisions_a_node(method)} * a.division_clocks;
}

std::int64_t load_cycles(const Architecture& a, const Pattern& p, Method method) {
  const int divisions = divisions_a_node(method);
  if (divisions == 0) return 1;
  return std::int64_t{divisions} * p.nodes() * a.division_clocks + a.phase_clocks();
}

}  // namespace hvp::accel
