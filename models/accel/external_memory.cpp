#include "models/accel/external_memory.h"

namespace hvp::accel {

void ExternalMemory::declare(config::Visitor& v) {
  using config::Dimension;
  v.integer("width", width_bits, {8, 4096},
            {"bits of a transfer", "JEDEC JESD21-C: a DDR2 module of 240 pins without ECC"});
  v.quantity("transfer_rate", transfers_hz, Dimension::frequency, config::between(1e6, 1e11),
             {"transfers a second, two a clock of a DDR memory",
              "JEDEC JESD79-2: DDR2-400, the standard's slowest"});
  v.integer("buffer_packages", buffer_packages, {1, 1 << 16},
            {"packages of each partition that are read ahead into the device",
             "as accelerator.result_queue"});
}

}  // namespace hvp::accel
