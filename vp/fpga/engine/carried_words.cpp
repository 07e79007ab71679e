#include "vp/fpga/engine/carried_words.h"

#include <algorithm>
#include <iterator>

#include "models/index.h"

namespace hvp::vp::engine {

CarriedWords::CarriedWords(const accel::Architecture& architecture, const Layout& layout,
                           const Partition& partition, const std::array<std::int32_t, 3>& own)
    : architecture_(architecture),
      rows_take_turns_(architecture.rows_in_parallel < 3),
      kept_(3 * at(layout.nodes_in_package())),
      read_rank_(architecture.memory_read_clocks - 1),
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
    std::ranges::copy(reads_of(index_.back()), std::back_inserter(reads_));
  }
  for (Package& package : package_) package.read = package.index.node = std::vector<int>(nodes);
}

// A bank of d has the package's nodes in their order, as many in a turn as it has accesses; a node
// that padding repeats is read with the one before (bank_reads.sv). One bank that serves all of
// them at once gives each a port of its own.
std::vector<CarriedWords::Read> CarriedWords::reads_of(const IndexWord& index) const {
  const auto nodes = static_cast<int>(index.node.size());
  const int accesses = architecture_.direction_accesses();
  const int banks = architecture_.direction_banks;
  const bool direct = banks == 1 && nodes <= accesses;
  std::vector<Read> reads(3 * index.node.size());
  for (int k = 0; k < 3; ++k) {
    std::vector<int> of_bank(at(banks));
    int before = -1;  // the number of the node before, if it is read
    for (int n = 0; n < nodes; ++n) {
      const int column = 3 * n + k - index.phase;
      const bool reads_it = column >= 0 && column < columns_;
      int number = 0;
      if (before >= 0 && index.node[at(n)] == index.node[at(n - 1)]) {
        number = before;
      } else {
        int& count = of_bank[at(index.node[at(n)] % banks)];
        number = count;
        if (reads_it) ++count;
      }
      before = reads_it ? number : -1;
      if (direct) number = n;
      reads[at(3 * n + k)] = {direct ? 0 : number / accesses,
                              architecture_.direction_memory == accel::DirectionMemory::two_copies
                                  ? number % accesses / 2
                                  : 0};
    }
  }
  return reads;
}

void CarriedWords::enter(int package, int turn, bool last_turn, int addressed) {
  Package& entering = package_[ranks_.entering()];
  entering.valid = true;
  entering.number = package;
  entering.turn = turn;
  entering.last_turn = last_turn;
  for (int r = 0; r < 3; ++r) {
    entering.multiplied[at(r)] =
        rows_take_turns_ ? r / architecture_.rows_in_parallel == turn : last_turn;
  }
  entering.index = index(package);
  entering.read = entering.index.node;
  if (addressed < 0) return;
  const std::size_t lanes = std::min(at(lanes_), entering.read.size());
  for (std::size_t i = 0; i < lanes; ++i) entering.read[i] = addressed + static_cast<int>(i);
}

// Column c is component (phase + c) mod 3 of node (phase + c) / 3, and zero beyond the last node; a
// phase of three, which only a flip makes, is multiplied as one of two is.
void CarriedWords::read(std::span<const std::int32_t> nonzeros, const DirectionCopies& vector,
                        int partition) {
  Package& package = package_[ranks_.slot(read_rank_)];
  if (!package.valid) return;
  const auto nodes = static_cast<int>(package.index.node.size());
  const int phase = package.index.phase;
  const Read* const reads = &reads_[3 * at(nodes) * at(package.number)];
  for (int place = 0; place < 3 * nodes; ++place) {
    const Read& how = reads[place];
    if (!rows_take_turns_ && how.turn != package.turn) continue;
    kept_[at(place)] =
        vector.word(vector.copy(partition, how.copy), package.read[at(place / 3)], place % 3);
  }
  const auto word = [&](int place) { return place < 3 * nodes ? kept_[at(place)] : 0; };
  package.sum = {};
  const std::size_t first = 3 * at(columns_) * at(package.number);
  for (int c = 0; c < columns_; ++c) {
    const std::int64_t d = word(std::min(phase, 2) + c);
    for (std::size_t r = 0; r < 3; ++r) {
      if (!package.multiplied[r]) continue;
      package.sum[r] += nonzeros[first + r * at(columns_) + at(c)] * d;
    }
  }
  package.caught = {};
  if (!rows_take_turns_ && !package.last_turn) return;
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
  if (!package.index.last || !package.last_turn) return false;
  row_ = {package.index.owner, sum_, own_};
  sum_ = {};
  return true;
}

void CarriedWords::reset() {
  sum_ = {};
  for (Package& package : package_) package.valid = false;
}

}  // namespace hvp::vp::engine
