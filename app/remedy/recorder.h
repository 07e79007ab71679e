#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/collision/contact.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// Where the probes were in a frame, and what they held.
struct Sighting {
  Picoseconds time = 0;  // of the frame's birth
  std::vector<collision::Touch> touches;

  const collision::Touch& touch() const { return touches.front(); }
};

// What happened to the body in a run's first frames of contact, so that they can be solved again
// another way. Before there is contact the last two frames are kept, which the hand-over asks for.
class Recorder : public vp::FrameObserver {
 public:
  static constexpr std::size_t kMostFrames = 4096;

  explicit Recorder(std::int64_t frames);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  const std::vector<Sighting>& sightings() const { return sightings_; }

 private:
  std::vector<Sighting> sightings_;
  bool touched_ = false;
};

}  // namespace hvp::app
