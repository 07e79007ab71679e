#pragma once

#include <Eigen/Core>

#include "models/config/declaration.h"

namespace hvp::plant {

// The effect [device.encoder]: the position is read in steps, the nearest one of each axis. A
// device's data sheet states the step at the tip; that the same step holds all over the workspace
// and along x, y and z is a simplification.
struct Encoder {
  double resolution = 55e-6;  // m

  void declare(config::Visitor& v);
  // The position as it is read, m.
  Eigen::Vector3d read(const Eigen::Vector3d& position) const;
};

}  // namespace hvp::plant
