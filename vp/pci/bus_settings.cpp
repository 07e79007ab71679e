#include "vp/pci/bus_settings.h"

#include <cmath>
#include <string>

#include "models/config/input_error.h"

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

Picoseconds BusTraffic::period() const { return std::llround(period_s * 1e12); }
Picoseconds BusTraffic::start() const { return std::llround(start_s * 1e12); }

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

Picoseconds PostedWriteSettings::to_memory() const { return std::llround(to_memory_s * 1e12); }

void BusSettings::declare(config::Visitor& v) {
  pci.declare(v);
  v.effect("protocol", protocol,
           {"several masters, slow targets and delayed reads, of the approximately-timed bus"});
  v.effect("traffic", traffic,
           {"another master that moves blocks, on the approximately-timed bus"});
  v.effect("posted_writes", posted_writes,
           {"the processor goes on while the bridge writes; without it it waits for each write"});
}

}  // namespace hvp::vp
