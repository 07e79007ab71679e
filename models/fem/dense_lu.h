#pragma once

#include <cstddef>
#include <vector>

namespace hvp::fem {

// LU with partial pivoting of the small dense matrix that couples prescribed displacements. Plain
// loops: Eigen's dense kernels block by the size of the machine's caches, and the bits with them.
class DenseLu {
 public:
  // Makes room for rows × rows entries, all zero.
  void resize(std::size_t rows);
  std::size_t rows() const { return pivot_.size(); }
  double& operator()(std::size_t row, std::size_t column) {
    return a_[row * pivot_.size() + column];
  }
  // Throws InputError if the matrix is singular.
  void factorise();
  // Solves in place; after factorise(). x has rows() entries.
  void solve(std::vector<double>& x) const;

 private:
  std::vector<double> a_;           // row by row
  std::vector<std::size_t> pivot_;  // the row exchanged with row i in step i
};

}  // namespace hvp::fem
