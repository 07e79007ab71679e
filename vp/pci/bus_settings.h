#pragma once

#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/link/pci.h"
#include "models/link/pci_protocol.h"
#include "vp/frame.h"

namespace hvp::vp {

// The scenario's effect [bus.traffic]: another board on the bus that is its master once a period
// and moves a block between itself and the host's memory.
struct BusTraffic {
  double period_s = 123.04e-6;
  double start_s = 0;
  int bytes = 1514;
  link::Direction direction = link::Direction::write;

  void declare(config::Visitor& v);

  Picoseconds period() const;
  Picoseconds start() const;
};

// The scenario's table [bus]. What stands beside link::Pci is for the approximately-timed bus.
struct BusSettings {
  link::Pci pci;
  std::optional<link::PciProtocol> protocol;
  std::optional<BusTraffic> traffic;

  void declare(config::Visitor& v);
  void check() const { pci.check(); }
};

}  // namespace hvp::vp
