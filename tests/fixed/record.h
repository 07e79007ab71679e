#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/fixed/solver.h"

namespace hvp::fixed::test {

inline constexpr std::array<const char*, 8> kVectorNames = {"x", "r", "z", "d", "q", "w", "n", "v"};

// Every word and scalar that an observer can see of one iteration.
struct IterationRecord {
  int iteration = 0;
  std::vector<std::vector<std::int32_t>> vectors;  // in the order of their names
  Int128 d_q = 0, z_r = 0;
  Coefficient alpha, beta;
  int residual_exponent = 0, direction_exponent = 0;
};

// Everything that a solve gives.
struct Record : Observer {
  void iteration(const IterationState& state) override;
  std::vector<IterationRecord> iterations;
  std::vector<std::int32_t> x;
  Report report;
};

Record record(Solver& solver, const std::vector<std::int32_t>& b, std::vector<std::int32_t> guess);

// Where the two differ first, in words; empty where they agree to the last bit.
std::string difference(const Record& one, const Record& other);

}  // namespace hvp::fixed::test
