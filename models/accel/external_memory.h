#pragma once

#include "models/config/declaration.h"

namespace hvp::accel {

// Dynamic memory beside each device, which the matrix is streamed from: the scenario's effect
// [accelerator.external_memory]. Its product takes as long as the stream where that is longer.
struct ExternalMemory {
  int width_bits = 64;
  double transfers_hz = 400e6;  // of width_bits each, so many a second
  int buffer_packages = 16;     // of each partition, on the device

  void declare(config::Visitor& v);
};

}  // namespace hvp::accel
