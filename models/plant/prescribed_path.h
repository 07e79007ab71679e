#pragma once

#include "models/plant/device.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// A device whose user moves the tip along the trajectory whatever the force.
class PrescribedPath : public Device {
 public:
  explicit PrescribedPath(const Trajectory& trajectory) : trajectory_(trajectory) {}

 private:
  void advance(Picoseconds /*from*/, Picoseconds to, const Eigen::Vector3d& /*force*/) override {
    time_ = to;
  }
  TipState state() const override {
    const ProbeState probe = trajectory_.state_ps(time_);
    return {probe.position, probe.velocity};
  }

  Trajectory trajectory_;
  Picoseconds time_ = 0;
};

}  // namespace hvp::plant
