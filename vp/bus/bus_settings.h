#pragma once

#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/link/frame_transfer.h"
#include "models/link/pci.h"
#include "models/link/pcie.h"
#include "models/link/read_latencies.h"
#include "vp/frame/frame.h"

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

// The scenario's effect [bus.posted_writes]: the bridge between processor and bus takes a write and
// the processor goes on, and the bridge takes a board's write to memory likewise. They keep their
// order, and a read waits for those before it (PCI Local Bus Specification 3.0, §3.2.5).
struct PostedWriteSettings {
  int buffer_bytes = 64;
  double to_memory_s = 200e-9;

  void declare(config::Visitor& v);
  void check() const;

  // The number of one-word writes that fit into the buffer, besides one that is on the bus.
  std::size_t places() const { return static_cast<std::size_t>(buffer_bytes) / 4 + 1; }
  Picoseconds to_memory() const;
};

// The scenario's effect [bus.graphics_traffic]: a graphics card on the same bus, which as its
// master fetches a picture's data each time the collision and graphics process begins to draw.
struct GraphicsTraffic {
  int bytes_per_vertex = 24;
  int bytes = 0;

  void declare(config::Visitor& v);
  // The bytes of a picture of a surface with this number of vertices.
  std::int64_t picture_bytes(std::int64_t vertices) const;
};

// The scenario's effect [bus.pcie].
struct PcieSettings : link::Pcie {
  std::optional<link::RootComplexLatencies> root_complex_latencies;

  void declare(config::Visitor& v);
};

// The scenario's table [bus]. The members after link::Pci are for the approximately-timed bus
// unless stated otherwise.
struct BusSettings {
  link::Pci pci;
  std::optional<link::PciProtocol> protocol;
  std::optional<BusTraffic> traffic;
  std::optional<GraphicsTraffic> graphics_traffic;
  std::optional<PostedWriteSettings> posted_writes;      // for the loosely-timed bus too
  std::optional<link::PciReadLatencies> read_latencies;  // likewise
  std::optional<PcieSettings> pcie;  // the solver board's own link, at every level

  void declare(config::Visitor& v);
  void check() const { pci.check(); }
};

// The board's functions as bus master; none by default.
struct MasterSettings {
  std::optional<link::DmaEngine> dma;
  // Interrupts are writes to kMessageAddress, behind the board's data, instead of a line.
  bool messages = false;

  bool present() const { return dma.has_value() || messages; }
};

}  // namespace hvp::vp
