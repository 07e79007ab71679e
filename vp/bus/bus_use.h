#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "vp/frame/frame.h"

namespace hvp::vp {

// What one initiator has had of a bus since the simulation began, set-up included.
struct BusUse {
  std::string_view name;  // processor, board, traffic, graphics
  Picoseconds busy = 0;   // the bus, or its direction of a link, was taken
  std::int64_t bytes = 0;
  std::int64_t transactions = 0;
};

// Of every initiator that the bus has, idle ones too.
using BusUses = std::vector<BusUse>;

}  // namespace hvp::vp
