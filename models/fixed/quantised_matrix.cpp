#include "models/fixed/quantised_matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::fixed {

namespace {

void require_node(const QuantisedMatrix& matrix, int node) {
  if (node >= 0 && node < matrix.block_rows()) return;
  throw InputError("node " + std::to_string(node) + " does not exist: the matrix has nodes 0 to " +
                   std::to_string(matrix.block_rows() - 1));
}

double largest_magnitude(const sparse::BlockMatrix& matrix) {
  double largest = 0;
  for (int i = 0; i < matrix.block_rows(); ++i) {
    for (int k = matrix.row_begin[at(i)]; k < matrix.row_begin[at(i) + 1]; ++k) {
      for (int e = 0; e < 9; ++e) {
        const double entry = matrix.block(at(k))[e];
        if (!std::isfinite(entry)) {
          throw InputError("matrix entry (" + std::to_string(3 * i + e / 3) + ", " +
                           std::to_string(3 * matrix.column[at(k)] + e % 3) +
                           ") is not a finite number");
        }
        largest = std::max(largest, std::abs(entry));
      }
    }
  }
  return largest;
}

}  // namespace

std::ptrdiff_t QuantisedMatrix::find(int row, int col) const {
  const auto first = column.begin() + row_begin[at(row)];
  const auto last = column.begin() + row_begin[at(row) + 1];
  const auto hit = std::lower_bound(first, last, col);
  return hit != last && *hit == col ? hit - column.begin() : -1;
}

std::span<const std::int32_t> QuantisedMatrix::row(int node) const {
  require_node(*this, node);
  const std::size_t first = at(row_begin[at(node)]);
  const std::size_t last = at(row_begin[at(node) + 1]);
  return {value.data() + 9 * first, 9 * (last - first)};
}

std::int32_t QuantisedMatrix::diagonal(int equation) const {
  const std::ptrdiff_t k = find(equation / 3, equation / 3);
  return k < 0 ? 0 : value[9 * static_cast<std::size_t>(k) + at(4 * (equation % 3))];
}

int QuantisedMatrix::zero_diagonals() const {
  int count = 0;
  for (int i = 0; i < rows(); ++i) count += diagonal(i) == 0 ? 1 : 0;
  return count;
}

std::int32_t QuantisedMatrix::mean_diagonal() const {
  if (rows() == 0) return 1;
  std::int64_t sum = 0;
  for (int i = 0; i < rows(); ++i) sum += diagonal(i);
  return static_cast<std::int32_t>(std::max<std::int64_t>(1, (2 * sum + rows()) / (2 * rows())));
}

void QuantisedMatrix::set_contact(int node, std::int32_t diagonal_word) {
  require_node(*this, node);
  if (diagonal_word < 1 || diagonal_word > word_limit(bits)) {
    throw InputError("a contact node's diagonal of " + std::to_string(diagonal_word) +
                     " was given; 1 to " + std::to_string(word_limit(bits)) +
                     " was expected for words of " + std::to_string(bits) + " bits");
  }
  for (int k = row_begin[at(node)]; k < row_begin[at(node) + 1]; ++k) {
    std::fill_n(value.begin() + 9 * k, 9, 0);
    const std::ptrdiff_t mirror = find(column[at(k)], node);
    std::fill_n(value.begin() + 9 * mirror, 9, 0);
  }
  const std::ptrdiff_t own = find(node, node);
  for (int e = 0; e < 9; e += 4) value[9 * static_cast<std::size_t>(own) + at(e)] = diagonal_word;
  is_contact[at(node)] = 1;
}

void QuantisedMatrix::restore_row(int node, std::span<const std::int32_t> original) {
  require_node(*this, node);
  const std::size_t expected = row(node).size();
  if (original.size() != expected) {
    throw InputError("a row of " + std::to_string(original.size()) + " words was given for node " +
                     std::to_string(node) + ", which has " + std::to_string(expected));
  }
  is_contact[at(node)] = 0;
  const int first = row_begin[at(node)];
  for (int k = first; k < row_begin[at(node) + 1]; ++k) {
    const int neighbour = column[at(k)];
    if (is_contact[at(neighbour)] != 0) continue;
    const std::ptrdiff_t mirror = find(neighbour, node);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const std::int32_t word = original[at(9 * (k - first) + 3 * r + c)];
        value[at(9 * k + 3 * r + c)] = word;
        value[9 * static_cast<std::size_t>(mirror) + at(3 * c + r)] = word;
      }
    }
  }
}

QuantisedMatrix quantise(const sparse::BlockMatrix& matrix, int bits, double headroom) {
  if (bits < 2 || bits > 32) {
    throw InputError("a matrix word of " + std::to_string(bits) + " bits; 2 to 32 was expected");
  }
  const double largest = largest_magnitude(matrix);
  const double scale = headroom * largest / static_cast<double>(word_limit(bits));
  if (scale < std::numeric_limits<double>::min()) {
    throw InputError("the largest entry of the matrix is " + fmt::to_string(largest) +
                     "; an entry was expected whose share of a word is a normal number");
  }
  QuantisedMatrix result;
  result.bits = bits;
  result.scale = scale;
  result.row_begin = matrix.row_begin;
  result.column = matrix.column;
  result.value.reserve(matrix.value.size());
  for (const double entry : matrix.value) {
    // round() sends ties away from zero; the quotient cannot pass the limit by half a unit.
    result.value.push_back(static_cast<std::int32_t>(std::round(entry / scale)));
  }
  result.is_contact.assign(at(matrix.block_rows()), 0);
  for (int i = 0; i < result.block_rows(); ++i) {
    if (result.find(i, i) < 0) {
      throw InputError("block row " + std::to_string(i) + " has no diagonal block");
    }
    for (int k = result.row_begin[at(i)]; k < result.row_begin[at(i) + 1]; ++k) {
      if (result.find(result.column[at(k)], i) < 0) {
        throw InputError("the pattern is not symmetric: block (" + std::to_string(i) + ", " +
                         std::to_string(result.column[at(k)]) + ") has no counterpart");
      }
    }
  }
  return result;
}

sparse::BlockMatrix dequantise(const QuantisedMatrix& matrix) {
  sparse::BlockMatrix result;
  result.row_begin = matrix.row_begin;
  result.column = matrix.column;
  result.value.reserve(matrix.value.size());
  for (const std::int32_t word : matrix.value) {
    result.value.push_back(matrix.scale * static_cast<double>(word));
  }
  return result;
}

}  // namespace hvp::fixed
