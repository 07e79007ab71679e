#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hvp::vp::engine {

// What of an engine has bits that can flip.
enum class FlipPlace {
  x,  // the vectors' memories; `previous` is x before the last job, for an extrapolated start
  r,
  z,  // with a preconditioner
  b,
  q,
  previous,
  inverse,      // P⁻¹: a word of its diagonal
  d,            // a partition's copy
  matrix,       // non-zeros
  nodes,        // of the index words: the block columns of a package,
  owner,        // the row that it belongs to,
  phase,        // the component of its first column,
  last,         // and whether it ends that row
  coefficient,  // a register: α or β, as the lanes multiply by it
  r_r,          // a register: rᵀr, or with a preconditioner zᵀr
  loops,        // a register: the iterations begun
  r_exponent,   // registers: r in words is r · 2^r_exponent,
  d_exponent,   // and d likewise
};
inline constexpr std::size_t kFlipPlaces = static_cast<std::size_t>(FlipPlace::d_exponent) + 1;

constexpr const char* name(FlipPlace place) {
  constexpr std::array<const char*, kFlipPlaces> kNames = {
      "x",       "r",           "z",      "b",     "q",          "previous",
      "inverse", "d",           "matrix", "nodes", "owner",      "phase",
      "last",    "coefficient", "r_r",    "loops", "r_exponent", "d_exponent"};
  return kNames[static_cast<std::size_t>(place)];
}

// The bits of the counter of iterations.
inline constexpr int kLoopBits = 16;
// The bits of an exponent that flip: those above them do the same.
inline constexpr int kExponentBits = 16;

// A bit of a memory or a register that changes, as by a particle, amid two edges of the clock. What
// a place does not have is not looked at; −1: not stated.
struct Flip {
  FlipPlace place = FlipPlace::x;
  int partition = -1;  // d, matrix, the index words
  int copy = -1;       // d: of those that the partition has
  int node = -1;       // vectors, d
  int component = -1;  // 0 to 2
  int package = -1;    // matrix, index words: its number in the partition
  int row = -1;        // matrix: of the package's three
  int column = -1;     // matrix: of the package's; nodes: which of the package's nodes
  int bit = -1;        // from the lowest one of the word or field

  bool operator==(const Flip&) const = default;
};

// The members of a flip in the order in which they are chosen, with their keys.
struct FlipIndex {
  const char* key;
  int Flip::*index;
};
inline constexpr std::array<FlipIndex, 8> kFlipIndices = {{{"partition", &Flip::partition},
                                                           {"copy", &Flip::copy},
                                                           {"node", &Flip::node},
                                                           {"component", &Flip::component},
                                                           {"package", &Flip::package},
                                                           {"row", &Flip::row},
                                                           {"column", &Flip::column},
                                                           {"bit", &Flip::bit}}};

// Whether a place has such an index.
constexpr bool has_index(FlipPlace place, int Flip::*index) {
  const bool vector = place <= FlipPlace::d;
  const bool package = place >= FlipPlace::matrix && place <= FlipPlace::last;
  if (index == &Flip::partition) return package || place == FlipPlace::d;
  if (index == &Flip::copy) return place == FlipPlace::d;
  if (index == &Flip::node || index == &Flip::component) return vector;
  if (index == &Flip::package) return package;
  if (index == &Flip::row) return place == FlipPlace::matrix;
  if (index == &Flip::column) return place == FlipPlace::matrix || place == FlipPlace::nodes;
  return true;
}

// The rank of a node whose z is written, where the lanes have one: that of the words before, if it
// has more.
inline constexpr int kPreconditionedRank = 19;
// The clocks of a pass up to which z follows r there.
inline constexpr int kLongestPass = 24;
// The rank at which the words of P⁻¹ have been read.
inline constexpr int kInverseRank = 11;

// A word of so many bits in two's complement with this bit changed.
constexpr std::int64_t flipped(std::int64_t word, int bit, int bits) {
  const auto changed = static_cast<std::uint64_t>(word) ^ (std::uint64_t{1} << bit);
  return static_cast<std::int64_t>(changed << (64 - bits)) >> (64 - bits);
}

}  // namespace hvp::vp::engine
