#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

enum class ElementKind {
  clock_to_out,
  set_up,
  routing,
  multiplexer,     // size: ways
  shifter,         // size: bits
  gates,           // size: inputs
  absolute_value,  // size: bits
  adder,
  comparator,
  multiplier,  // size: bits of the wider operand
  multiplier_register,
  memory_read,
  memory_register,
  memory_set_up,
  block,  // a block's own limit
};

// One element of a path between two registers.
struct Element {
  ElementKind kind = ElementKind::routing;
  int size = 0;  // as the kind says; 0 if it has none
  double delay_s = 0;
};
// The element's name: "16-bit absolute value", "2x1 multiplexer", …
std::string text(const Element& element);

// A path from a register to the next one.
struct Path {
  std::string_view name;        // "inner product d'Ad"
  int transfers_per_clock = 1;  // 2 in a double-pumped memory
  std::vector<Element> elements;

  double delay_s() const;
  // The shortest clock period of the engine that the path allows.
  double period_s() const { return transfers_per_clock * delay_s(); }
};
// The path's elements with their delays, the nets summed at the end: "register 0.10 ns, 2x1
// multiplexer 0.38 ns, …, routing 4.53 ns".
std::string text(const Path& path);

// All that the highest clock depends on. The device has to have a [timing] table.
struct Clocking {
  const Device& device;
  const Architecture& architecture;
  WordLengths words;
  int nodes = 500;
};

// The highest clock in Hz (thesis Eq. 5.2): 1 / the longest of all paths.
double highest_clock(const Clocking& c);

// The clock in Hz that the architecture gets where its own is 0, "fastest": the highest in steps of
// 10 kHz, memories that a lower clock allows included. Throws InputError with the key "clock" for a
// device without delays.
double fastest_clock(const Clocking& c);

struct CriticalPath {
  double highest_clock_hz = 0;
  std::vector<Path> paths;  // all paths; the one that limits the clock comes first
};
CriticalPath critical_path(const Clocking& c);

// Throws InputError with the key "clock", the path and the highest clock if the architecture's
// clock is above it. Does nothing for a device without delays.
void require_clock(const Clocking& c);

}  // namespace hvp::accel
