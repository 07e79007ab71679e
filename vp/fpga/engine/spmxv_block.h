#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "vp/fpga/engine/carried_words.h"
#include "vp/fpga/engine/direction_copies.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/row_sums.h"

namespace hvp::vp::engine {

// The result of a block row whose last package has passed the adder trees, as exact sums and not
// yet words.
struct RowResult {
  int node = 0;
  std::array<std::int64_t, 3> sum{};
  // The words of the multiplied vector at the row's own node, which are kept as they pass: the
  // inner product with the result needs no further port.
  std::array<std::int32_t, 3> own{};
};

// The SpMxV sub-block of thesis Fig. 5.5, one for each partition: non-zero memory and index memory,
// its own copy of the multiplied vector, PL1 × PL2 multipliers, adder trees and accumulators, and a
// memory for finished rows.
//
// A package enters the pipelines when the banks of d have served it (Partition::clocks edges) and,
// if it ends a row, when the result memory has room for that row. Its row is in the result memory
// memory_read + multiplier + adder_tree edges later. The index memory is read ahead, because it
// does not depend on any vector.
//
// Only the rows' last packages are followed through the pipelines. The words that the others carry
// are made when the row is done (RowSums), which does not show: they stay in the memories.
class SpmxvBlock : public sc_core::sc_module {
 public:
  SpmxvBlock(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
             DirectionCopies& direction);

  // From the sequencer; every change starts a product.
  const Register<std::uint32_t>* start = nullptr;
  // From the vector unit: the number of results taken so far, and the nodes that it writes into the
  // copies of d.
  const Register<std::uint32_t>* taken = nullptr;
  const Register<DirectionWrite>* direction_write = nullptr;
  // To the vector unit: the number of results in the result memory so far.
  Register<std::uint32_t> finished;

  // A host access, while idle. `layout` has to stay in place.
  void load(const Layout& layout, int partition);
  // From now on the ranks carry their words, since bits of the memories may flip. To be called
  // while no product runs.
  void carry_words();
  bool carries_words() const { return carried_ != nullptr; }
  // The index memory, where words are carried.
  IndexWord& index_word(int package) { return carried_->index(package); }
  // Where words are carried, to be called at each edge before clocked(): the node of d that a pass
  // has addressed, or −1 while a product runs.
  void address(int node) { addressed_ = node; }
  void clocked();
  // Empties pipelines and result memory.
  void reset();
  // The words of a package, three rows of PL2, to be written or read.
  std::span<std::int32_t> package_words(int package);
  std::span<const std::int32_t> package_words(int package) const;

  const Partition& partition() const { return *partition_; }
  // The second half of a dual-port memory: the vector unit's port on this copy of d.
  const std::int32_t* direction(int node) const {
    return &direction()[3 * static_cast<std::size_t>(node)];
  }
  const std::vector<std::int32_t>& direction() const { return direction_.words(); }
  // Of one of its copies.
  std::int32_t direction_word(int node, int component, int copy = 0) const {
    return direction_.word(direction_.copy(number_, copy), node, component);
  }
  const RowResult& result(std::uint32_t number) const { return queue_[number % queue_.size()]; }
  // The places of the result memory, which the rows take in turn from 0 on.
  const RowResult& result_in(std::size_t place) const { return queue_[place]; }
  std::size_t next_place(std::size_t place) const {
    return place + 1 == queue_.size() ? 0 : place + 1;
  }

  // For traces and statistics.
  int position() const { return position_; }
  bool busy() const { return busy_; }
  std::int64_t bank_stalls() const { return bank_stalls_; }
  std::int64_t queue_stalls() const { return queue_stalls_; }

 private:
  void begin_product();
  void issue();
  void finish_row();
  void clock_carried();
  void issue_carried();

  const accel::Architecture& architecture_;
  const Layout* layout_ = nullptr;
  const Partition* partition_ = nullptr;
  int number_ = 0;  // the partition's
  DirectionCopies& direction_;

  std::vector<std::int32_t> nonzeros_;  // package by package, three rows of PL2
  std::vector<RowResult> queue_;        // the result memory
  RowSums sums_;
  std::unique_ptr<CarriedWords> carried_;
  int addressed_ = -1;
  std::array<std::int32_t, 3> caught_{};  // the words of the last finished row's own node

  // A row whose last package is in the pipelines; it has a place in the result memory.
  struct InFlight {
    int row = 0;            // its index in the partition
    std::int64_t done = 0;  // the edge at which it has passed them
  };
  std::vector<InFlight> flight_;  // by the row's place in the result memory
  std::size_t issued_place_ = 0;
  std::size_t finished_place_ = 0;
  std::int64_t edge_ = 0;
  std::int64_t next_done_ = -1;  // of the next row; −1: none is in the pipelines

  bool busy_ = false;
  int row_ = 0;       // the row that is served
  int position_ = 0;  // the package that is served
  int served_ = 0;    // edges that the banks have spent on it
  std::uint32_t started_ = 0;
  std::uint32_t issued_rows_ = 0;
  std::uint32_t finished_rows_ = 0;
  std::int64_t bank_stalls_ = 0;
  std::int64_t queue_stalls_ = 0;
};

}  // namespace hvp::vp::engine
