#pragma once

#include "models/accel/critical_path.h"
#include "models/accel/device_timing.h"

namespace hvp::accel {

// Lays one element behind the other and puts a net between them: between logic cells a short one,
// to and from a multiplier or a memory a longer one. Nothing lies between a logic cell and the
// register in it.
class PathBuilder {
 public:
  // `fill`: the part of the device's multipliers that is in use, which makes nets longer.
  PathBuilder(const DeviceTiming& timing, double fill);

  // What was begun before is dropped; its storage is used again.
  PathBuilder& begin(std::string_view name);
  PathBuilder& twice_a_clock();
  std::string_view name() const { return path_.name; }

  // Where it starts.
  PathBuilder& from_register();
  PathBuilder& from_multiplier_register();
  PathBuilder& from_memory(bool output_register);

  PathBuilder& multiplexer(int ways);
  PathBuilder& shifter(int bits);  // by any number of bits
  PathBuilder& gates(int inputs);  // a function of so many
  PathBuilder& absolute_value(int bits);
  PathBuilder& adder(int bits);
  // A word is kept where it is larger than another one.
  PathBuilder& comparator(int bits);
  PathBuilder& multiplier(int bits);
  // From the block's input register to its output register.
  PathBuilder& multiplier_alone(int bits);

  // Where it ends.
  const Path& to_register();
  const Path& to_multiplier();         // its input register
  const Path& to_multiplier_output();  // behind multiplier()
  const Path& to_memory();
  // A block that is full of registers: its own limit.
  const Path& block(double clock_hz);

 private:
  // decision: logic whose one bit goes to all cells of a word.
  enum class At { start, logic, carry, decision, multiplier, memory, block_register };

  void net(bool to_block);
  void add(ElementKind kind, int size, double delay_s, At at);
  void levels(ElementKind kind, int size, int count);
  void chain(ElementKind kind, int bits);

  const DeviceTiming& timing_;
  double nets_;  // factor on every net
  Path path_;
  At at_ = At::start;
  int chain_bits_ = 0;  // of the carry chains that end here
};

}  // namespace hvp::accel
