#include "vp/fpga/engine/vector_unit.h"

#include <algorithm>

#include "models/index.h"

namespace hvp::vp::engine {

namespace {

bool reads_direction(const VectorCommand& command) {
  return command.pass == Pass::update || command.pass == Pass::direction ||
         (command.pass == Pass::residual && command.exchange);
}

bool writes_direction(const VectorCommand& command) {
  switch (command.pass) {
    case Pass::copy:
    case Pass::guess:
    case Pass::first_direction:
    case Pass::direction:
      return true;
    default:
      return command.exchange;
  }
}

}  // namespace

VectorUnit::VectorUnit(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
                       std::vector<std::unique_ptr<SpmxvBlock>>& blocks)
    : sc_module(name),
      architecture_(architecture),
      blocks_(blocks),
      ranks_(architecture.phase_clocks()),
      group_(ranks_.size()),
      carried_(kVectors * 3 * at(architecture.nodes_per_clock) * ranks_.size()),
      coefficients_(ranks_.size()),
      back_ranks_(architecture.vector_clocks()),
      back_count_(back_ranks_.size()),
      back_words_(back_ranks_.size() * at(architecture.nodes_per_clock)),
      results_(blocks.size()),
      bank_written_(at(architecture.nodes_per_clock)),
      direction_words_(2 * 3 * at(architecture.nodes_per_clock)) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    taken.push_back(std::make_unique<Register<std::uint32_t>>());
  }
}

void VectorUnit::load(int nodes) {
  nodes_ = nodes;
  lanes_.load(nodes);
  bank_.resize(at(nodes));
  for (int node = 0; node < nodes; ++node) bank_[at(node)] = node % architecture_.nodes_per_clock;
  reset();
}

void VectorUnit::reset() {
  running_ = false;
  ended_ = false;
  writes_left_ = 0;
  late_z_.clear();
  first_block_ = 0;
  for (Group& group : group_) group.count = 0;
  for (int& count : back_count_) count = 0;
  std::ranges::fill(results_, Results{});
  for (const auto& count : taken) count->reset();
}

// The blocks drop theirs at the same edge, and count the room that they have until then.
void VectorUnit::forget_rows() {
  std::ranges::fill(results_, Results{});
  for (const auto& count : taken) count->write(0);
}

void VectorUnit::clocked() {
  const bool starts = command->read().number != lanes_.command().number;
  if (starts) begin_pass();
  const bool product = running_ && lanes_.command().pass == Pass::product;
  product_ended_ = carries_words_ && ended_ && lanes_.command().pass == Pass::product;
  ended_ = false;
  if (carries_words_) {
    address(starts);
    write_z();
  }
  if (running_) {
    if (product) {
      collect();
    } else {
      move_lanes();
    }
    if (done_nodes_ == nodes_) finish_pass();
  }
  if (!carries_words_) return;
  // The lanes read what q has before the edge.
  if (!product) drain_rows();
  if (product_ended_) forget_rows();
}

// A pass may take the place of one that is not over: the copy of an x that has changed since.
void VectorUnit::begin_pass() {
  lanes_.begin(command->read());
  running_ = lanes_.command().pass != Pass::none;
  reads_direction_ = reads_direction(lanes_.command());
  writes_direction_ = writes_direction(lanes_.command());
  next_node_ = 0;
  done_nodes_ = 0;
  reads_left_ = 0;
  writes_left_ = 0;
  for (Group& group : group_) group.count = 0;
}

void VectorUnit::finish_pass() {
  // The largest word of q has those, too, that an index word's flip has brought beyond the system.
  const int read = std::min(architecture_.memory_read_clocks, architecture_.vector_clocks()) - 1;
  if (multiplies_ && !lanes_.command().hold) {
    for (int rank = 0; rank < read; ++rank) round_rows(rank);
  }
  status.write(lanes_.status());
  running_ = false;
  ended_ = true;
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
  const int summed_age = architecture_.phase_clocks() - 1;
  const int written_age = summed_age - architecture_.adder_tree_clocks;

  ranks_.advance();
  const std::size_t written = ranks_.slot(written_age);
  if (group_[written].count > 0 && writes_direction_) {
    const int needed = accesses(group_[written].count, architecture_.direction_write_accesses());
    const int used = std::min(accesses_left, needed);
    writes_left_ = needed - used;
    accesses_left -= used;
  }
  enter_group(accesses_left);
  if (carries()) carry();
  write(written);
  done_nodes_ += group_[ranks_.slot(summed_age)].count;
}

