#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// Part of each block row, 0 … parts − 1. Rows are dealt out longest first to the part that has
// fewest packages, which balances them as thesis §5.3 asks.
std::vector<int> deal_rows(const Architecture& a, const Pattern& p, int parts);

// Part of each block row, by METIS' recursive bisection of the graph of the nodes with their
// packages as weights: balanced, and with few blocks whose row and column fall into two parts.
// The same parts at every run. Needs the pattern's columns; throws std::invalid_argument where they
// are missing, InputError where there are fewer rows than parts.
std::vector<int> metis_parts(const Architecture& a, const Pattern& p, int parts);

// How evenly packages are spread over parts.
struct Balance {
  std::int64_t fullest = 0;   // packages
  std::int64_t emptiest = 0;  // packages
  double mean = 0;            // packages

  // Clocks lost to the fullest part: 0 where all have as many.
  double loss() const { return mean > 0 ? static_cast<double>(fullest) / mean - 1 : 0; }
};
Balance balance_of(const Architecture& a, const Pattern& p, std::span<const int> part, int parts);

}  // namespace hvp::accel
