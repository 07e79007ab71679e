#include "vp/fpga/engine/carried_words.h"

#include <algorithm>

#include "models/index.h"

namespace hvp::vp::engine {

CarriedWords::CarriedWords(const accel::Architecture& architecture, const Layout& layout,
                           const Partition& partition, const std::array<std::int32_t, 3>& own)
    : read_rank_(architecture.memory_read_clocks - 1),
      sum_rank_(architecture.memory_read_clocks + architecture.multiplier_clocks +
                architecture.adder_tree_clocks - 1),
      columns_(architecture.package),
      lanes_(architecture.nodes_per_clock),
      ranks_(sum_rank_),
      package_(ranks_.size()),
      own_(own) {
  const std::size_t nodes = at(layout.nodes_in_package());
  for (std::size_t k = 0; k < at(partition.packages()); ++k) {
    const auto first = partition.node.begin() + static_cast<std::ptrdiff_t>(k * nodes);
    index_.push_back({{first, first + static_cast<std::ptrdiff_t>(nodes)},
                      partition.owner[k],
                      partition.phase[k],
                      partition.last[k] != 0});
  }
  for (Package& package : package_) package.read = package.index.node = std::vector<int>(nodes);
}

void CarriedWords::enter(int package, int addressed) {
  Package& entering = package_[ranks_.entering()];
  entering.valid = true;
  entering.number = package;
  entering.index = index(package);
  entering.read = entering.index.node;
  if (addressed < 0) return;
  const std::size_t lanes = std::min(at(lanes_), entering.read.size());
  for (std::size_t i = 0; i < lanes; ++i) entering.read[i] = addressed + static_cast<int>(i);
}

// Column c is component (phase + c) mod 3 of node (phase + c) / 3, and zero beyond the last node; a
// phase of three, which only a flip makes, is multiplied as one of two is.
void CarriedWords::read(std::span<const std::int32_t> nonzeros, const DirectionCopies& vector,
                        int copy) {
  Package& package = package_[ranks_.slot(read_rank_)];
  if (!package.valid) return;
  const auto nodes = static_cast<int>(package.index.node.size());
  const int phase = package.index.phase;
  const auto word = [&](int place) {
    return place < 3 * nodes ? vector.word(copy, package.read[at(place / 3)], place % 3) : 0;
  };
  package.sum = {};
  const std::size_t first = 3 * at(columns_) * at(package.number);
  for (int c = 0; c < columns_; ++c) {
    const std::int64_t d = word(std::min(phase, 2) + c);
    for (std::size_t r = 0; r < 3; ++r) {
      package.sum[r] += nonzeros[first + r * at(columns_) + at(c)] * d;
    }
  }
  package.caught = {};
  for (int place = phase; place < std::min(phase + columns_, 3 * nodes); ++place) {
    if (package.index.node[at(place / 3)] != package.index.owner) continue;
    package.caught[at(place % 3)] = true;
    package.own[at(place % 3)] = word(place);
  }
}

bool CarriedWords::accumulate() {
  const Package& package = package_[ranks_.slot(sum_rank_)];
  if (!package.valid) return false;
  for (std::size_t r = 0; r < 3; ++r) {
    sum_[r] += package.sum[r];
    if (package.caught[r]) own_[r] = package.own[r];
  }
  if (!package.index.last) return false;
  row_ = {package.index.owner, sum_, own_};
  sum_ = {};
  return true;
}

void CarriedWords::reset() {
  sum_ = {};
  for (Package& package : package_) package.valid = false;
}

}  // namespace hvp::vp::engine
