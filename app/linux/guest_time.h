#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "vp/frame/frame_tag.h"

namespace hvp::guest {

// The guest's clock counts nanoseconds, and simulated time goes in picoseconds: what happens in
// between is at the next whole one for the guest.
inline std::uint64_t now_ns() { return static_cast<std::uint64_t>((vp::now_ps() + 999) / 1000); }
inline bool whole_ns() { return vp::now_ps() % 1000 == 0; }

// At most 106 days, which no run lasts.
inline vp::Picoseconds to_ps(std::uint64_t ns) {
  constexpr std::uint64_t kMost = std::numeric_limits<vp::Picoseconds>::max() / 1000;
  return static_cast<vp::Picoseconds>(std::min(ns, kMost)) * 1000;
}

}  // namespace hvp::guest
