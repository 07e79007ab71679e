#include "tables/pc/crs_product.h"

#include "tables/hard_cases/bodies.h"

namespace hvp::tables {

void CrsMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  const double* const entries = value.data();
  const int* const columns = column.data();
  for (std::size_t row = 0; row < rows(); ++row) {
    double sum = 0;
    const int end = row_begin[row + 1];
    for (int k = row_begin[row]; k < end; ++k) {
      sum += entries[k] * x[static_cast<std::size_t>(columns[k])];
    }
    y[row] = sum;
  }
}

CrsMatrix crs_of(const sparse::BlockMatrix& blocks) {
  CrsMatrix crs;
  for (std::size_t node = 0; node + 1 < blocks.row_begin.size(); ++node) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = blocks.row_begin[node]; k < blocks.row_begin[node + 1]; ++k) {
        const auto block = static_cast<std::size_t>(k);
        for (std::size_t j = 0; j < 3; ++j) {
          crs.column.push_back(3 * blocks.column[block] + static_cast<int>(j));
          crs.value.push_back(blocks.block(block)[3 * i + j]);
        }
      }
      crs.row_begin.push_back(static_cast<int>(crs.value.size()));
    }
  }
  return crs;
}

CrsMatrix repeated(const CrsMatrix& one, int copies) {
  CrsMatrix many;
  for (int copy = 0; copy < copies; ++copy) {
    const auto entries = static_cast<int>(many.value.size());
    const int columns = copy * static_cast<int>(one.rows());
    for (std::size_t row = 1; row < one.row_begin.size(); ++row) {
      many.row_begin.push_back(entries + one.row_begin[row]);
    }
    for (const int column : one.column) many.column.push_back(columns + column);
    many.value.insert(many.value.end(), one.value.begin(), one.value.end());
  }
  return many;
}

sparse::BlockMatrix thesis_stiffness() {
  const mesh::TetMesh& mesh = sphere(500);
  return make_body(mesh, {}, lowest_nodes(mesh, 0.15)).stiffness;
}

}  // namespace hvp::tables
