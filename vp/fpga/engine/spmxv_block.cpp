#include "vp/fpga/engine/spmxv_block.h"

#include <algorithm>

#include "models/index.h"

namespace hvp::vp::engine {

SpmxvBlock::SpmxvBlock(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
                       DirectionCopies& direction)
    : sc_module(name),
      architecture_(architecture),
      direction_(direction),
      queue_(at(architecture.result_queue)),
      flight_(queue_.size()) {}

void SpmxvBlock::load(const Layout& layout, int partition) {
  layout_ = &layout;
  number_ = partition;
  partition_ = &layout.partitions()[at(partition)];
  nonzeros_.assign(3 * at(architecture_.package * partition_->packages()), 0);
  sums_.load(layout, *partition_);
  reset();
  if (carries_words()) carry_words();
}

void SpmxvBlock::carry_words() {
  if (carries_words()) caught_ = carried_->own();
  carried_ = std::make_unique<CarriedWords>(architecture_, *layout_, *partition_, caught_);
}

void SpmxvBlock::reset() {
  busy_ = false;
  position_ = 0;
  served_ = 0;
  row_ = 0;
  issued_rows_ = 0;
  finished_rows_ = 0;
  issued_place_ = 0;
  finished_place_ = 0;
  next_done_ = -1;
  finished.reset();
  // A product that was to start at the next edge is not wanted any more.
  started_ = start->next();
  if (carries_words()) carried_->reset();
}

std::span<std::int32_t> SpmxvBlock::package_words(int package) {
  sums_.matrix_written();
  const std::size_t words = 3 * at(architecture_.package);
  return std::span(nonzeros_).subspan(words * at(package), words);
}

std::span<const std::int32_t> SpmxvBlock::package_words(int package) const {
  const std::size_t words = 3 * at(architecture_.package);
  return std::span(nonzeros_).subspan(words * at(package), words);
}

void SpmxvBlock::clocked() {
  if (carries_words()) {
    clock_carried();
    return;
  }
  ++edge_;
  if (start->read() != started_) begin_product();
  if (busy_) issue();
  if (edge_ == next_done_) finish_row();
}

void SpmxvBlock::begin_product() {
  started_ = start->read();
  busy_ = partition_->packages() > 0;
  position_ = 0;
  row_ = 0;
  sums_.begin(nonzeros_, direction_);
}

// The package that is served enters the pipelines, if the banks and the result memory let it.
void SpmxvBlock::issue() {
  const auto package = at(position_);
  if (served_ + 1 < partition_->clocks[package]) {
    ++served_;
    ++bank_stalls_;
    return;
  }
  if (partition_->last[package] != 0) {
    if (issued_rows_ - taken->read() >= queue_.size()) {
      ++queue_stalls_;
      return;
    }
    const InFlight flight{row_++, edge_ + architecture_.memory_read_clocks +
                                      architecture_.multiplier_clocks +
                                      architecture_.adder_tree_clocks - 1};
    flight_[issued_place_] = flight;
    issued_place_ = next_place(issued_place_);
    if (issued_rows_++ == finished_rows_) next_done_ = flight.done;
  }
  served_ = 0;
  if (++position_ == partition_->packages()) {
    position_ = 0;
    row_ = 0;
    busy_ = false;
  }
}

void SpmxvBlock::clock_carried() {
  if (start->read() != started_) {
    started_ = start->read();
    busy_ = busy_ || partition_->packages() > 0;
  }
  carried_->advance();
  if (carried_->accumulate()) {
    const CarriedWords::Row& row = carried_->row();
    queue_[finished_place_] = {row.node, row.sum, row.own};
    finished_place_ = next_place(finished_place_);
    finished.write(++finished_rows_);
  }
  if (busy_) issue_carried();
  carried_->read(nonzeros_, direction_, number_);
}

// As issue(), by the index word as it is now.
void SpmxvBlock::issue_carried() {
  if (served_ + 1 < partition_->clocks[at(position_)]) {
    carried_->enter(position_, served_++, false, addressed_);
    ++bank_stalls_;
    return;
  }
  if (carried_->index(position_).last) {
    if (issued_rows_ - taken->read() >= queue_.size()) {
      ++queue_stalls_;
      return;
    }
    ++issued_rows_;
  }
  carried_->enter(position_, served_, true, addressed_);
  served_ = 0;
  if (++position_ == partition_->packages()) {
    position_ = 0;
    busy_ = false;
  }
}

void SpmxvBlock::finish_row() {
  const int row = flight_[finished_place_].row;
  RowResult& result = queue_[finished_place_];
  result.node = partition_->row[at(row)];
  result.sum = sums_.sum(row);
  result.own = {};
  if (sums_.has_own_block(row)) {
    std::copy_n(direction(result.node), 3, result.own.begin());
  }
  caught_ = result.own;
  finished.write(++finished_rows_);
  finished_place_ = next_place(finished_place_);
  next_done_ = finished_rows_ == issued_rows_ ? -1 : flight_[finished_place_].done;
}

}  // namespace hvp::vp::engine
