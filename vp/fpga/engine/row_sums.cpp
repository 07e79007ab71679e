#include "vp/fpga/engine/row_sums.h"

#include <algorithm>
#include <bit>

#include "models/index.h"

namespace hvp::vp::engine {

namespace {

// The bits of the words' magnitudes: all words lie in [−2^bits, 2^bits).
int magnitude_bits(std::span<const std::int32_t> words) {
  std::uint32_t used = 0;
  for (const std::int32_t word : words) used |= static_cast<std::uint32_t>(word ^ (word >> 31));
  return static_cast<int>(std::bit_width(used));
}

}  // namespace

void RowSums::load(const Layout& layout, const Partition& partition) {
  partition_ = &partition;
  package_columns_ = at(layout.package_columns());
  row_.clear();
  node_.clear();
  std::size_t words = 0;    // of Operands::matrix
  std::size_t longest = 0;  // chunks of a row
  for (std::size_t i = 0; i < partition.row.size(); ++i) {
    Row row;
    row.first_block = node_.size();
    for (int k = partition.first_package[i]; k < partition.first_package[i + 1]; ++k) {
      const std::size_t package = at(k);
      const int* const nodes = &partition.node[package * at(layout.nodes_in_package())];
      // A block belongs to the package that has its first column.
      for (int c = 0; c < partition.columns[package]; ++c) {
        const int column = partition.phase[package] + c;
        if (column % 3 == 0) node_.push_back(nodes[at(column / 3)]);
      }
    }
    row.blocks = node_.size() - row.first_block;
    row.first_word = words;
    row.chunks = (row.blocks + kChunkBlocks - 1) / kChunkBlocks;
    row.has_own_block = std::find(node_.begin() + static_cast<std::ptrdiff_t>(row.first_block),
                                  node_.end(), partition.row[i]) != node_.end();
    words += 3 * kChunk * row.chunks;
    longest = std::max(longest, row.chunks);
    row_.push_back(row);
  }
  // Both, since nothing is allocated once a job runs.
  const auto allocate = [&](auto& operands) {
    operands.matrix.assign(words, 0);
    operands.gathered.assign(kChunk * longest, 0);
  };
  allocate(narrow_words_);
  allocate(wide_words_);
  matrix_written();
}

void RowSums::begin(std::span<const std::int32_t> nonzeros, DirectionCopies& vector) {
  if (!narrow_words_.copied && !wide_words_.copied) matrix_bits_ = magnitude_bits(nonzeros);
  const DirectionCopies::Operand& operand = vector.operand();
  // A sum of so many products, each up to 2^(matrix_bits + operand.bits), has to fit into 32 bits.
  constexpr int kGrowth = std::bit_width(3 * kChunkBlocks);
  narrow_ = matrix_bits_ <= 15 && operand.bits <= 15 && matrix_bits_ + operand.bits + kGrowth <= 31;
  narrow_words_.vector = operand.narrow.data();
  wide_words_.vector = vector.words().data();
  if (narrow_) {
    copy_matrix(nonzeros, narrow_words_);
  } else {
    copy_matrix(nonzeros, wide_words_);
  }
}

template <class Word, std::size_t stride>
void RowSums::copy_matrix(std::span<const std::int32_t> nonzeros,
                          Operands<Word, stride>& to) const {
  if (to.copied) return;
  to.copied = true;
  for (std::size_t i = 0; i < row_.size(); ++i) {
    const std::size_t first_package = at(partition_->first_package[i]);
    for (std::size_t column = 0; column < 3 * row_[i].blocks; ++column) {
      const std::size_t package = first_package + column / package_columns_;
      const std::size_t place = kBlockColumns * (column / 3) + column % 3;
      for (std::size_t r = 0; r < 3; ++r) {
        to.matrix[row_[i].first_word + r * kChunk * row_[i].chunks + place] = static_cast<Word>(
            nonzeros[(3 * package + r) * package_columns_ + column % package_columns_]);
      }
    }
  }
}

template <class Sum, class Word, std::size_t stride>
std::array<std::int64_t, 3> RowSums::sum_of(Operands<Word, stride>& operands,
                                            const Row& row) const {
  // What lies in the last chunk behind the row's blocks is multiplied by zeros.
  Word* gathered = operands.gathered.data();
  for (std::size_t block = 0; block < row.blocks; ++block, gathered += kBlockColumns) {
    const std::size_t node = at(node_[row.first_block + block]);
    std::copy_n(operands.vector + stride * node, stride, gathered);
  }
  std::array<std::int64_t, 3> sums{};
  const Word* a = &operands.matrix[row.first_word];
  for (std::int64_t& sum : sums) {
    const Word* d = operands.gathered.data();
    for (std::size_t chunk = 0; chunk < row.chunks; ++chunk, a += kChunk, d += kChunk) {
      Sum of_chunk = 0;
      for (std::size_t c = 0; c < kChunk; ++c) of_chunk += Sum{a[c]} * Sum{d[c]};
      sum += of_chunk;
    }
  }
  return sums;
}

std::array<std::int64_t, 3> RowSums::sum(int row) {
  return narrow_ ? sum_of<std::int32_t>(narrow_words_, row_[at(row)])
                 : sum_of<std::int64_t>(wide_words_, row_[at(row)]);
}

}  // namespace hvp::vp::engine
