#include "models/fixed/fast/packed_matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "models/fixed/fast/arithmetic.h"
#include "models/index.h"

namespace hvp::fixed::fast {

namespace {

// Nodes that are sorted among themselves: the bodies that one board holds in one go, while what
// a slice of a larger one reads spans this many nodes more.
constexpr std::size_t kWindow = 1024;
// Vectors are whole cache lines of whole slices.
constexpr std::size_t kVectorNodes = 16;

// Words of a slice with so many steps.
std::size_t paired_words(std::size_t steps) {
  return kQuadWords * (steps / kQuadSteps) + kPairedStep * (steps % kQuadSteps);
}

// In which step of its row a block is read: the diagonal one first, the others in their order.
std::size_t step_of(const QuantisedMatrix& matrix, int row, int block) {
  const int column = matrix.column[at(block)];
  if (column == row) return 0;
  return at(block - matrix.row_begin[at(row)]) + (column < row ? 1 : 0);
}

bool is_short(std::int32_t word) {
  return word >= std::numeric_limits<std::int16_t>::min() &&
         word <= std::numeric_limits<std::int16_t>::max();
}

}  // namespace

void PackedMatrix::load(const QuantisedMatrix& matrix, int vector_bits) {
  vector_bits_ = vector_bits;
  row_size_.assign(at(matrix.rows()), 0);
  for (int row = 0; row < matrix.block_rows(); ++row) size_row(matrix, row);
  measure();
  paired_ = fits_pairs() && std::ranges::all_of(matrix.value, is_short);
  place_nodes(matrix);
  lay_out(matrix);
  pack(matrix);
}

void PackedMatrix::place_nodes(const QuantisedMatrix& matrix) {
  const std::size_t nodes = at(matrix.block_rows());
  const auto length = [&](std::size_t node) {
    return matrix.row_begin[node + 1] - matrix.row_begin[node];
  };
  order_.resize(nodes);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (std::size_t first = 0; first < nodes; first += kWindow) {
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = order_.begin() + static_cast<std::ptrdiff_t>(std::min(first + kWindow, nodes));
    // Stable, and without the memory that std::stable_sort takes: a renewal is in the frame loop.
    std::sort(begin, end, [&](std::size_t a, std::size_t b) {
      return length(a) != length(b) ? length(a) < length(b) : a < b;
    });
  }
  place_.resize(nodes);
  for (std::size_t place = 0; place < nodes; ++place) place_[order_[place]] = place;
  padded_rows_ = 3 * ((nodes + kVectorNodes - 1) / kVectorNodes * kVectorNodes);

  slice_begin_.assign(padded_rows_ / (3 * kSliceNodes) + 1, 0);
  for (std::size_t place = 0; place < nodes; ++place) {
    int& steps = slice_begin_[place / kSliceNodes + 1];
    steps = std::max(steps, length(order_[place]));
  }
  value_begin_.assign(slice_begin_.size(), 0);
  for (std::size_t slice = 1; slice < slice_begin_.size(); ++slice) {
    value_begin_[slice] = value_begin_[slice - 1] + paired_words(at(slice_begin_[slice]));
    slice_begin_[slice] += slice_begin_[slice - 1];
  }
}

// The places at which blocks of a vector are read. They depend on the pattern alone.
void PackedMatrix::lay_out(const QuantisedMatrix& matrix) {
  short_index_ = paired_ && place_.size() <= std::size_t{1} << 16;
  const std::size_t entries = kSliceNodes * at(slice_begin_.back());
  short_column_.assign(short_index_ ? entries : 0, 0);
  long_column_.reserve(entries);  // update() may change the layout
  long_column_.assign(short_index_ ? 0 : entries, 0);
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const std::size_t slice = place_[at(row)] / kSliceNodes;
    const std::size_t lane = place_[at(row)] % kSliceNodes;
    for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
      const std::size_t step = at(slice_begin_[slice]) + step_of(matrix, row, k);
      const std::size_t entry = kSliceNodes * step + lane;
      const int column = matrix.column[at(k)];
      const std::size_t read = paired_ ? place_[at(column)] : first_row(column);
      if (short_index_) {
        short_column_[entry] = static_cast<std::uint16_t>(read);
      } else {
        long_column_[entry] = static_cast<std::uint32_t>(read);
      }
    }
  }
}

void PackedMatrix::pack(const QuantisedMatrix& matrix) {
  const std::size_t steps = at(slice_begin_.back());
  words16_.assign(paired_ ? value_begin_.back() : 0, 0);
  words32_.reserve(kWideStep * steps);
  words32_.assign(paired_ ? 0 : kWideStep * steps, 0);
  for (int row = 0; row < matrix.block_rows(); ++row) {
    for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
      pack_block(matrix, row, k);
    }
  }
}

