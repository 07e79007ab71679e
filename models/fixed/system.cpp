#include "models/fixed/system.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::fixed {

namespace {

std::vector<double> diagonal_scale(const sparse::BlockMatrix& matrix) {
  std::vector<double> scale(at(matrix.rows()));
  for (int i = 0; i < matrix.rows(); ++i) {
    const std::ptrdiff_t block = matrix.find(i / 3, i / 3);
    const double entry =
        block < 0 ? 0.0 : matrix.block(static_cast<std::size_t>(block))[at(4 * (i % 3))];
    scale[at(i)] = 1.0 / std::sqrt(entry);
    if (std::isnormal(scale[at(i)])) continue;
    throw InputError("matrix_scaling", "diagonal entry " + std::to_string(i) + " is " +
                                           fmt::to_string(entry) +
                                           "; a number above zero was expected");
  }
  return scale;
}

}  // namespace

sparse::BlockMatrix scaled(const sparse::BlockMatrix& matrix, std::span<const double> scale) {
  sparse::BlockMatrix result = matrix;
  for (int row = 0; row < result.block_rows(); ++row) {
    for (int k = result.row_begin[at(row)]; k < result.row_begin[at(row) + 1]; ++k) {
      const int column = result.column[at(k)];
      for (int e = 0; e < 9; ++e) {
        // The product of the two factors first, for the symmetry.
        result.block(at(k))[e] *= scale[at(3 * row + e / 3)] * scale[at(3 * column + e % 3)];
      }
    }
  }
  return result;
}

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
    system.matrix = quantise(scaled(matrix, system.scale), settings.matrix_bits);
  } else {
    system.scale.assign(at(matrix.rows()), 1.0);
    system.matrix = quantise(matrix, settings.matrix_bits);
  }
  system.settings.static_shift = settings.static_scale == StaticScale::matrix_norm
                                     ? static_shift_for(system.matrix)
                                     : settings.shift();
  return system;
}

sparse::BlockMatrix dequantise(const System& system) {
  sparse::BlockMatrix result = dequantise(system.matrix);
  if (system.settings.matrix_scaling == MatrixScaling::none) return result;
  for (int row = 0; row < result.block_rows(); ++row) {
    for (int k = result.row_begin[at(row)]; k < result.row_begin[at(row) + 1]; ++k) {
      const int column = result.column[at(k)];
      for (int e = 0; e < 9; ++e) {
        result.block(at(k))[e] /=
            system.scale[at(3 * row + e / 3)] * system.scale[at(3 * column + e % 3)];
      }
    }
  }
  return result;
}

}  // namespace hvp::fixed
