#pragma once

#include <string>

#include "models/fixed/remedy.h"
#include "models/sparse/block_matrix.h"

namespace hvp::tables {

// The cost of the solve in a frame on the thesis' board: EP2S60 at 100 MHz, PCI at 33 MHz, and the
// host of models/host. It covers all passes (b written, solved, u read) and the host's computations
// between passes of a refined solve.
struct FrameCost {
  double board_us = 0;
  double bus_us = 0;
  double host_us = 0;
  double total_us() const { return board_us + bus_us + host_us; }

  // The FPGA: "EP2S60"; "EP2S180" if the thesis' FPGA is too small; otherwise "none: M4K 1320 of
  // 768".
  std::string device;
};

// The period of thesis §6.2.4.
inline constexpr double kPeriodUs = 2000;

FrameCost frame_cost(const sparse::BlockMatrix& matrix, const fixed::Plan& plan);

}  // namespace hvp::tables