// The next L nodes, if the ports of d serve them.
void VectorUnit::enter_group(int accesses_left) {
  Group& group = group_[ranks_.entering()];
  group.count = 0;
  if (next_node_ == nodes_) return;
  const int count = std::min(architecture_.nodes_per_clock, nodes_ - next_node_);
  if (reads_direction_) {
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

void VectorUnit::write(std::size_t slot) {
  const Group& group = group_[slot];
  if (group.count == 0 || lanes_.command().hold) return;
  written_node_ = group.first;
  // The blocks take the words at the next edge, at which others may be written already.
  const std::uint32_t number = direction_write.read().number + 1;
  std::int32_t* const words = &direction_words_[(number & 1U) * direction_words_.size() / 2];
  if (lanes_.command().pass == Pass::copy) {
    std::copy_n(carried_words(slot).x, 3 * group.count, words);
  } else {
    const LaneWords from = carries()
                               ? carried_words(slot)
                               : lanes_.words(group.first, blocks_.front()->direction(group.first));
    lanes_.write(group.first, group.count, from, words);
    if (carries_words_) send_z(group, from);
  }
  if (writes_direction_) direction_write.write({group.first, group.count, number, words});
}

int VectorUnit::bank(int node) const {
  return node < nodes_ ? bank_[at(node)] : node % architecture_.nodes_per_clock;
}

bool VectorUnit::has_row(std::size_t block) const {
  return blocks_[block]->finished.read() != results_[block].taken;
}

// The row of a block that has one, if the bank of q that it goes to is free.
bool VectorUnit::take(std::size_t block) {
  Results& results = results_[block];
  const RowResult& row = blocks_[block]->result_in(results.place);
  std::uint8_t& written = bank_written_[at(bank(row.node))];
  if (written != 0) return false;
  written = 1;
  int& count = back_count_[back_ranks_.entering()];
  ProductWords& words =
      back_words_[back_ranks_.entering() * at(architecture_.nodes_per_clock) + at(count)];
  words.node = row.node;
  if (carries_words_) {
    words.sum = row.sum;
    words.own = row.own;
  } else if (!lanes_.command().hold) {
    words.q = lanes_.round_product(row.node, row.sum, row.own);
  }
  ++count;
  results.place = blocks_[block]->next_place(results.place);
  taken[block]->write(++results.taken);
  return true;
}

// Up to L rows an edge, in turn from the blocks. The first one that had to be passed over has the
// next turn: whoever has a turn is served, so that no row waits for PL3 edges.
void VectorUnit::collect() {
  back_ranks_.advance();
  back_count_[back_ranks_.entering()] = 0;
  std::ranges::fill(bank_written_, std::uint8_t{0});
  int left = architecture_.nodes_per_clock;
  bool passed_over = false;
  const std::size_t turn = first_block_;
  for (std::size_t i = 0; i < blocks_.size() && left > 0; ++i) {
    const std::size_t block = turn + i < blocks_.size() ? turn + i : turn + i - blocks_.size();
    if (!has_row(block)) continue;
    if (take(block)) {
      --left;
      if (!passed_over) first_block_ = block + 1 == blocks_.size() ? 0 : block + 1;
    } else if (!passed_over) {
      passed_over = true;
      first_block_ = block;
    }
  }
  if (carries_words_ && !lanes_.command().hold) carry_rows();
  done_nodes_ += back_count_[back_ranks_.slot(architecture_.vector_clocks() - 1)];
  write_back();
}

void VectorUnit::write_back() {
  const std::size_t slot = back_ranks_.slot(architecture_.vector_clocks() - 1);
  const int count = back_count_[slot];
  if (lanes_.command().hold || count == 0) return;
  const ProductWords* const words = &back_words_[slot * at(architecture_.nodes_per_clock)];
  const auto lane = [this](const ProductWords& row) { return bank(row.node); };
  const int first = std::ranges::min_element(words, words + count, {}, lane)->node;
  if (first < nodes_) written_node_ = first;
  for (int i = 0; i < count; ++i) {
    if (words[i].node >= nodes_) continue;  // by a flip: a word of the memory that no node has
    std::ranges::copy(words[i].q, lanes_.memories().q.begin() + 3 * words[i].node);
  }
}

}  // namespace hvp::vp::engine
