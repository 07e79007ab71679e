#pragma once

#include <vector>

#include "models/collision/contact_search.h"
#include "models/stability/force_quality.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// What the run's force is like, in every run that computes one.
class ForceWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  ForceWatch(const collision::ContactSearch& contacts, std::size_t probes)
      : contacts_(contacts), qualities_(probes) {}

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // One a probe.
  const std::vector<stability::ForceQuality>& qualities() const { return qualities_; }

 private:
  const collision::ContactSearch& contacts_;
  std::vector<stability::ForceQuality> qualities_;
};

}  // namespace hvp::app
