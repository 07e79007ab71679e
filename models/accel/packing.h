#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/partition.h"

namespace hvp::accel {

// What packages of PL2 columns cost (thesis §5.4), and how even the partitions are (§5.3).
struct Packing {
  std::int64_t nonzeros = 0;  // words of the matrix that are stored
  std::int64_t stored = 0;    // with the padding of the packages
  Balance balance;            // of the partitions

  // Equation 5.1: padding over non-zeros.
  double loss() const {
    if (nonzeros == 0) return 0;
    return static_cast<double>(stored - nonzeros) / static_cast<double>(nonzeros);
  }
};
Packing packing(const Architecture& a, const Pattern& whole);

// Equation 5.1 itself, an estimate: half a package of padding a row of so many non-zeros.
constexpr double expected_packing_loss(int package, double nonzeros_a_row) {
  return package / 2.0 / nonzeros_a_row;
}

}  // namespace hvp::accel
