#include "app/remedy/recorder.h"

#include <algorithm>

namespace hvp::app {

Recorder::Recorder(std::int64_t frames) {
  sightings_.reserve(std::min(kMostFrames, static_cast<std::size_t>(frames)));
}

void Recorder::solved(const vp::Frame& frame, const vp::Solution& /*solution*/) {
  touched_ = touched_ || frame.in_contact();
  if (!touched_ && sightings_.size() == 2) {
    sightings_[0] = sightings_[1];
    sightings_.pop_back();
  }
  if (sightings_.size() == kMostFrames) return;
  sightings_.push_back({frame.time, frame.touches});
}

}  // namespace hvp::app
