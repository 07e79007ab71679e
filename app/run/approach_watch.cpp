#include "app/run/approach_watch.h"

namespace hvp::app {

void ApproachWatch::solved(const vp::SolvedFrame& frame) {
  if (touched_) return;
  if (frame.contact.node >= 0) {
    touched_ = true;
    nearest_.reset();
    return;
  }
  const double distance = contacts_.surface().signed_distance(frame.tip);
  if (!nearest_ || distance < nearest_->distance) nearest_ = {distance, frame.number, frame.tip};
}

}  // namespace hvp::app
