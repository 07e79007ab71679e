#include "vp/fpga/engine/vector_unit.h"

#include <algorithm>

#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::vp::engine {

namespace {

void track(std::uint64_t& largest, std::int64_t value) {
  largest = std::max(largest, fixed::magnitude(value));
}

std::array<std::int32_t, 3> words(const std::vector<std::int32_t>& memory, int node) {
  const std::size_t first = 3 * at(node);
  return {memory[first], memory[first + 1], memory[first + 2]};
}

}  // namespace

VectorUnit::VectorUnit(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
                       std::vector<std::unique_ptr<SpmxvBlock>>& blocks)
    : sc_module(name),
      architecture_(architecture),
      blocks_(blocks),
      ranks_(architecture.phase_clocks()),
      group_(ranks_.size()),
      lane_(ranks_.size() * at(architecture.nodes_per_clock)),
      back_ranks_(architecture.vector_clocks()),
      back_count_(back_ranks_.size()),
      back_row_(back_ranks_.size() * at(architecture.nodes_per_clock)),
      taken_(blocks.size()),
      bank_written_(at(architecture.nodes_per_clock)),
      direction_words_(2 * 3 * at(architecture.nodes_per_clock)) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    taken.push_back(std::make_unique<Register<std::uint32_t>>());
  }
}

void VectorUnit::load(int nodes) {
  nodes_ = nodes;
  for (auto* memory : {&memories_.x, &memories_.previous, &memories_.b, &memories_.r, &memories_.z,
                       &memories_.q}) {
    memory->assign(3 * at(nodes), 0);
  }
  memories_.inverse.assign(9 * at(nodes), 0);
  reset();
}

void VectorUnit::reset() {
  running_ = false;
  writes_left_ = 0;
  first_block_ = 0;
  for (Group& group : group_) group.count = 0;
  for (int& count : back_count_) count = 0;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    taken_[i] = 0;
    taken[i]->reset();
  }
}

void VectorUnit::configure(const fixed::Settings& settings, int inverse_shift) {
  settings_ = settings;
  inverse_shift_ = inverse_shift;
}

void VectorUnit::clocked() {
  if (command->read().number != now_.number) begin_pass();
  if (!running_) return;
  if (now_.pass == Pass::product) {
    collect();
  } else {
    move_lanes();
  }
  if (done_nodes_ == nodes_) finish_pass();
}

// A pass may take the place of one that is not over: the copy of an x that has changed since.
void VectorUnit::begin_pass() {
  now_ = command->read();
  sums_ = {};
  sums_.number = now_.number;
  running_ = now_.pass != Pass::none;
  next_node_ = 0;
  done_nodes_ = 0;
  reads_left_ = 0;
  writes_left_ = 0;
  for (Group& group : group_) group.count = 0;
}

void VectorUnit::finish_pass() {
  status.write(sums_);
  running_ = false;
}

bool VectorUnit::reads_direction() const {
  return now_.pass == Pass::update || now_.pass == Pass::direction ||
         (now_.pass == Pass::residual && now_.exchange);
}

bool VectorUnit::writes_direction() const {
  switch (now_.pass) {
    case Pass::copy:
    case Pass::guess:
    case Pass::first_direction:
    case Pass::direction:
      return true;
    default:
      return now_.exchange;
  }
}

// The number of accesses to the bank that this number of successive nodes asks most.
int VectorUnit::accesses(int nodes, int each) const {
  const int banks = architecture_.direction_banks;
  return each * ((nodes + banks - 1) / banks);
}

void VectorUnit::move_lanes() {
  int accesses_left = architecture_.direction_accesses();
  if (writes_left_ > 0) {
    const int used = std::min(accesses_left, writes_left_);
    writes_left_ -= used;
    accesses_left -= used;
    if (writes_left_ > 0) return;
  }
  const auto lanes = at(architecture_.nodes_per_clock);
  const int read_age = architecture_.memory_read_clocks;
  const int multiplied_age = read_age + architecture_.multiplier_clocks;
  const int written_age = multiplied_age + architecture_.vector_clocks() - 1;
  const int summed_age = architecture_.phase_clocks() - 1;

  ranks_.advance();
  const std::size_t written = ranks_.slot(written_age);
  if (group_[written].count > 0 && writes_direction()) {
    const int needed = accesses(group_[written].count, architecture_.direction_write_accesses());
    const int used = std::min(accesses_left, needed);
    writes_left_ = needed - used;
    accesses_left -= used;
  }
  enter_group(accesses_left);
  const std::size_t entered = ranks_.slot(read_age);
  read(group_[entered], &lane_[entered * lanes]);
  const std::size_t multiplied = ranks_.slot(multiplied_age);
  multiply(group_[multiplied], &lane_[multiplied * lanes]);
  align_and_write(group_[written], &lane_[written * lanes]);
  const std::size_t summed = ranks_.slot(summed_age);
  sum(group_[summed], &lane_[summed * lanes]);
}

