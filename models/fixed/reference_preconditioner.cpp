#include "models/fixed/reference_preconditioner.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::fixed {

namespace {

// Bits of P⁻¹ beyond those of the matrix: the stiffest diagonal still has 19.
constexpr int kInverseBits = 18;
// Words of the inverse blocks are a little shorter than 32 bits, so that the three products of a
// row's sum fit 64.
constexpr int kBlockLimitBits = 30;

// numerator / denominator to nearest, ties away from zero; denominator > 0.
Int128 nearest(Int128 numerator, Int128 denominator) {
  const Int128 size = numerator < 0 ? -numerator : numerator;
  const Int128 quotient = (2 * size + denominator) / (2 * denominator);
  return numerator < 0 ? -quotient : quotient;
}

}  // namespace

int ReferencePreconditioner::scale_bits(const Settings& settings) {
  return settings.matrix_bits + kInverseBits;
}

void ReferencePreconditioner::load(const QuantisedMatrix& matrix) {
  words_.assign(9 * at(matrix.block_rows()), 0);
  zero_.assign(at(matrix.block_rows()), 0);
  negative_.assign(at(matrix.block_rows()), 0);
  rows_of_length_ = {};
  rows_of_length_[0] = 3 * matrix.block_rows();
  for (int node = 0; node < matrix.block_rows(); ++node) update(matrix, node);
}

void ReferencePreconditioner::update(const QuantisedMatrix& matrix, int node) {
  count_rows(node, -1);
  invert(matrix, node);
  count_rows(node, 1);
  shift_ = static_cast<int>(rows_of_length_.size()) - 1;
  while (shift_ > 0 && rows_of_length_[at(shift_)] == 0) --shift_;
}

void ReferencePreconditioner::count_rows(int node, int change) {
  for (std::size_t row = 9 * at(node); row < 9 * at(node + 1); row += 3) {
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += magnitude(words_[row + c]);
    rows_of_length_[at(bit_length(sum))] += change;
  }
}

void ReferencePreconditioner::invert(const QuantisedMatrix& matrix, int node) {
  std::fill_n(words_.begin() + 9 * static_cast<std::ptrdiff_t>(node), 9, 0);
  zero_[at(node)] = 0;
  negative_[at(node)] = 0;
  for (int c = 0; c < 3; ++c) {
    const std::int32_t diagonal = matrix.diagonal(3 * node + c);
    if (diagonal == 0) zero_[at(node)] = 1;
    if (diagonal < 0) negative_[at(node)] = 1;  // eᵢᵀA eᵢ < 0
  }
  const bool blocks = settings_.method == Method::block_jacobi_pcg;
  if (!blocks || !invert_block(matrix, node)) invert_diagonal(matrix, node);
}

// A row without a positive diagonal takes no part; a tiny diagonal is clamped at the largest word.
void ReferencePreconditioner::invert_diagonal(const QuantisedMatrix& matrix, int node) {
  const Int128 one = Int128{1} << scale_bits(settings_);
  const Int128 limit = word_limit(
      settings_.method == Method::block_jacobi_pcg ? kBlockLimitBits : Settings::kProductBits);
  for (int c = 0; c < 3; ++c) {
    const Int128 diagonal = matrix.diagonal(3 * node + c);
    const Int128 inverse = diagonal > 0 ? nearest(one, diagonal) : 0;
    words_[at(9 * node + 4 * c)] = static_cast<std::int32_t>(std::min(inverse, limit));
  }
}

// adj(B) · 2^scale_bits / det(B), halved until all nine fit. Returns false where the block is not
// positive definite, which a part of a positive definite matrix must be.
bool ReferencePreconditioner::invert_block(const QuantisedMatrix& matrix, int node) {
  const std::int32_t* b = &matrix.value[9 * static_cast<std::size_t>(matrix.find(node, node))];
  const Int128 a00 = b[0];
  const Int128 a01 = b[1];
  const Int128 a02 = b[2];
  const Int128 a11 = b[4];
  const Int128 a12 = b[5];
  const Int128 a22 = b[8];
  const Int128 c00 = a11 * a22 - a12 * a12;
  const Int128 c01 = a02 * a12 - a01 * a22;
  const Int128 c02 = a01 * a12 - a02 * a11;
  const Int128 c11 = a00 * a22 - a02 * a02;
  const Int128 c12 = a01 * a02 - a00 * a12;
  const Int128 c22 = a00 * a11 - a01 * a01;
  const Int128 determinant = a00 * c00 + a01 * c01 + a02 * c02;
  if (a00 <= 0 || c22 <= 0 || determinant <= 0) {
    if (zero_[at(node)] == 0) negative_[at(node)] = 1;
    return false;
  }
  const std::array<Int128, 9> adjugate = {c00, c01, c02, c01, c11, c12, c02, c12, c22};
  const Int128 one = Int128{1} << scale_bits(settings_);
  std::array<Int128, 9> inverse{};
  Int128 largest = 0;
  for (std::size_t e = 0; e < 9; ++e) {
    inverse[e] = nearest(adjugate[e] * one, determinant);
    largest = std::max(largest, inverse[e] < 0 ? -inverse[e] : inverse[e]);
  }
  const int halvings =
      std::max(0, bit_length(static_cast<UInt128>(largest)) - (kBlockLimitBits - 1));
  for (std::size_t e = 0; e < 9; ++e) {
    const Int128 size = (inverse[e] < 0 ? -inverse[e] : inverse[e]) >> halvings;
    words_[9 * at(node) + e] = static_cast<std::int32_t>(inverse[e] < 0 ? -size : size);
  }
  return true;
}

stability::Flags ReferencePreconditioner::flags() const {
  stability::Flags flags;
  const auto set = [](std::uint8_t flag) { return flag != 0; };
  if (std::ranges::any_of(zero_, set)) flags.raise(stability::Flag::zero_diagonal);
  if (std::ranges::any_of(negative_, set)) flags.raise(stability::Flag::negative_curvature);
  return flags;
}

}  // namespace hvp::fixed
