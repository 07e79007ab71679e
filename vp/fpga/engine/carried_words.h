#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"
#include "vp/fpga/engine/direction_copies.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/layout.h"

namespace hvp::vp::engine {

// A package's index word.
struct IndexWord {
  std::vector<int> node;  // its block columns, those of padding too
  int owner = 0;
  int phase = 0;
  bool last = false;
};

// A partition's ranks with the words in them, for memories whose bits flip amid a product: what a
// package has read before stays as it was. Words and clocks are those of spmxv_partition.sv, and
// without flips those of RowSums.
class CarriedWords {
 public:
  // `own` are the words that were caught last, where a row passes without its own node.
  CarriedWords(const accel::Architecture& architecture, const Layout& layout,
               const Partition& partition, const std::array<std::int32_t, 3>& own);

  IndexWord& index(int package) { return index_[static_cast<std::size_t>(package)]; }

  // Begins an edge.
  void advance() {
    ranks_.advance();
    package_[ranks_.entering()].valid = false;
  }
  // A package has a turn, and enters with its last one. Behind a product's end the copy of d gives
  // it the `addressed` nodes of a pass, from the first of them on; −1: the product runs.
  void enter(int package, int turn, bool last_turn, int addressed);
  // The words of the turn that has come to its memories' rank.
  void read(std::span<const std::int32_t> nonzeros, const DirectionCopies& vector, int partition);
  // The package behind the adder trees is accumulated; true if it has ended a row.
  bool accumulate();
  // That row.
  struct Row {
    int node = 0;
    std::array<std::int64_t, 3> sum{};
    std::array<std::int32_t, 3> own{};
  };
  const Row& row() const { return row_; }
  // The words that were caught last.
  const std::array<std::int32_t, 3>& own() const { return own_; }
  // Empties the ranks.
  void reset();

 private:
  struct Package {
    bool valid = false;
    int number = 0;
    int turn = 0;
    bool last_turn = false;
    IndexWord index;
    std::vector<int> read;             // the nodes that are read of d
    std::array<bool, 3> multiplied{};  // its rows
    std::array<std::int64_t, 3> sum{};
    std::array<bool, 3> caught{};  // the components of the row's own node that are in it
    std::array<std::int32_t, 3> own{};
  };

  // How a package's word of d is read, by node and component.
  struct Read {
    int turn = 0;
    int copy = 0;
  };
  std::vector<Read> reads_of(const IndexWord& index) const;

  accel::Architecture architecture_;
  bool rows_take_turns_;            // with d read anew for each
  std::vector<Read> reads_;         // of all packages
  std::vector<std::int32_t> kept_;  // of the package that is served: the words of its turns
  int read_rank_;
  int sum_rank_;
  int columns_;  // of a package
  int lanes_;    // nodes that a pass reads
  std::vector<IndexWord> index_;
  Ranks ranks_;
  std::vector<Package> package_;  // by rank
  std::array<std::int64_t, 3> sum_{};
  std::array<std::int32_t, 3> own_{};
  Row row_;
};

}  // namespace hvp::vp::engine
