#pragma once

#include "models/collision/contact_search.h"
#include "models/stability/force_quality.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// What the run's force is like, in every run that computes one.
class ForceWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  explicit ForceWatch(const collision::ContactSearch& contacts) : contacts_(contacts) {}

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  const stability::ForceQuality& quality() const { return quality_; }

 private:
  const collision::ContactSearch& contacts_;
  stability::ForceQuality quality_;
};

}  // namespace hvp::app
