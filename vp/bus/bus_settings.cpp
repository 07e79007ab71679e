#include "vp/bus/bus_settings.h"

#include <string>

#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

void BusTraffic::declare(config::Visitor& v) {
  using config::Dimension;
  v.quantity(
      "period", period_s, Dimension::time, config::between(1e-6, 10),
      {"time between two blocks; one that is due while the last one is under way is left out",
       "network card at full load: 1538 byte times at 100 Mbit/s (IEEE 802.3)"});
  v.quantity("start", start_s, Dimension::time, config::between(0, 10),
             {"when the first block is due, from the beginning of the simulation",
              "with the loading of K"});
  v.integer("bytes", bytes, {4, 1 << 20},
            {"size of a block", "the largest frame without its check sum (IEEE 802.3)"});
  v.choice("direction", direction,
           {{"write", link::Direction::write}, {"read", link::Direction::read}},
           {"write: into the host's memory; read: out of it", "a network card that receives"});
}

Picoseconds BusTraffic::period() const { return to_picoseconds(period_s); }
Picoseconds BusTraffic::start() const { return to_picoseconds(start_s); }

void PostedWriteSettings::declare(config::Visitor& v) {
  using config::Dimension;
  v.integer("buffer_bytes", buffer_bytes, {4, 4096},
            {"what the bridge buffers of the processor's writes before the processor has to wait",
             "unverified: one cache line, as burst_bytes"});
  v.quantity("to_memory", to_memory_s, Dimension::time, config::between(0, 1e-3),
             {"from a board's last data phase until the host's memory has the data; an interrupt "
              "line is faster",
              "unverified: a chipset's way to memory"});
}

void PostedWriteSettings::check() const {
  if (buffer_bytes % 4 == 0) return;
  throw InputError("buffer_bytes", std::to_string(buffer_bytes) +
                                       " bytes: expected a whole number of 32-bit words");
}

Picoseconds PostedWriteSettings::to_memory() const { return to_picoseconds(to_memory_s); }

void GraphicsTraffic::declare(config::Visitor& v) {
  v.integer(
      "bytes_per_vertex", bytes_per_vertex, {4, 1024},
      {"what the card reads of each vertex of the body's surface",
       "assumed: position and normal as three 32-bit floats each; triangles stay on the card"});
  v.integer("bytes", bytes, {0, 1 << 24},
            {"size of a picture's data; 0: that of the surface's vertices", "the surface's"});
}

std::int64_t GraphicsTraffic::picture_bytes(std::int64_t vertices) const {
  return bytes > 0 ? bytes : vertices * bytes_per_vertex;
}

void PcieSettings::declare(config::Visitor& v) {
  Pcie::declare(v);
  v.effect("root_complex_latencies", root_complex_latencies,
           {"root_complex_latency drawn for each read request of the board that a frame waits for; "
            "set-up has the constant",
            random::drawn("in the place of root_complex_latency, at each read request of the board",
                          root_complex_latencies),
            {config::need_timed_bus("a link that takes no time has no latencies"),
             {"transfer.method", {"dma"}, "the board reads memory by DMA only"}}});
}

void BusSettings::declare(config::Visitor& v) {
  v.include(pci);
  v.effect("protocol", protocol,
           {"several masters, slow targets and delayed reads, of the approximately-timed bus",
            "latency timer, wait states and delayed reads between the bus' masters",
            {config::need_bus_cycles()}});
  v.effect("traffic", traffic,
           {"another master that moves blocks, on the approximately-timed bus",
            "a process that takes the bus for a block a period",
            {config::need_bus_cycles()}});
  v.effect("graphics_traffic", graphics_traffic,
           {"a graphics card that reads each picture's data, on the approximately-timed bus",
            "a process that takes the bus for a picture's data a drawing pass",
            {config::need_bus_cycles()}});
  v.effect("pcie", pcie,
           {"the solver board sits on a PCI Express link of its own; the DAQ board stays on PCI",
            "the solver board on a link of its own: four processes of the link",
            {config::need_board(),
             // On PCI the bridge may be one that bursts; behind a root port nobody has seen one.
             {"transfer.method",
              {"dma", "write-combined-io", "programmed-io"},
              "the processor reads U in blocks, which it does over no PCI Express link"}}});
  v.effect(
      "read_latencies", read_latencies,
      {"read_latency drawn for each of the processor's reads that a frame waits for; set-up has "
       "the constant",
       random::drawn("in the place of bus.read_latency, at each read by the processor",
                     read_latencies),
       {config::need_timed_bus("a bus that takes no time has no latencies")}});
  v.effect("posted_writes", posted_writes,
           {"the processor goes on while the bridge writes; without it it waits for each write",
            "the processor goes on while the bridge writes: two processes of the bus",
            {config::need_timed_bus("a bus that takes no time posts nothing")}});
}

}  // namespace hvp::vp
