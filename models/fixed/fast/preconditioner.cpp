#include "models/fixed/fast/preconditioner.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include "models/fixed/fast/arithmetic.h"
#include "models/index.h"

namespace hvp::fixed::fast {

namespace {

using Row = std::array<Int128, 3>;

// Words of the inverse blocks have 30 bits, so that three products fit 64.
constexpr int kBlockBits = 30;

Row cross(const Row& a, const Row& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

UInt128 size_of_wide(Int128 value) { return static_cast<UInt128>(value < 0 ? -value : value); }

}  // namespace

void Preconditioner::load(const QuantisedMatrix& matrix, const PackedMatrix& order) {
  const std::size_t rows = order.padded_rows();
  const std::size_t slices = rows / (3 * kSliceNodes);
  words_.assign(blocks_ ? kWideStep * slices : rows, 0);
  if (blocks_) {
    slice_begin_.resize(slices + 1);
    std::iota(slice_begin_.begin(), slice_begin_.end(), 0);
    first_.resize(rows / 3);
    for (std::size_t i = 0; i < first_.size(); ++i) first_[i] = static_cast<std::uint32_t>(3 * i);
  }
  for (auto* flags : {&zero_, &negative_}) flags->assign(at(matrix.block_rows()), 0);
  widest_.assign(at(matrix.block_rows()), 0);
  for (int node = 0; node < matrix.block_rows(); ++node) {
    invert(matrix, order.first_row(node), node);
  }
  summarise();
}

void Preconditioner::update(const QuantisedMatrix& matrix, const PackedMatrix& order, int node) {
  invert(matrix, order.first_row(node), node);
  summarise();
}

void Preconditioner::put(std::size_t first_row, int row, int column, std::int32_t word) {
  const std::size_t place = first_row / 3;
  if (blocks_) {
    words_[kWideStep * (place / kSliceNodes) + kSliceNodes * at(3 * row + column) +
           place % kSliceNodes] = word;
  } else if (row == column) {
    words_[first_row + at(row)] = word;
  }
}

// The inverse of the block through the cross products of its rows, which are symmetric: the words
// above the diagonal stand for those below. Where the block is not positive definite, the
// inverses of its diagonal.
void Preconditioner::invert(const QuantisedMatrix& matrix, std::size_t first_row, int node) {
  const std::ptrdiff_t own = matrix.find(node, node);
  const std::int32_t* b = &matrix.value[9 * static_cast<std::size_t>(own)];
  const std::array<Row, 3> a = {Row{b[0], b[1], b[2]}, Row{b[1], b[4], b[5]},
                                Row{b[2], b[5], b[8]}};
  zero_[at(node)] = a[0][0] == 0 || a[1][1] == 0 || a[2][2] == 0 ? 1 : 0;
  negative_[at(node)] = a[0][0] < 0 || a[1][1] < 0 || a[2][2] < 0 ? 1 : 0;
  std::array<std::array<std::int32_t, 3>, 3> inverse{};

  const std::array<Row, 3> adjugate = {cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])};
  const Int128 determinant =
      a[0][0] * adjugate[0][0] + a[0][1] * adjugate[0][1] + a[0][2] * adjugate[0][2];
  const bool definite = a[0][0] > 0 && adjugate[2][2] > 0 && determinant > 0;
  if (blocks_ && definite) {
    const auto d = static_cast<UInt128>(determinant);
    std::array<std::array<UInt128, 3>, 3> size{};
    UInt128 largest = 0;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        // To nearest, ties away from zero.
        const UInt128 numerator = size_of_wide(adjugate[r][c]) << scale_bits_;
        const UInt128 rest = numerator % d;
        size[r][c] = numerator / d + (rest >= d - rest ? 1 : 0);
        largest = std::max(largest, size[r][c]);
      }
    }
    const int halvings = std::max(0, width(largest) - (kBlockBits - 1));
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto word = static_cast<std::int32_t>(size[r][c] >> halvings);
        inverse[r][c] = adjugate[r][c] < 0 ? -word : word;
      }
    }
  } else {
    if (blocks_ && zero_[at(node)] == 0) negative_[at(node)] = 1;
    const std::int64_t limit = largest_word(blocks_ ? kBlockBits : Settings::kProductBits);
    const std::int64_t one = std::int64_t{1} << scale_bits_;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto diagonal = static_cast<std::int64_t>(a[c][c]);
      if (diagonal <= 0) continue;
      inverse[c][c] = static_cast<std::int32_t>(std::min(limit, (one + diagonal / 2) / diagonal));
    }
  }

  widest_[at(node)] = 0;
  for (int r = 0; r < 3; ++r) {
    std::uint64_t sum = 0;
    for (int c = 0; c < 3; ++c) {
      put(first_row, r, c, inverse[at(r)][at(c)]);
      sum += size_of(inverse[at(r)][at(c)]);
    }
    widest_[at(node)] = std::max(widest_[at(node)], sum);
  }
}

void Preconditioner::summarise() {
  const auto set = [](std::uint8_t flag) { return flag != 0; };
  flags_ = {};
  if (std::ranges::any_of(zero_, set)) flags_.raise(stability::Flag::zero_diagonal);
  if (std::ranges::any_of(negative_, set)) flags_.raise(stability::Flag::negative_curvature);
  std::uint64_t widest = 0;
  for (const std::uint64_t sum : widest_) widest = std::max(widest, sum);
  dropped_ = width(widest);
}

}  // namespace hvp::fixed::fast
