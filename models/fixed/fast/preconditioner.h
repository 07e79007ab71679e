#pragma once

#include <cstdint>
#include <vector>

#include "models/fixed/fast/packed_matrix.h"
#include "models/fixed/fast/passes.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/stability/flag.h"

namespace hvp::fixed::fast {

// P⁻¹ of thesis §4.3 in integer words (docs/fixed-point.md), formed at load and update, in the
// order of the packed matrix: one entry for each row for the inverse diagonal, otherwise the blocks
// of each slice.
class Preconditioner {
 public:
  explicit Preconditioner(const Settings& settings)
      : blocks_(settings.method == Method::block_jacobi_pcg),
        scale_bits_(settings.matrix_bits + kInverseBits) {}

  void load(const QuantisedMatrix& matrix, const PackedMatrix& order);
  void update(const QuantisedMatrix& matrix, const PackedMatrix& order, int node);

  bool blocks() const { return blocks_; }
  const std::int32_t* diagonal() const { return words_.data(); }
  WideSlices slices() const {
    return {.value = words_.data(),
            .slice_begin = slice_begin_.data(),
            .first = first_.data(),
            .slices = slice_begin_.size() - 1};
  }
  // The words are P⁻¹ · 2^scale_bits, and z = P⁻¹·r drops `dropped` bits of the sum.
  int scale_bits() const { return scale_bits_; }
  int dropped() const { return dropped_; }
  stability::Flags flags() const { return flags_; }

 private:
  static constexpr int kInverseBits = 18;

  void invert(const QuantisedMatrix& matrix, std::size_t first_row, int node);
  void put(std::size_t first_row, int row, int column, std::int32_t word);
  void summarise();

  bool blocks_;
  int scale_bits_;
  int dropped_ = 0;
  stability::Flags flags_;
  Aligned<std::int32_t> words_;
  std::vector<int> slice_begin_ = {0};
  Aligned<std::uint32_t> first_;
  std::vector<std::uint64_t> widest_;          // per node: largest absolute row sum
  std::vector<std::uint8_t> zero_, negative_;  // per node
};

}  // namespace hvp::fixed::fast
