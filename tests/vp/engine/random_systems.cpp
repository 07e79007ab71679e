#include "tests/vp/engine/random_systems.h"

#include <array>
#include <map>
#include <utility>

#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::test {

fixed::QuantisedMatrix random_matrix(int nodes, int neighbours, int bits,
                                     fixed::test::Random& random, int alone) {
  const auto limit = static_cast<std::int32_t>(fixed::word_limit(bits));
  std::map<std::pair<int, int>, std::array<std::int32_t, 9>> blocks;
  for (int node = 0; node < nodes; ++node) {
    auto& diagonal = blocks[{node, node}];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < r; ++c) {
        diagonal[3 * r + c] = static_cast<std::int32_t>(random.symmetric() * limit / 8);
        diagonal[3 * c + r] = diagonal[3 * r + c];
      }
      diagonal[4 * r] = limit / 2 + random.below(limit / 2);
    }
  }
  const int pairs = nodes * neighbours / 2;
  for (int i = 0; i < pairs; ++i) {
    const int a = random.below(nodes);
    const int b = random.below(nodes);
    if (a == b || (alone != 0 && (a % alone == 0 || b % alone == 0))) continue;
    auto& block = blocks[{a, b}];
    for (std::int32_t& word : block) {
      word = static_cast<std::int32_t>(random.symmetric() * limit / (4 * neighbours));
    }
    auto& other = blocks[{b, a}];
    for (std::size_t e = 0; e < 9; ++e) other[3 * (e % 3) + e / 3] = block[e];
  }
  fixed::QuantisedMatrix matrix;
  matrix.bits = bits;
  matrix.scale = 1;
  matrix.is_contact.assign(at(nodes), 0);
  matrix.row_begin.assign(at(nodes) + 1, 0);
  for (const auto& [place, words] : blocks) {
    matrix.column.push_back(place.second);
    matrix.value.insert(matrix.value.end(), words.begin(), words.end());
    ++matrix.row_begin[at(place.first) + 1];
  }
  for (int node = 0; node < nodes; ++node) {
    matrix.row_begin[at(node) + 1] += matrix.row_begin[at(node)];
  }
  return matrix;
}

}  // namespace hvp::test