// The next L nodes, if the ports of d serve them.
void VectorUnit::enter_group(int accesses_left) {
  Group& group = group_[ranks_.entering()];
  group.count = 0;
  if (next_node_ == nodes_) return;
  const int count = std::min(architecture_.nodes_per_clock, nodes_ - next_node_);
  if (reads_direction()) {
    const int needed = accesses(count, 1);
    if (reads_left_ == 0) reads_left_ = needed;
    // A group is read in one clock where that is possible at all.
    if (reads_left_ > accesses_left && needed <= architecture_.direction_accesses()) {
      return;
    }
    reads_left_ -= std::min(accesses_left, reads_left_);
    if (reads_left_ > 0) return;
  }
  group = {next_node_, count};
  next_node_ += count;
}

void VectorUnit::read(const Group& group, Lane* lanes) {
  for (int i = 0; i < group.count; ++i) {
    Lane& lane = lanes[i];
    const int node = group.first + i;
    lane.x = words(memories_.x, node);
    lane.previous = words(memories_.previous, node);
    lane.r = words(memories_.r, node);
    lane.q = words(memories_.q, node);
    lane.b = words(memories_.b, node);
    lane.z = words(settings_.preconditioned() ? memories_.z : memories_.r, node);
    if (reads_direction()) lane.d = words(blocks_.front()->direction(), node);
  }
}

void VectorUnit::multiply(const Group& group, Lane* lanes) const {
  for (int i = 0; i < group.count; ++i) {
    Lane& lane = lanes[i];
    for (std::size_t c = 0; c < 3; ++c) {
      lane.alpha_d[c] = std::int64_t{now_.alpha} * lane.d[c];
      lane.alpha_q[c] = std::int64_t{now_.alpha} * lane.q[c];
      lane.beta_d[c] = std::int64_t{now_.beta} * lane.d[c];
    }
  }
}

void VectorUnit::align_and_write(const Group& group, Lane* lanes) {
  if (group.count == 0 || now_.hold) return;
  written_node_ = group.first;
  // The blocks take the words at the next edge, at which others may be written already.
  const std::uint32_t number = direction_write.read().number + 1;
  std::int32_t* const words = &direction_words_[(number & 1U) * direction_words_.size() / 2];
  std::int32_t* direction = words;
  for (int i = 0; i < group.count; ++i, direction += 3) {
    const int node = group.first + i;
    switch (now_.pass) {
      case Pass::copy:
        write_copy(lanes[i], direction);
        break;
      case Pass::guess:
        write_guess(node, lanes[i], direction);
        break;
      case Pass::residual:
        write_residual(node, lanes[i], direction);
        break;
      case Pass::update:
        write_update(node, lanes[i], direction);
        break;
      case Pass::first_direction:
      case Pass::direction:
        write_direction_word(lanes[i], direction);
        break;
      case Pass::product:
      case Pass::none:
        break;
    }
  }
  if (writes_direction()) direction_write.write({group.first, group.count, number, words});
}

void VectorUnit::write_copy(const Lane& lane, std::int32_t* direction) const {
  std::ranges::copy(lane.x, direction);
}

// The guess of fixed::extrapolate.
void VectorUnit::write_guess(int node, const Lane& lane, std::int32_t* direction) {
  std::array<std::int32_t, 3> previous = now_.alone ? lane.x : lane.previous;
  std::array<std::int32_t, 3> x = lane.x;
  report_.saturations += fixed::extrapolate(x, previous, settings_.vector_bits);
  std::ranges::copy(x, memories_.x.begin() + 3 * node);
  std::ranges::copy(previous, memories_.previous.begin() + 3 * node);
  std::ranges::copy(x, direction);
}

void VectorUnit::write_residual(int node, Lane& lane, std::int32_t* direction) {
  fixed::ReferenceMachine& counted = now_.first ? machine_ : silent_;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int32_t b = counted.write(lane.b[c], settings_.residual_bits());
    const std::int64_t full = (std::int64_t{b} << settings_.rhs_shift()) -
                              (std::int64_t{lane.q[c]} << settings_.product_shift());
    lane.r[c] =
        machine_.write(machine_.rounded_shift(full, now_.r_shift), settings_.residual_bits());
    memories_.r[3 * at(node) + c] = lane.r[c];
    if (now_.zero) memories_.x[3 * at(node) + c] = 0;
    if (now_.exchange) {
      memories_.x[3 * at(node) + c] = lane.d[c];
      direction[c] = lane.x[c];
    }
  }
  precondition(node, lane);
}

