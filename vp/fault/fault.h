#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::vp {

enum class FaultKind {
  lost_interrupt,   // the board's request does not reach the host
  stuck_busy,       // the job does not end; STATUS.busy stays until a reset
  saturated_solve,  // the job's b is at the limits of its words
  master_abort,     // nobody claims one access
  device_gone,      // nobody claims any access, and no interrupt comes
  corrupted_word,   // bits of one word of a block are flipped on the bus
  late_dma,         // U leaves the board late
  truncated_dma,    // the last bytes of U stay on the board
};
inline constexpr int kFaultKinds = 8;

const char* name(FaultKind kind);

// Which access of a frame to the solver board is hit.
enum class FaultAccess { first, rhs, start, status, acknowledge, solution };

const char* name(FaultAccess access);

// What goes wrong, and when. One item of the scenario's list [[fault]].
struct Fault {
  FaultKind kind = FaultKind::lost_interrupt;
  std::int64_t frame = -1;  // −1: not stated
  double rate = 0;          // 0: not stated
  FaultAccess access = FaultAccess::first;
  int bits = 0;
  std::int64_t frames = 0;
  double delay_s = 0;
  int bytes = 0;

  void declare(config::Visitor& v);
  // Throws InputError where frame and rate are both there or both missing.
  void check() const;

  std::int64_t delay_ps() const;
  // Of one word, for a corrupted one.
  int flipped_bits() const { return bits == 0 ? 1 : bits; }
};

}  // namespace hvp::vp
