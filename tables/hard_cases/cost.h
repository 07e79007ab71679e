#pragma once

#include <string>

#include "models/fixed/remedy.h"
#include "models/sparse/block_matrix.h"

namespace hvp::tables {

// What solving costs in a frame on the thesis' board: EP2S60 at 100 MHz, PCI at 33 MHz, and the
// host of models/host. All passes: b written, solved, u read; and for a refined solve what the
// host computes between them.
struct FrameCost {
  double board_us = 0;
  double bus_us = 0;
  double host_us = 0;
  double total_us() const { return board_us + bus_us + host_us; }

  // "EP2S60"; "EP2S180" where the thesis' device is too small; "none: M4K 1320 of 768" otherwise.
  std::string device;
};

// The period of thesis §6.2.4.
inline constexpr double kPeriodUs = 2000;

FrameCost frame_cost(const sparse::BlockMatrix& matrix, const fixed::Plan& plan);

}  // namespace hvp::tables
