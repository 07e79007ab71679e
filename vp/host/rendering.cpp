#include "vp/host/rendering.h"

namespace hvp::vp {

// The force is the frame's own already; with a pipeline it goes out in the next period.
void WallRendering::begin(FrameStep& step) {
  for (std::size_t i = 0; i < before_.size(); ++i) {
    collision::Touch& touch = step.frame->touches[i];
    const double depth = wall_.depth(touch.tip);
    const bool touches = depth > 0 || wall_.sides == host::Wall::Sides::both;
    // The wall has no nodes but this one.
    touch.contact.node = touches ? 0 : -1;
    touch.force = -wall_.force(depth, before_[i].value_or(depth), period_s_);
    before_[i] = depth;
  }
}

}  // namespace hvp::vp
