#pragma once

#include <optional>

#include "app/results/contact_figures.h"
#include "models/collision/contact_search.h"
#include "models/stability/flag.h"
#include "vp/host/servo_process.h"

namespace hvp::app {

// How near the probe came to a body that it has not touched yet, and how deep in it was while
// nothing was held.
class ApproachWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  explicit ApproachWatch(const collision::ContactSearch& contacts);

  void solved(const vp::SolvedFrame& frame) override;

  // None once the probe has touched the body.
  const std::optional<results::Approach>& nearest() const { return nearest_; }
  // The deepest place without contact, where it is deeper than a late pass explains.
  std::optional<results::Approach> missed() const;
  // contact_missed.
  stability::Flags flags() const;

 private:
  const collision::ContactSearch& contacts_;
  double allowed_;  // m
  bool touched_ = false;
  std::optional<results::Approach> nearest_;
  std::optional<results::Approach> deepest_;
};

}  // namespace hvp::app
