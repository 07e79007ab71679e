#pragma once

#include <cstdint>
#include <optional>

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

  // Distance of the tip from the surface as the collision process last had it, m, negative inside;
  // where the tip was.
  struct Nearest {
    double distance = 0;
    std::int64_t frame = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  };
  // None once the probe has touched the body.
  const std::optional<Nearest>& nearest() const { return nearest_; }
  // The deepest place without contact, where it is deeper than a late pass explains.
  std::optional<Nearest> missed() const;
  // contact_missed.
  stability::Flags flags() const;

 private:
  const collision::ContactSearch& contacts_;
  double allowed_;  // m
  bool touched_ = false;
  std::optional<Nearest> nearest_;
  std::optional<Nearest> deepest_;
};

}  // namespace hvp::app
