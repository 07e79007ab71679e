#pragma once

#include <cstdint>

namespace hvp::vp::rtl {

// What the engine in SystemVerilog has been compared in with the cycle-accurate one.
struct Compared {
  std::int64_t solves = 0;      // to their ends, those without an iteration among them
  std::int64_t aborted = 0;     // up to the clock of the abort
  std::int64_t iterations = 0;  // of both kinds
  std::int64_t clocks = 0;
  std::int64_t updates = 0;  // changes of the matrix by its editor
  std::int64_t words = 0;    // of vectors and matrix
};

}  // namespace hvp::vp::rtl
