#pragma once

#include <cstdint>
#include <optional>

#include "models/collision/contact_search.h"
#include "vp/host/servo_process.h"

namespace hvp::app {

// How near the probe came to a body that it has not touched yet.
class ApproachWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  explicit ApproachWatch(const collision::ContactSearch& contacts) : contacts_(contacts) {}

  void solved(const vp::SolvedFrame& frame) override;

  // Distance of the tip from the surface, m, negative inside; where the tip was.
  struct Nearest {
    double distance = 0;
    std::int64_t frame = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  };
  // None once the probe has touched the body.
  const std::optional<Nearest>& nearest() const { return nearest_; }

 private:
  const collision::ContactSearch& contacts_;
  bool touched_ = false;
  std::optional<Nearest> nearest_;
};

}  // namespace hvp::app
