#pragma once

#include <optional>

#include "app/results/contact_figures.h"
#include "models/collision/contact_search.h"
#include "models/stability/flag.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// How near the probe came to a body that it has not touched yet, and how deep in it was while
// nothing was held.
class ApproachWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  explicit ApproachWatch(const collision::ContactSearch& contacts);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // What frames tell; what only the processes count is left at zero.
  results::ContactFigures figures() const;
  // contact_missed.
  stability::Flags flags() const;

 private:
  // The deepest place without contact, where it is deeper than a late pass explains.
  std::optional<results::Approach> missed() const;

  const collision::ContactSearch& contacts_;
  double allowed_;  // m
  bool touched_ = false;
  results::ContactFigures figures_;
  std::optional<results::Approach> deepest_;
};

}  // namespace hvp::app
