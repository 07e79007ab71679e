#include "models/accel/external_memory.h"

#include "models/config/input_error.h"

namespace hvp::accel {

using config::Dimension;

void Refresh::declare(config::Visitor& v) {
  v.quantity(
      "every", every_s, Dimension::time, config::between(1e-7, 1e-3),
      {"tREFI: from one refresh to the next",
       "JEDEC JESD79-2, as Micron's data sheet of the MT47H64M16 has it: 7.8 us up to 85 C"});
  v.quantity("pause", pause_s, Dimension::time, config::between(1e-9, 1e-4),
             {"tRFC: how long the memory delivers nothing then",
              "the same data sheet: 127.5 ns of a DDR2 memory of 1 Gbit"});
}

void Refresh::check() const {
  if (2 * pause_s <= every_s) return;
  throw InputError(
      "pause", "the memory would hardly do anything but refresh: expected at most half of every");
}

void ExternalMemory::declare(config::Visitor& v) {
  v.integer("width", width_bits, {8, 4096},
            {"bits of a transfer", "JEDEC JESD21-C: a DDR2 module of 240 pins without ECC"});
  v.quantity("transfer_rate", transfers_hz, Dimension::frequency, config::between(1e6, 1e11),
             {"transfers a second, two a clock of a DDR memory",
              "JEDEC JESD79-2: DDR2-400, the standard's slowest"});
  v.integer("buffer_packages", buffer_packages, {1, 1 << 16},
            {"packages of each partition that are read ahead into the device",
             "as accelerator.result_queue"});
  v.effect("refresh", refresh,
           {"the memory's refresh, for which the stream pauses; without it, it never does",
            "no module: the stream takes every / (every - pause) times as long"});
}

}  // namespace hvp::accel
