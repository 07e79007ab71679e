#pragma once

#include "models/accel/critical_path.h"
#include "models/accel/device.h"

namespace hvp::accel {

// Builds a path element by element, with a net before each: a short one between logic cells, a
// longer one to and from a multiplier or a memory. There is no net between a logic cell and the
// register in it.
class PathBuilder {
 public:
  // `fill` is the share of the device's multipliers that is in use; it makes nets longer.
  PathBuilder(const DeviceTiming& timing, double fill);

  // Begins a path and drops the one before, whose storage is used again.
  PathBuilder& begin(std::string_view name);
  PathBuilder& twice_a_clock();
  std::string_view name() const { return path_.name; }

  // The path's start.
  PathBuilder& from_register();
  PathBuilder& from_multiplier_register();
  PathBuilder& from_memory(bool output_register);

  PathBuilder& multiplexer(int ways);
  PathBuilder& shifter(int bits);  // by any number of bits
  PathBuilder& gates(int inputs);  // a function of `inputs` bits
  PathBuilder& absolute_value(int bits);
  PathBuilder& adder(int bits);
  // Keeps the larger of two words.
  PathBuilder& comparator(int bits);
  PathBuilder& multiplier(int bits);
  // A path inside the block, from its input register to its output register.
  PathBuilder& multiplier_alone(int bits);

  // The path's end.
  const Path& to_register();
  const Path& to_multiplier();         // its input register
  const Path& to_multiplier_output();  // behind multiplier()
  const Path& to_memory();
  // A path inside a block that is full of registers: the block's own limit.
  const Path& block(double clock_hz);

 private:
  // `decision` is logic whose single bit goes to all cells of a word.
  enum class At { start, logic, carry, decision, multiplier, memory, block_register };

  void net(bool to_block);
  void add(ElementKind kind, int size, double delay_s, At at);
  void levels(ElementKind kind, int size, int count);
  void chain(ElementKind kind, int bits);

  const DeviceTiming& timing_;
  double nets_;  // factor on every net
  Path path_;
  At at_ = At::start;
  int chain_bits_ = 0;  // bits of the carry chains that end here
};

}  // namespace hvp::accel
