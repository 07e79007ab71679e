#include "models/sparse/block_matrix.h"

#include <algorithm>
#include <cassert>

namespace hvp::sparse {

std::ptrdiff_t BlockMatrix::find(int row, int col) const {
  const auto first = column.begin() + row_begin[static_cast<std::size_t>(row)];
  const auto last = column.begin() + row_begin[static_cast<std::size_t>(row) + 1];
  const auto hit = std::lower_bound(first, last, col);
  return hit != last && *hit == col ? hit - column.begin() : -1;
}

void BlockMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  assert(x.size() == static_cast<std::size_t>(rows()) && y.size() == x.size());
  const double* a = value.data();
  const int* other = column.data();
  double* out = y.data();
  for (std::size_t row = 0; row + 1 < row_begin.size(); ++row) {
    double sum[3] = {0, 0, 0};
    for (int k = row_begin[row]; k < row_begin[row + 1]; ++k) {
      const double* const v = x.data() + 3 * static_cast<std::size_t>(*other++);
      sum[0] += a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
      sum[1] += a[3] * v[0] + a[4] * v[1] + a[5] * v[2];
      sum[2] += a[6] * v[0] + a[7] * v[1] + a[8] * v[2];
      a += 9;
    }
    for (const double one : sum) *out++ = one;
  }
}

void BlockMatrix::subtract_column(int node, const Eigen::Vector3d& x, std::span<double> y) const {
  assert(y.size() == static_cast<std::size_t>(rows()));
  const auto row = static_cast<std::size_t>(node);
  for (int k = row_begin[row]; k < row_begin[row + 1]; ++k) {
    const double* a = block(static_cast<std::size_t>(k));
    double* target = &y[3 * static_cast<std::size_t>(column[static_cast<std::size_t>(k)])];
    for (std::size_t r = 0; r < 3; ++r) {
      target[r] -= a[r] * x[0] + a[3 + r] * x[1] + a[6 + r] * x[2];
    }
  }
}

Eigen::SparseMatrix<double> BlockMatrix::to_eigen() const {
  Eigen::SparseMatrix<double, Eigen::RowMajor> result(rows(), rows());
  Eigen::VectorXi row_size(rows());
  for (int i = 0; i < block_rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    row_size.segment<3>(3 * i).setConstant(3 * (row_begin[row + 1] - row_begin[row]));
  }
  result.reserve(row_size);
  for (int i = 0; i < block_rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (int r = 0; r < 3; ++r) {
      for (int k = row_begin[row]; k < row_begin[row + 1]; ++k) {
        const int col = column[static_cast<std::size_t>(k)];
        const double* a = block(static_cast<std::size_t>(k));
        for (int c = 0; c < 3; ++c) result.insert(3 * i + r, 3 * col + c) = a[3 * r + c];
      }
    }
  }
  result.makeCompressed();
  return result;
}

BlockMatrix BlockMatrix::submatrix(std::span<const int> nodes) const {
  std::vector<int> position(static_cast<std::size_t>(block_rows()), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    position[static_cast<std::size_t>(nodes[i])] = static_cast<int>(i);
  }
  BlockMatrix result;
  for (const int node : nodes) {
    const auto row = static_cast<std::size_t>(node);
    for (int k = row_begin[row]; k < row_begin[row + 1]; ++k) {
      const int col = position[static_cast<std::size_t>(column[static_cast<std::size_t>(k)])];
      if (col < 0) continue;
      result.column.push_back(col);
      const double* a = block(static_cast<std::size_t>(k));
      result.value.insert(result.value.end(), a, a + 9);
    }
    result.row_begin.push_back(static_cast<int>(result.column.size()));
  }
  return result;
}

}  // namespace hvp::sparse
