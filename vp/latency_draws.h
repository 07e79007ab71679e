#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "models/random/distribution.h"
#include "models/time/picoseconds.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

// The times that an effect draws for each frame, in order. Frames may overlap. Set-up and recovery
// belong to no frame and draw nothing.
class LatencyDraws {
 public:
  LatencyDraws(const random::TimeDistribution& distribution, std::int64_t seed,
               std::string_view effect)
      : source_(distribution, seed, effect) {}

  // Returns the number of the frame's next draw and takes `count` draws.
  std::uint32_t take(std::int64_t frame, std::int64_t count = 1) {
    Drawn& drawn = of(frame);
    const std::uint32_t first = drawn.count;
    drawn.count += static_cast<std::uint32_t>(count);
    return first;
  }
  // A frame has 2^16 draws; after these they repeat.
  Picoseconds ps(std::int64_t frame, std::uint32_t draw) const {
    return to_picoseconds(source_.time_s(frame, draw & 0xFFFFU));
  }
  Picoseconds next(std::int64_t frame) { return ps(frame, take(frame)); }

 private:
  // The number of draws of each of the latest frames. A new frame takes the oldest one's place.
  struct Drawn {
    std::int64_t frame = -1;
    std::uint32_t count = 0;
  };
  Drawn& of(std::int64_t frame) {
    Drawn& drawn = latest_[static_cast<std::size_t>(frame) % latest_.size()];
    if (drawn.frame != frame) drawn = {frame, 0};
    return drawn;
  }

  random::Source source_;
  std::array<Drawn, 4> latest_;
};

}  // namespace hvp::vp
