#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// The part of each block row, 0 … parts − 1. Rows are dealt out longest first to the part with the
// fewest packages, which balances them as thesis §5.3 asks.
std::vector<int> deal_rows(const Architecture& a, const Pattern& p, int parts);

// The part of each block row by METIS' recursive bisection of the graph of the nodes, with their
// packages as weights: balanced, and with few blocks whose row and column fall into two parts.
// Every run gives the same parts. Throws std::invalid_argument if the pattern has no columns,
// InputError if there are fewer rows than parts.
std::vector<int> metis_parts(const Architecture& a, const Pattern& p, int parts);

// The spread of packages over parts.
struct Balance {
  std::int64_t fullest = 0;   // packages
  std::int64_t emptiest = 0;  // packages
  double mean = 0;            // packages

  // The share of clocks that is lost to the fullest part: 0 if all parts have the same number.
  double loss() const { return mean > 0 ? static_cast<double>(fullest) / mean - 1 : 0; }
};
Balance balance_of(const Architecture& a, const Pattern& p, std::span<const int> part, int parts);

// The padding of packages of PL2 columns (thesis §5.4) and the balance of the partitions (§5.3).
struct Packing {
  std::int64_t nonzeros = 0;  // words of the matrix that are stored
  std::int64_t stored = 0;    // the same with the padding of the packages
  Balance balance;            // of the partitions

  // The loss of thesis Equation 5.1: padding over non-zeros.
  double loss() const {
    if (nonzeros == 0) return 0;
    return static_cast<double>(stored - nonzeros) / static_cast<double>(nonzeros);
  }
};
Packing packing(const Architecture& a, const Pattern& whole);

// The effect of a partition of the nodes on the zeros of K (thesis §5.2). Rows and columns are
// reordered part by part, so that non-zeros gather in square blocks along the diagonal, and what
// lies outside need not be stored or multiplied. Everything is counted in blocks of 3 × 3.
struct Isolation {
  std::int64_t zeros = 0;
  std::int64_t nonzeros = 0;
  // Outside of the square blocks, each a part's rows by its own columns. They do not overlap, and
  // leave out non-zeros.
  std::int64_t zeros_outside = 0;
  std::int64_t nonzeros_outside = 0;
  // Outside of the blocks of a part's rows by all columns that they touch. These overlap (Fig. 5.2)
  // and contain every non-zero.
  std::int64_t zeros_outside_touched = 0;
  int largest_halo = 0;  // the most columns of other parts that any part touches

  double sparsity() const { return share(zeros, zeros + nonzeros); }
  double isolated() const { return share(zeros_outside, zeros); }
  double isolated_by_overlapping() const { return share(zeros_outside_touched, zeros); }
  double cut() const { return share(nonzeros_outside, nonzeros); }

 private:
  static double share(std::int64_t some, std::int64_t all) {
    return all > 0 ? static_cast<double>(some) / static_cast<double>(all) : 0;
  }
};

// `part` has the part of each block row, 0 … parts − 1. The pattern needs its columns.
Isolation isolation_of(const Pattern& p, std::span<const int> part, int parts);

}  // namespace hvp::accel
