#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <span>
#include <vector>

namespace hvp::fixed::test {

// The same algorithm (thesis §4.2, §4.3) in double precision from zero: the solution after each
// of the given numbers of updates, ascending.
std::vector<Eigen::VectorXd> double_cg(const Eigen::SparseMatrix<double>& a,
                                       const Eigen::VectorXd& b, bool preconditioned,
                                       std::span<const int> updates);

}  // namespace hvp::fixed::test
