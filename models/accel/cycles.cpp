#include "models/accel/cycles.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "models/accel/bits.h"
#include "models/accel/partition.h"
#include "models/accel/product_clocks.h"
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

// β²·dᵀA·d of the methods that carry it: two products of a mantissa and a scalar, in one
// multiplier of 18 × 18 that takes 17 bits of the scalar's magnitude a clock.
std::int64_t curvature_clocks(int scalar_bits) { return 2 * ((scalar_bits - 1 + 16) / 17); }

// Rows that end together wait for the lanes, ⌈PL3 / L⌉ − 1 clocks where nothing else holds them up.
// Up to a 128th of P that is left out: P + p is then what a product takes, as an independent count
// has it (docs/accelerator.md).
std::int64_t product_clocks(const Architecture& a, const Pattern& p) {
  const RowSchedule rows = row_schedule(a, p);
  const bool nothing_competes = rows.taken <= rows.issued + rows.issued / 128;
  return (nothing_competes ? rows.issued : rows.taken) + a.phase_clocks();
}

// One after the other: α needs dᵀA·d, β needs the new residual, d needs β.
// For a residual formed anew x and d change places: in group b, which then moves d, and back again
// with the residual.
void conjugate_gradients(const Passes& pass, SolveCycles& c) {
  c.direction = pass.vectors.moving;
  c.divisions = 2 * (pass.reduction + pass.division);
  c.setup = pass.product + pass.vectors.alone + pass.vectors.writing;
  c.replacement = pass.product + 2 * pass.vectors.moving - pass.vectors.reading;
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
    c.direction = pass.vectors.moving;
    c.divisions += std::max(pass.vectors.moving, alpha) - pass.vectors.moving;
  } else {
    c.divisions += alpha;
  }
  // r and d as everywhere, then A·r, A·d and the first α.
  c.setup = 3 * pass.product + 2 * pass.vectors.alone + alpha;
  c.replacement = pass.product + pass.vectors.alone;
}

// Both inner products are formed with group b, so that both divisions hide behind the product
// A·w. Again c and the next b are one pass without dynamic scaling.
void pipelined(const Passes& pass, const SolveWork& work, SolveCycles& c) {
  const std::int64_t both = pass.reduction + 2 * pass.division + curvature_clocks(work.scalar_bits);
  c.divisions = std::max(pass.product, both) - pass.product;
  if (work.dynamic_scaling) c.direction = pass.vectors.moving;
  // r and d, then A·r and A·d brought to vector words, A·(A·r) and A·(A·d); the first α beside.
  const std::int64_t recurrences = 4 * pass.product + 2 * pass.scaled;
  c.setup = pass.product + 2 * pass.vectors.alone + recurrences;
  // The iteration has A·(A·r) anyway.
  c.replacement = pass.vectors.alone + recurrences;
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
  work.shortest_division = fixed::shortest_division(s);
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
  return solve_cycles(passes_of(a, unit_clocks(a, p), work), work);
}

UnitClocks unit_clocks(const Architecture& a, const Pattern& p, int vector_nodes) {
  UnitClocks units;
  if (a.matrix_storage == MatrixStorage::symmetric) {
    // No row is done before the last package.
    units.product =
        issue_clocks_of_fullest_partition(a, p) + a.phase_clocks() + gathering_clocks(a, p.nodes());
  } else {
    units.product = product_clocks(a, p);
  }
  units.vectors = vector_passes(a, vector_nodes > 0 ? vector_nodes : p.nodes());
  return units;
}

Passes passes_of(const Architecture& a, const UnitClocks& units, const SolveWork& work) {
  Passes pass;
  pass.product = units.product;
  pass.vectors = units.vectors;
  pass.division = std::max(a.division_clocks, work.shortest_division);
  pass.scaled = work.dynamic_scaling ? units.vectors.alone : 0;
  return pass;
}

SolveCycles solve_cycles(const Passes& pass, const SolveWork& work) {
  SolveCycles c;
  c.sparse_product = pass.product;
  c.update = pass.vectors.reading;
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
  if (work.extrapolated) c.setup += pass.vectors.writing;
  c.iterations = work.iterations;
  c.replacements = work.replacements;
  return c;
}

std::int64_t node_update_cycles(const Architecture& a, const Pattern& whole, int node,
                                std::span<const int> neighbours, const fixed::Settings& settings) {
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
  return clocks + node_inverse_cycles(a, settings);
}

std::int64_t node_inverse_cycles(const Architecture& a, const fixed::Settings& settings) {
  const std::int64_t adjugate = settings.method == Method::block_jacobi_pcg ? a.phase_clocks() : 0;
  return adjugate + divisions_a_node(settings.method) * a.inverse_division(settings);
}

