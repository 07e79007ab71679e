#pragma once

#include <cstddef>
#include <optional>

#include "models/config/declaration.h"
#include "models/fixed/settings.h"
#include "models/link/frame_transfer.h"
#include "vp/fpga/dma_engine.h"

namespace hvp::vp {

// The scenario's table [transfer]: how the driver moves b and U, and how it hears of the end.
struct Transfer {
  enum class Method { bursts, programmed_io, write_combined_io, dma };

  Method method = Method::bursts;
  link::Notification notification = link::Notification::intx;
  double poll_interval_s = 1e-6;
  bool packed = true;
  std::optional<link::DmaEngine> dma;  // the effect [transfer.dma]

  void declare(config::Visitor& v);

  // What it makes of the board.
  MasterSettings master() const;
  link::DmaEngine engine() const { return dma.value_or(link::DmaEngine{}); }
  // Bytes of b and of U on their way.
  std::size_t rhs_bytes(const fixed::Settings& solver, std::size_t unknowns) const;
  std::size_t solution_bytes(const fixed::Settings& solver, std::size_t unknowns) const;
  // Where it is what a board without a DMA engine and with a line does.
  bool plain() const;
};

const char* name(Transfer::Method method);
// As a scenario writes it.
const char* key_of(link::Notification notification);

}  // namespace hvp::vp