void PackedMatrix::pack_block(const QuantisedMatrix& matrix, int row, int block) {
  const std::size_t slice = place_[at(row)] / kSliceNodes;
  const std::size_t lane = place_[at(row)] % kSliceNodes;
  const std::size_t step = step_of(matrix, row, block);
  const std::size_t steps = at(slice_begin_[slice + 1] - slice_begin_[slice]);
  const bool in_quad = step < steps / kQuadSteps * kQuadSteps;
  std::int16_t* const words16 =
      words16_.data() + value_begin_[slice] + kRowWords * lane +
      (in_quad ? paired_words(step / kQuadSteps * kQuadSteps) : paired_words(step));
  std::int32_t* const words32 =
      words32_.data() + kWideStep * (at(slice_begin_[slice]) + step) + lane;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t word = matrix.value[9 * at(block) + 3 * r + c];
      if (paired_) {
        words16[kRowStep * r + (in_quad ? kQuadWord[step % kQuadSteps][c] : c)] =
            static_cast<std::int16_t>(word);
      } else {
        words32[kSliceNodes * (3 * r + c)] = word;
      }
    }
  }
}

void PackedMatrix::update(const QuantisedMatrix& matrix, int node) {
  bool still_short = true;
  for (int k = matrix.row_begin[at(node)]; k < matrix.row_begin[at(node) + 1]; ++k) {
    const int neighbour = matrix.column[at(k)];
    const auto mirror = static_cast<int>(matrix.find(neighbour, node));
    for (std::size_t e = 0; e < 9; ++e) {
      still_short = still_short && is_short(matrix.value[9 * at(k) + e]) &&
                    is_short(matrix.value[9 * at(mirror) + e]);
    }
    pack_block(matrix, node, k);
    pack_block(matrix, neighbour, mirror);
    size_row(matrix, neighbour);
  }
  measure();
  if (paired_ && !(still_short && fits_pairs())) {
    // A restored row can be larger than that of the loaded matrix.
    paired_ = false;
    lay_out(matrix);
    pack(matrix);
  }
}

bool PackedMatrix::fits_pairs() const {
  return vector_bits_ <= 16 && largest_row_ < (std::uint64_t{1} << (32 - vector_bits_));
}

void PackedMatrix::size_row(const QuantisedMatrix& matrix, int row) {
  std::uint64_t* size = &row_size_[3 * at(row)];
  std::fill_n(size, 3, 0);
  for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
    for (std::size_t e = 0; e < 9; ++e) size[e / 3] += size_of(matrix.value[9 * at(k) + e]);
  }
}

void PackedMatrix::measure() {
  largest_row_ = 0;
  std::uint64_t exact = 0;  // Σ of squares, as long as it is a double's
  bool fits = true;
  for (const std::uint64_t size : row_size_) {
    largest_row_ = std::max(largest_row_, size);
    fits = fits && size < (std::uint64_t{1} << 26);
    exact += fits ? size * size : 0;
    fits = fits && exact < (std::uint64_t{1} << 53);
  }
  // Below 2^53 every partial sum of doubles is exact, in whatever order.
  if (fits) {
    rounding_floor_ = std::sqrt(static_cast<double>(exact));
    return;
  }
  double sum = 0;
  for (const std::uint64_t size : row_size_) {
    const auto entry = static_cast<double>(size);
    sum += entry * entry;
  }
  rounding_floor_ = std::sqrt(sum);
}

PairedSlices PackedMatrix::paired_slices() const {
  return {.value = words16_.data(),
          .slice_begin = slice_begin_.data(),
          .short_node = short_index_ ? short_column_.data() : nullptr,
          .long_node = short_index_ ? nullptr : long_column_.data(),
          .slices = slice_begin_.size() - 1};
}

WideSlices PackedMatrix::wide_slices() const {
  return {.value = words32_.data(),
          .slice_begin = slice_begin_.data(),
          .first = long_column_.data(),
          .slices = slice_begin_.size() - 1};
}

std::size_t PackedMatrix::bytes() const {
  const std::size_t words =
      words16_.size() * sizeof(std::int16_t) + words32_.size() * sizeof(std::int32_t);
  return words + short_column_.size() * sizeof(std::uint16_t) +
         long_column_.size() * sizeof(std::uint32_t) + slice_begin_.size() * sizeof(int);
}

}  // namespace hvp::fixed::fast
