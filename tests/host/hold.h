#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/host/frame_computation.h"

namespace hvp::host::test {

// All nodes of the contact at one displacement; to the letter of thesis §3.7 where no time is
// given.
inline void hold(FrameComputation& computation, const Eigen::Vector3d& u_c, double elapsed_s = 0) {
  const std::vector<Eigen::Vector3d> displacement(computation.contact().size(), u_c);
  computation.hold({computation.contact(), displacement, {}, elapsed_s});
}

}  // namespace hvp::host::test
