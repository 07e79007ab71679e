#pragma once

#include "vp/frame/critical_path.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

// Looks at frames without any simulated time: statistics, references, files, progress.
class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  // Set-up is over, the servo loop begins.
  virtual void begun() {}
  // The frame has its displacements and its force; the force is not out yet with a pipeline, and
  // spans may be still to come. In the order of their numbers.
  virtual void solved(const Frame& /*frame*/, const Solution& /*solution*/) {}
  // Nothing of the frame is under way any more. In the order of their numbers.
  virtual void closed(const Frame& /*frame*/, const CriticalPath& /*path*/) {}
};

}  // namespace hvp::vp