std::int64_t load_cycles(const Architecture& a, const Pattern& p, const fixed::Settings& settings) {
  const int divisions = divisions_a_node(settings.method);
  if (divisions == 0) return 1;
  return divisions * p.nodes() * a.inverse_division(settings) + a.phase_clocks();
}

void require_division(const Architecture& a, const fixed::Settings& settings) {
  const int shortest = fixed::shortest_division(settings);
  if (a.division_clocks == 0 || a.division_clocks >= shortest) return;
  throw InputError("division_clocks", "found " + std::to_string(a.division_clocks) +
                                          ", expected 0, or at least " + std::to_string(shortest) +
                                          ": the divider takes " +
                                          std::to_string(fixed::most_division_clocks(settings)) +
                                          " clocks with these words and the re-scaling behind it " +
                                          std::to_string(fixed::rescaling_clocks(settings)));
}

namespace {

class Groups {
 public:
  Groups(const Architecture& a, int nodes)
      : pipeline_(a.phase_clocks()),
        way_(std::max(1, a.phase_clocks() - a.adder_tree_clocks - 1)),
        ports_(a.direction_accesses()),
        each_write_(a.direction_write_accesses()),
        count_(ceil_div(nodes, a.nodes_per_clock)),
        words_(ceil_div(a.nodes_per_clock, a.direction_banks)),
        last_words_(ceil_div(nodes - (count_ - 1) * a.nodes_per_clock, a.direction_banks)) {}

  std::int64_t alone() const { return count_ + pipeline_; }

  // Accesses that a group leaves in its last clock do not help the next one.
  std::int64_t reading() const {
    return (count_ - 1) * ceil_div(words_, ports_) + ceil_div(last_words_, ports_) + pipeline_;
  }

  // Counted from the clock in which the first group is written: the last one is when the ports have
  // served all but a clock's accesses of those before it, and its own hold up the ranks behind.
  std::int64_t writing() const {
    const std::int64_t before = (count_ - 1) * words_ * each_write_;
    const std::int64_t last = std::max(count_, ceil_div(before, ports_));
    const std::int64_t served = ceil_div(before + last_words_ * each_write_, ports_);
    return pipeline_ + std::max(last, served - 1);
  }

  // The writes of the groups that come back keep further ones out, now and then: step by step.
  std::int64_t moving() const {
    if (words_ * (1 + each_write_) <= ports_) return alone();
    std::vector<std::int64_t> entered;  // the lanes' steps at which groups did
    entered.reserve(static_cast<std::size_t>(count_));
    std::size_t written = 0;
    std::int64_t reads_left = 0;
    std::int64_t writes_left = 0;
    std::int64_t steps = 0;
    std::int64_t clock = 0;
    while (left(entered) > 0 || steps < entered.back() + pipeline_ - 1) {
      ++clock;
      if (writes_left > ports_) {
        writes_left -= ports_;
        continue;
      }
      std::int64_t accesses = ports_ - writes_left;
      writes_left = 0;
      ++steps;
      if (written < entered.size() && entered[written] + way_ == steps) {
        writes_left = words(++written) * each_write_;
        const std::int64_t now = std::min(accesses, writes_left);
        writes_left -= now;
        accesses -= now;
      }
      if (left(entered) == 0) continue;
      const std::int64_t needed = words(static_cast<std::int64_t>(entered.size()) + 1);
      if (reads_left == 0) reads_left = needed;
      if (needed <= ports_ && accesses < needed) continue;
      reads_left -= std::min(accesses, reads_left);
      if (reads_left == 0) entered.push_back(steps);
    }
    return clock + 1;
  }

 private:
  // Accesses to the fullest bank, by the group's number from 1.
  std::int64_t words(std::int64_t group) const { return group < count_ ? words_ : last_words_; }
  std::int64_t words(std::size_t group) const { return words(static_cast<std::int64_t>(group)); }
  std::int64_t left(const std::vector<std::int64_t>& entered) const {
    return count_ - static_cast<std::int64_t>(entered.size());
  }

  std::int64_t pipeline_;
  std::int64_t way_;  // from where it enters to its write
  std::int64_t ports_;
  std::int64_t each_write_;
  std::int64_t count_;
  std::int64_t words_;
  std::int64_t last_words_;
};

}  // namespace

VectorPasses vector_passes(const Architecture& a, int nodes) {
  const Groups groups(a, nodes);
  if (nodes == 0) return {groups.alone(), groups.alone(), groups.alone(), groups.alone()};
  return {groups.alone(), groups.reading(), groups.writing(), groups.moving()};
}

}  // namespace hvp::accel
