#include "vp/fpga/engine/spmxv_block.h"

#include <algorithm>

#include "models/index.h"

namespace hvp::vp::engine {

SpmxvBlock::SpmxvBlock(const sc_core::sc_module_name& name, const accel::Architecture& architecture)
    : sc_module(name),
      architecture_(architecture),
      queue_(at(architecture.result_queue)),
      ranks_(architecture.memory_read_clocks + architecture.multiplier_clocks +
             architecture.adder_tree_clocks),
      flight_(ranks_.size()),
      products_(3 * at(architecture.package) * ranks_.size()) {}

void SpmxvBlock::load(const Layout& layout, int partition) {
  partition_ = &layout.partitions()[at(partition)];
  nodes_in_package_ = layout.nodes_in_package();
  nonzeros_.assign(3 * at(architecture_.package * partition_->packages()), 0);
  direction_.assign(3 * at(layout.nodes()), 0);
  reset();
}

void SpmxvBlock::reset() {
  for (InFlight& flight : flight_) flight.package = -1;
  busy_ = false;
  position_ = 0;
  served_ = 0;
  row_ = {};
  issued_rows_ = 0;
  finished_rows_ = 0;
  finished.reset();
  // A product that was to start at the next edge is not wanted any more.
  started_ = start->next();
}

std::span<std::int32_t> SpmxvBlock::package_words(int package) {
  const std::size_t words = 3 * at(architecture_.package);
  return std::span(nonzeros_).subspan(words * at(package), words);
}

std::span<const std::int32_t> SpmxvBlock::package_words(int package) const {
  const std::size_t words = 3 * at(architecture_.package);
  return std::span(nonzeros_).subspan(words * at(package), words);
}

void SpmxvBlock::clocked() {
  write_direction();
  if (start->read() != started_) {
    started_ = start->read();
    busy_ = partition_->packages() > 0;
    position_ = 0;
  }
  ranks_.advance();
  flight_[ranks_.entering()].package = issue();
  const int read = architecture_.memory_read_clocks;
  const int multiplied = read + architecture_.multiplier_clocks;
  multiply(ranks_.slot(read));
  add(ranks_.slot(multiplied));
  accumulate(flight_[ranks_.slot(multiplied + architecture_.adder_tree_clocks - 1)]);
}

// The copy's other port: nodes that the vector unit has written at the edge before.
void SpmxvBlock::write_direction() {
  const DirectionWrite& write = direction_write->read();
  if (write.number == written_) return;
  written_ = write.number;
  std::copy_n(write.words, 3 * write.count, direction_.begin() + 3 * write.first);
}

// The package that enters the pipelines at this edge, or -1.
int SpmxvBlock::issue() {
  if (!busy_) return -1;
  const auto package = at(position_);
  if (served_ + 1 < partition_->clocks[package]) {
    ++served_;
    ++bank_stalls_;
    return -1;
  }
  const bool last = partition_->last[package] != 0;
  if (last && issued_rows_ - taken->read() >= queue_.size()) {
    ++queue_stalls_;
    return -1;
  }
  if (last) ++issued_rows_;
  served_ = 0;
  const int issued = position_;
  if (++position_ == partition_->packages()) {
    position_ = 0;
    busy_ = false;
  }
  return issued;
}

// The operands are there: PL1 rows times PL2 columns.
void SpmxvBlock::multiply(std::size_t slot) {
  InFlight& flight = flight_[slot];
  if (flight.package < 0) return;
  const auto package = at(flight.package);
  const auto width = at(architecture_.package);
  const int* node = &partition_->node[package * at(nodes_in_package_)];
  const std::int32_t* a = &nonzeros_[3 * width * package];
  std::int64_t* product = &products_[3 * width * slot];
  flight.caught = {};
  std::size_t component = partition_->phase[package];
  for (std::size_t c = 0; c < width; ++c) {
    const std::int32_t d = direction_[3 * at(*node) + component];
    for (std::size_t r = 0; r < 3; ++r) {
      product[r * width + c] = std::int64_t{a[r * width + c]} * d;
    }
    if (*node == partition_->owner[package] && c < partition_->columns[package]) {
      flight.own[component] = d;
      flight.caught[component] = true;
    }
    if (++component == 3) {
      component = 0;
      ++node;
    }
  }
}

void SpmxvBlock::add(std::size_t slot) {
  InFlight& flight = flight_[slot];
  if (flight.package < 0) return;
  const auto width = at(architecture_.package);
  const std::int64_t* product = &products_[3 * width * slot];
  for (std::size_t r = 0; r < 3; ++r) {
    std::int64_t sum = 0;
    for (std::size_t c = 0; c < width; ++c) sum += product[r * width + c];
    flight.sum[r] = sum;
  }
}

void SpmxvBlock::accumulate(const InFlight& flight) {
  if (flight.package < 0) return;
  const auto package = at(flight.package);
  for (std::size_t r = 0; r < 3; ++r) {
    row_.sum[r] += flight.sum[r];
    if (flight.caught[r]) row_.own[r] = flight.own[r];
  }
  if (partition_->last[package] == 0) return;
  row_.node = partition_->owner[package];
  queue_[finished_rows_ % queue_.size()] = row_;
  finished.write(++finished_rows_);
  row_ = {};
}

}  // namespace hvp::vp::engine
