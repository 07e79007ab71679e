#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "models/fixed/reference_solver.h"
#include "models/fixed/solver.h"
#include "tests/fixed/record.h"

namespace hvp::fixed::test {

// Those that this machine has, the reference left out.
std::vector<Kernel> fast_kernels();

// A solver of each kernel with one matrix, which all of them watch.
class Contest {
 public:
  Contest(const Settings& settings, QuantisedMatrix matrix);

  const QuantisedMatrix& matrix() const { return matrix_; }
  void set_contact(int node, std::int32_t diagonal);
  void restore(int node);

  // Expects the same of every kernel, to the last bit; returns the reference's record.
  Record compare(const std::vector<std::int32_t>& b, const std::vector<std::int32_t>& guess);

 private:
  void update(int node);

  QuantisedMatrix matrix_;
  QuantisedMatrix original_;
  ReferenceSolver reference_;
  std::vector<std::unique_ptr<Solver>> fast_;
};

}  // namespace hvp::fixed::test
