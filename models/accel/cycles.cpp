#include "models/accel/cycles.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace hvp::accel {

Pattern pattern_of(std::span<const int> row_begin) {
  Pattern p;
  for (std::size_t i = 1; i < row_begin.size(); ++i) {
    p.blocks_in_row.push_back(row_begin[i] - row_begin[i - 1]);
  }
  return p;
}

int packages_of(const Architecture& a, int blocks_in_row) {
  return (3 * blocks_in_row + a.package - 1) / a.package;
}

std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& p) {
  std::vector<std::int64_t> packages;
  packages.reserve(p.blocks_in_row.size());
  for (const int blocks : p.blocks_in_row) packages.push_back(packages_of(a, blocks));
  std::sort(packages.begin(), packages.end(), std::greater<>());
  std::priority_queue<std::int64_t, std::vector<std::int64_t>, std::greater<>> partitions;
  for (int i = 0; i < a.partitions; ++i) partitions.push(0);
  std::int64_t fullest = 0;
  for (const std::int64_t n : packages) {
    const std::int64_t filled = partitions.top() + n;
    partitions.pop();
    partitions.push(filled);
    fullest = std::max(fullest, filled);
  }
  return fullest;
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

// One pass through a unit, until its pipeline is empty.
struct Passes {
  std::int64_t product;   // A times a vector, inner product included
  std::int64_t vectors;   // the vector unit over all nodes
  std::int64_t division;  // α or β
  std::int64_t scaled;  // a vector brought to its size: a pass of its own where that is looked for
};

// One after the other: α needs dᵀA·d, β needs the new residual, d needs β.
void conjugate_gradients(const Passes& pass, SolveCycles& c) {
  c.direction = pass.vectors;
  c.divisions = 2 * pass.division;
  c.setup = pass.product + c.update + c.direction;
  c.replacement = pass.product + pass.vectors;
}

// β needs the residual alone: it is there before the product A·r, and its division and β²·dᵀA·d
// hide behind that; group c waits for both, since a curvature that rounding has used up sets β to
// zero. α hides behind group c, which does not need it. Without
// dynamic scaling c and the next b are one pass; then α has to be waited for.
void chronopoulos_gear(const Passes& pass, const SolveWork& work, SolveCycles& c) {
  const std::int64_t beta = pass.division + curvature_clocks(work.scalar_bits);
  c.divisions = std::max(pass.product, beta) - pass.product;
  if (work.dynamic_scaling) {
    c.direction = pass.vectors;
    c.divisions += std::max(pass.vectors, pass.division) - pass.vectors;
  } else {
    c.divisions += pass.division;
  }
  // r and d as everywhere, then A·r, A·d and the first α.
  c.setup = 3 * pass.product + 2 * pass.vectors + pass.division;
  c.replacement = pass.product + pass.vectors;
}

// Both inner products are formed with group b, so that both divisions hide behind the product
// A·w. Again c and the next b are one pass without dynamic scaling.
void pipelined(const Passes& pass, const SolveWork& work, SolveCycles& c) {
  const std::int64_t both = 2 * pass.division + curvature_clocks(work.scalar_bits);
  c.divisions = std::max(pass.product, both) - pass.product;
  if (work.dynamic_scaling) c.direction = pass.vectors;
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
  Passes pass{};
  pass.product = packages_in_fullest_partition(a, p) + a.pipeline_clocks;
  pass.vectors = (p.nodes() + a.nodes_per_clock - 1) / a.nodes_per_clock + a.pipeline_clocks;
  pass.division = division_clocks(a, work.scalar_bits);
  pass.scaled = work.dynamic_scaling ? pass.vectors : 0;
  SolveCycles c;
  c.sparse_product = pass.product;
  c.update = pass.vectors;
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
  // bᵀb, in the vector unit, beside the product A·x.
  if (work.stop_test) c.setup += std::max(pass.product, pass.vectors) - pass.product;
  c.iterations = work.iterations;
  c.replacements = work.replacements;
  return c;
}

std::int64_t node_update_cycles(const Architecture& a, const Pattern& p, int node,
                                std::span<const int> neighbours, Method method) {
  std::int64_t clocks = a.pipeline_clocks;
  clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(node)]);
  for (const int n : neighbours) {
    if (n != node) clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(n)]);
  }
  if (method == Method::block_jacobi_pcg) clocks += a.pipeline_clocks;
  return clocks + std::int64_t{divisions_a_node(method)} * a.division_clocks;
}

std::int64_t load_cycles(const Architecture& a, const Pattern& p, Method method) {
  const int divisions = divisions_a_node(method);
  if (divisions == 0) return 1;
  return std::int64_t{divisions} * p.nodes() * a.division_clocks + a.pipeline_clocks;
}

}  // namespace hvp::accel
