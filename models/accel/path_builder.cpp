#include "models/accel/path_builder.h"

#include <algorithm>

#include "models/accel/bits.h"

namespace hvp::accel {

namespace {

// Levels of a multiplexer. A look-up table of four inputs chooses one of two words, and a hard
// multiplexer behind each pair of them saves a level; one of six inputs chooses one of four.
int multiplexer_levels(int select, int inputs) {
  if (select <= 1) return select;
  return inputs >= 6 ? (select + 1) / 2 : select - 1;
}

int gate_levels(int inputs, int of_one) {
  int levels = 0;
  for (int left = inputs; left > 1; left = (left + of_one - 1) / of_one) ++levels;
  return levels;
}

}  // namespace

PathBuilder::PathBuilder(const DeviceTiming& timing, double fill)
    : timing_(timing), nets_(1 + timing.crowding * std::clamp(fill, 0.0, 1.0)) {}

PathBuilder& PathBuilder::begin(std::string_view name) {
  path_.name = name;
  path_.transfers_per_clock = 1;
  path_.elements.clear();
  at_ = At::start;
  return *this;
}

PathBuilder& PathBuilder::twice_a_clock() {
  path_.transfers_per_clock = 2;
  return *this;
}

void PathBuilder::add(ElementKind kind, int size, double delay_s, At at) {
  path_.elements.push_back({kind, size, delay_s});
  at_ = at;
}

void PathBuilder::net(bool to_block) {
  const bool from_block = at_ == At::multiplier || at_ == At::memory || at_ == At::block_register;
  const double delay = to_block || from_block ? timing_.block_routing_s : timing_.routing_s;
  path_.elements.push_back({ElementKind::routing, 0, nets_ * delay});
}

void PathBuilder::levels(ElementKind kind, int size, int count) {
  for (int i = 0; i < count; ++i) {
    net(false);
    add(kind, size, timing_.logic_s, At::logic);
  }
}

// A bit of a sum needs the bit below it of the sum before: of chains one behind the other the path
// goes along one only.
void PathBuilder::chain(ElementKind kind, int bits) {
  const int before = at_ == At::carry ? chain_bits_ : 0;
  net(false);
  add(kind, bits, timing_.carry_s + std::max(0, bits - before) * timing_.carry_bit_s, At::carry);
  chain_bits_ = std::max(bits, before);
}

PathBuilder& PathBuilder::from_register() {
  add(ElementKind::clock_to_out, 0, timing_.clock_to_out_s, At::start);
  return *this;
}

PathBuilder& PathBuilder::from_multiplier_register() {
  add(ElementKind::multiplier_register, 0, timing_.multiplier_register_s, At::block_register);
  return *this;
}

PathBuilder& PathBuilder::from_memory(bool output_register) {
  if (output_register) {
    add(ElementKind::memory_register, 0, timing_.memory_register_s, At::memory);
  } else {
    add(ElementKind::memory_read, 0, timing_.memory_read_s, At::memory);
  }
  return *this;
}

PathBuilder& PathBuilder::multiplexer(int ways) {
  levels(ElementKind::multiplexer, ways,
         multiplexer_levels(levels_over(ways), timing_.logic_inputs));
  return *this;
}

PathBuilder& PathBuilder::shifter(int bits) {
  levels(ElementKind::shifter, bits, multiplexer_levels(levels_over(bits), timing_.logic_inputs));
  return *this;
}

PathBuilder& PathBuilder::gates(int inputs) {
  levels(ElementKind::gates, inputs, gate_levels(inputs, timing_.logic_inputs));
  return *this;
}

// A chain that negates, and a multiplexer that takes what comes out of it or not.
PathBuilder& PathBuilder::absolute_value(int bits) {
  chain(ElementKind::absolute_value, bits);
  levels(ElementKind::absolute_value, bits, 1);
  return *this;
}

PathBuilder& PathBuilder::adder(int bits) {
  chain(ElementKind::adder, bits);
  return *this;
}

PathBuilder& PathBuilder::comparator(int bits) {
  chain(ElementKind::comparator, bits);
  levels(ElementKind::comparator, bits, 1);
  at_ = At::decision;
  return *this;
}

PathBuilder& PathBuilder::multiplier(int bits) {
  net(true);
  add(ElementKind::multiplier, bits, timing_.multiplier_s, At::multiplier);
  return *this;
}

PathBuilder& PathBuilder::multiplier_alone(int bits) {
  add(ElementKind::multiplier, bits, timing_.multiplier_s, At::multiplier);
  return *this;
}

const Path& PathBuilder::to_register() {
  const bool packed = at_ == At::logic || at_ == At::carry;
  if (!packed) net(false);
  add(ElementKind::set_up, 0, timing_.set_up_s, At::start);
  return path_;
}

const Path& PathBuilder::to_multiplier() {
  net(true);
  add(ElementKind::set_up, 0, timing_.set_up_s, At::start);
  return path_;
}

const Path& PathBuilder::to_multiplier_output() {
  add(ElementKind::set_up, 0, timing_.set_up_s, At::start);
  return path_;
}

const Path& PathBuilder::to_memory() {
  net(true);
  add(ElementKind::memory_set_up, 0, timing_.memory_set_up_s, At::start);
  return path_;
}

const Path& PathBuilder::block(double clock_hz) {
  add(ElementKind::block, 0, 1 / clock_hz, At::start);
  return path_;
}

}  // namespace hvp::accel
