#pragma once

#include <optional>

#include "app/results/contact_figures.h"
#include "models/collision/contact_search.h"
#include "models/stability/flag.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// How often the probe touches what it is to touch.
class ContactWatch : public vp::FrameObserver {
 public:
  void solved(const vp::Frame& frame, const vp::Solution& /*solution*/) override {
    ++figures_.frames;
    if (frame.in_contact()) ++figures_.frames_in_contact;
  }
  // What frames tell; what only the processes count is left at zero.
  virtual results::ContactFigures figures() const { return figures_; }
  virtual stability::Flags flags() const { return {}; }

 protected:
  results::ContactFigures figures_;
};

// And how near it came to a body that it has not touched yet, and how deep in it was while nothing
// was held.
class ApproachWatch : public ContactWatch {
 public:
  // Keeps the reference.
  explicit ApproachWatch(const collision::ContactSearch& contacts);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  results::ContactFigures figures() const override;
  // contact_missed.
  stability::Flags flags() const override;

 private:
  // The deepest place without contact, where it is deeper than a late pass explains.
  std::optional<results::Approach> missed() const;

  const collision::ContactSearch& contacts_;
  double allowed_;  // m
  bool touched_ = false;
  std::optional<results::Approach> deepest_;
};

}  // namespace hvp::app
