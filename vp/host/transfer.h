#pragma once

#include <cstddef>
#include <optional>

#include "models/config/declaration.h"
#include "models/fixed/settings.h"
#include "models/link/frame_transfer.h"
#include "vp/bus/bus_settings.h"

namespace hvp::vp {

// The scenario's table [transfer]: the way in which the driver moves b and U and learns of the end.
struct Transfer {
  enum class Method { bursts, programmed_io, write_combined_io, dma };

  Method method = Method::bursts;
  link::Notification notification = link::Notification::intx;
  double poll_interval_s = 1e-6;
  bool packed = true;
  std::optional<link::DmaEngine> dma;  // the effect [transfer.dma]

  void declare(config::Visitor& v);

  // The board's settings as a bus master.
  MasterSettings master() const;
  link::DmaEngine engine() const { return dma.value_or(link::DmaEngine{}); }
  // The number of bytes in which b and U are transferred.
  std::size_t rhs_bytes(const fixed::Settings& solver, std::size_t unknowns) const;
  std::size_t solution_bytes(const fixed::Settings& solver, std::size_t unknowns) const;
  // Likewise so many entries of the matrix.
  std::size_t values_bytes(const fixed::Settings& solver, std::size_t entries) const;
  // True for the transfer of a board without a DMA engine and with an interrupt line.
  bool plain() const;
};

const char* name(Transfer::Method method);
// The name in a scenario.
const char* key_of(link::Notification notification);

}  // namespace hvp::vp
