#pragma once

#include <cstddef>
#include <cstdint>

#include "models/fixed/types.h"

// The passes over vectors that the fast solver consists of, and their arguments. A kernel is a
// table of them. Sources with instructions beyond the baseline include this header, so it has plain
// data only: the linker could keep the version of an inline function that not every machine can
// run.
//
// Vectors start and end at a cache line; the words behind their last entry are zero and stay zero.
namespace hvp::fixed::fast {

// The nodes of a slice, and the words of one of their rows in a step of the paired layout: a row of
// a block is (x, y, z, 0), and the node of the vector that it is multiplied by has (x, y, z) and
// any fourth word.
inline constexpr std::size_t kSliceNodes = 8;
inline constexpr std::size_t kRowWords = 4;
inline constexpr std::size_t kRowStep = kSliceNodes * kRowWords;
inline constexpr std::size_t kPairedStep = 3 * kRowStep;   // [row][node][word]
inline constexpr std::size_t kWideStep = 9 * kSliceNodes;  // [row][column][node]

// Four steps are packed into three: the z of two steps stand together, and so do the (x, y) of the
// second and the fourth. kQuadWord[step][column] is a word's place within the four steps, from the
// place of the row and the node in a step.
inline constexpr std::size_t kQuadSteps = 4;
inline constexpr std::size_t kQuadWords = 3 * kPairedStep;
inline constexpr std::size_t kQuadWord[kQuadSteps][3] = {
    {0, 1, 2},
    {2 * kPairedStep, 2 * kPairedStep + 1, 3},
    {kPairedStep, kPairedStep + 1, kPairedStep + 2},
    {2 * kPairedStep + 2, 2 * kPairedStep + 3, kPairedStep + 3}};

// The matrix in slices of eight nodes. A step has one block of each node, the first step the
// diagonal ones, whose words of the vector stand side by side. If a node has no block left, its
// words are zero. A slice of the paired layout has as many packed fours of steps as possible; the
// other steps stand alone. A block is multiplied by four words of the vector, those of the node in
// its column.
struct PairedSlices {
  const std::int16_t* value = nullptr;
  const int* slice_begin = nullptr;           // steps; size slices + 1
  const std::uint16_t* short_node = nullptr;  // either this
  const std::uint32_t* long_node = nullptr;   // or that
  std::size_t slices = 0;
};

// The matrix in wide words. `first` is the row of the vector by which a block's first column is
// multiplied.
struct WideSlices {
  const std::int32_t* value = nullptr;
  const int* slice_begin = nullptr;
  const std::uint32_t* first = nullptr;
  std::size_t slices = 0;
};

// A shift to the right that rounds. For a magnitude it is (size + bias + (size's bit at `right` &
// odd)) >> right; for a signed value (value + bias + (value < 0 ? below_zero : 0) + …) >> right,
// because a shift of a negative number rounds down.
struct RightShift {
  std::uint32_t right = 0;
  std::uint32_t odd = 0;  // 0 or 1
  std::uint64_t bias = 0;
  std::int64_t below_zero = 0;
};

// out = word(a · 2^left or a >> a_right, + factor · b >> b_right), entry by entry. The caller has
// made sure that every term and their sum stay within ±(2^31 - 1), and that
//   a_right <= 31, a_left = 0 or a_right = 0;
//   b_right <= 60;
//   short_product: factor and b fit 16 bits, their product 30, b_right <= 31; or factor = 0, in
//     which case a word of a that is not shifted may also be -2^31;
//   split_product: factor fits 16 bits, b 31 + sign, 17 <= b_right <= 47, no `odd` is set;
//   fits: the sum fits the word;
//   square: the sums of out² in one lane's accumulator fit 63 bits (Passes::lanes).
struct Terms {
  std::int32_t* out = nullptr;  // may be a or b
  const std::int32_t* a = nullptr;
  const std::int32_t* b = nullptr;
  std::size_t size = 0;  // a multiple of 16
  std::uint32_t a_left = 0;
  RightShift a_right = {};
  std::int32_t factor = 0;
  RightShift b_right = {};
  int bits = 32;              // width of the word
  bool wraps = false;         // a value beyond its word is wrapped, not clamped
  bool nearest_even = false;  // some `odd` is set
  bool short_product = false;
  bool split_product = false;
  bool fits = false;
  bool square = false;  // Σ out² is wanted
};

// The figures of the vector that a pass wrote.
struct Found {
  std::uint64_t largest = 0;   // magnitude
  std::int64_t overflows = 0;  // words that did not fit
  Int128 dot = 0;
};

// out = factor · in >> shift, entry by entry; factor >= 0, the results fit 31 bits, the sums of
// in · out in one lane's accumulator 63. Finds the largest result and Σ in · out.
struct Products {
  std::int32_t* out = nullptr;
  const std::int32_t* in = nullptr;
  const std::int32_t* factor = nullptr;
  std::size_t size = 0;
  RightShift shift = {};  // right <= 60
};

struct FoundBoth {
  Found first, second;
};

struct Passes {
  // The least number of accumulators of an inner product, each of which sums every lanes-th
  // product.
  std::size_t lanes = 1;
  Found (*combine)(const Terms& terms) = nullptr;
  // Two combinations at once that share b, which may be second.out. Both have short_product and
  // fits, but not square; first.a is not shifted.
  FoundBoth (*combine_both)(const Terms& first, const Terms& second) = nullptr;
  Found (*multiply_entries)(const Products& products) = nullptr;
  // Forms Σ a · b and finds the largest magnitude of b. The sums in one lane's accumulator fit 63
  // bits.
  Found (*inner_product)(const std::int32_t* a, const std::int32_t* b, std::size_t size) = nullptr;
  // Puts every node's (x, y, z), which fit 16 bits, into four words; `size` counts the words of
  // `in`.
  void (*to_short)(const std::int32_t* in, std::int16_t* out, std::size_t size) = nullptr;
  // `out` has 24 words for each slice, the three rows of a node together. No sum exceeds 32 bits.
  // Finds the largest of out and, where the sums in one lane's accumulator fit 63 bits, Σ vector ·
  // out.
  Found (*multiply_paired)(const PairedSlices& a, const std::int16_t* vector,
                           std::int32_t* out) = nullptr;
  void (*multiply_wide)(const WideSlices& a, const std::int32_t* vector,
                        std::int64_t* out) = nullptr;
};

const Passes& portable_passes();
const Passes& avx2_passes();
const Passes& avx512_passes();

}  // namespace hvp::fixed::fast