// x += α·d, r −= α·q
void VectorUnit::write_update(int node, Lane& lane, std::int32_t* direction) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t word = 3 * at(node) + c;
    const std::int64_t change = machine_.rounded_shift(lane.alpha_d[c], now_.x_shift);
    const std::int32_t x = machine_.write(lane.x[c] + change, settings_.vector_bits);
    if (now_.exchange) {
      direction[c] = x;
      memories_.x[word] = lane.d[c];
      continue;
    }
    memories_.x[word] = x;
    const std::int64_t kept = machine_.rounded_shift(lane.r[c], now_.r_shift);
    lane.r[c] = machine_.write(kept - machine_.rounded_shift(lane.alpha_q[c], now_.change_shift),
                               settings_.residual_bits());
    memories_.r[word] = lane.r[c];
  }
  if (!now_.exchange) precondition(node, lane);
}

// z = P⁻¹·r, a node's three rows at once.
void VectorUnit::precondition(int node, Lane& lane) {
  if (!settings_.preconditioned()) {
    lane.z = lane.r;
  } else {
    const std::int32_t* inverse = &memories_.inverse[9 * at(node)];
    for (std::size_t row = 0; row < 3; ++row) {
      std::int64_t sum = 0;
      for (std::size_t c = 0; c < 3; ++c) sum += std::int64_t{inverse[3 * row + c]} * lane.r[c];
      lane.z[row] = machine_.write(machine_.rounded_shift(sum, -inverse_shift_),
                                   fixed::Settings::kProductBits);
      memories_.z[3 * at(node) + row] = lane.z[row];
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    track(sums_.largest_r, lane.r[c]);
    track(sums_.largest_z, lane.z[c]);
  }
}

void VectorUnit::write_direction_word(Lane& lane, std::int32_t* direction) {
  for (std::size_t c = 0; c < 3; ++c) {
    std::int64_t sum = machine_.rounded_shift(lane.z[c], now_.z_shift);
    if (now_.pass == Pass::direction) sum += machine_.rounded_shift(lane.beta_d[c], now_.d_shift);
    direction[c] = machine_.write(sum, settings_.vector_bits);
    track(sums_.largest_d, direction[c]);
  }
}

void VectorUnit::sum(const Group& group, const Lane* lanes) {
  done_nodes_ += group.count;
  const bool forms_residual =
      now_.pass == Pass::residual || (now_.pass == Pass::update && !now_.exchange);
  if (now_.hold || !forms_residual) return;
  for (int i = 0; i < group.count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Lane& lane = lanes[i];
      sums_.dot += static_cast<fixed::Int128>(lane.z[c]) * lane.r[c];
      sums_.squares += static_cast<fixed::Int128>(lane.r[c]) * lane.r[c];
    }
  }
}

// A row of a block that has one, if the bank of q that it goes to is free. Returns 1 or 0.
int VectorUnit::take(std::size_t block) {
  if (blocks_[block]->finished.read() == taken_[block]) return 0;
  const RowResult& row = blocks_[block]->result(taken_[block]);
  std::uint8_t& written = bank_written_[at(row.node % architecture_.nodes_per_clock)];
  if (written != 0) return 0;
  written = 1;
  int& count = back_count_[back_ranks_.entering()];
  back_row_[back_ranks_.entering() * at(architecture_.nodes_per_clock) + at(count)] = row;
  ++count;
  taken[block]->write(++taken_[block]);
  return 1;
}

// Up to L rows an edge, in turn from the blocks.
void VectorUnit::collect() {
  back_ranks_.advance();
  back_count_[back_ranks_.entering()] = 0;
  std::ranges::fill(bank_written_, std::uint8_t{0});
  int left = architecture_.nodes_per_clock;
  std::size_t block = first_block_;
  for (std::size_t i = 0; i < blocks_.size() && left > 0; ++i) {
    const int took = take(block);
    left -= took;
    if (++block == blocks_.size()) block = 0;
    if (took > 0) first_block_ = block;
  }
  write_back(architecture_.vector_clocks() - 1);
}

// Rounded and clamped once: q, and the row's part of dᵀq.
void VectorUnit::write_back(int age) {
  const std::size_t slot = back_ranks_.slot(age);
  const int count = back_count_[slot];
  done_nodes_ += count;
  if (now_.hold || count == 0) return;
  written_node_ = back_row_[slot * at(architecture_.nodes_per_clock)].node;
  for (int i = 0; i < count; ++i) {
    const RowResult& row = back_row_[slot * at(architecture_.nodes_per_clock) + at(i)];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t sum = now_.zero ? 0 : row.sum[c];
      const std::int32_t q = machine_.write(machine_.rounded_shift(sum, -settings_.product_shift()),
                                            fixed::Settings::kProductBits);
      memories_.q[3 * at(row.node) + c] = q;
      sums_.dot += static_cast<fixed::Int128>(q) * row.own[c];
      track(sums_.largest_q, q);
      if (!now_.compare) continue;
      const std::int32_t b =
          silent_.write(memories_.b[3 * at(row.node) + c], settings_.residual_bits());
      sums_.squares += static_cast<fixed::Int128>(b) * b;
      track(sums_.widest, (std::int64_t{b} << settings_.rhs_shift()) -
                              (std::int64_t{q} << settings_.product_shift()));
    }
  }
}

}  // namespace hvp::vp::engine
