#include "models/fixed/system.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "models/config/input_error.h"
#include "models/fixed/word.h"

namespace hvp::fixed {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::vector<double> diagonal_scale(const sparse::BlockMatrix& matrix) {
  std::vector<double> scale(at(matrix.rows()));
  for (int i = 0; i < matrix.rows(); ++i) {
    const std::ptrdiff_t block = matrix.find(i / 3, i / 3);
    const double entry =
        block < 0 ? 0.0 : matrix.block(static_cast<std::size_t>(block))[at(4 * (i % 3))];
    scale[at(i)] = 1.0 / std::sqrt(entry);
    if (std::isnormal(scale[at(i)])) continue;
    throw InputError("matrix_scaling", "diagonal entry " + std::to_string(i) + " is " +
                                           std::to_string(entry) +
                                           "; a number above zero was expected");
  }
  return scale;
}

}  // namespace

int static_shift_for(const QuantisedMatrix& matrix) {
  std::uint64_t largest = 1;
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const auto words = matrix.row(row);
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint64_t sum = 0;
      for (std::size_t k = 0; k < words.size(); k += 9) {
        for (std::size_t e = 0; e < 3; ++e) sum += magnitude(words[k + 3 * c + e]);
      }
      largest = std::max(largest, sum);
    }
  }
  return std::min(bit_length(largest - 1), 31);
}

System prepare(const sparse::BlockMatrix& matrix, const Settings& settings) {
  System system{.settings = settings, .matrix = {}, .scale = {}};
  if (settings.matrix_scaling == MatrixScaling::diagonal) {
    system.scale = diagonal_scale(matrix);
    sparse::BlockMatrix scaled = matrix;
    for (int row = 0; row < scaled.block_rows(); ++row) {
      for (int k = scaled.row_begin[at(row)]; k < scaled.row_begin[at(row) + 1]; ++k) {
        const int column = scaled.column[at(k)];
        for (int e = 0; e < 9; ++e) {
          // The product of the two factors first: what is symmetric stays so to the last bit.
          scaled.block(at(k))[e] *=
              system.scale[at(3 * row + e / 3)] * system.scale[at(3 * column + e % 3)];
        }
      }
    }
    system.matrix = quantise(scaled, settings.matrix_bits);
  } else {
    system.scale.assign(at(matrix.rows()), 1.0);
    system.matrix = quantise(matrix, settings.matrix_bits);
  }
  if (settings.static_scale == StaticScale::matrix_norm) {
    system.settings.static_shift = static_shift_for(system.matrix);
  }
  return system;
}

}  // namespace hvp::fixed
