#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/fem/direct_solver.h"

namespace hvp::fem {

// Two systems whose matrices have one pattern, a matrix and its rounded counterpart, solved beside
// each other: the same bits as one after the other, in two thirds of the time, because a
// substitution mostly waits for its last subtraction. Where the patterns differ, one after the
// other it is.
class ReferencePair {
 public:
  // Keeps references to both. Throws InputError where one is singular.
  ReferencePair(DirectSolver& one, DirectSolver& other);

  // A right-hand side and where its solution goes; they may be the same.
  struct System {
    std::span<const double> f;
    std::span<double> x;
  };
  void solve(const System& one, const System& other);
  // DirectSolver::solve_with_contact() of both.
  void solve_with_contact(const System& one, const System& other, std::span<const int> patch,
                          std::span<const Eigen::Vector3d> u);

 private:
  DirectSolver& one_;
  DirectSolver& other_;
  bool alike_ = false;
  std::vector<double> factor_;   // the values of both L, side by side
  std::vector<double> scratch_;  // both, in the permuted order, side by side
};

}  // namespace hvp::fem
