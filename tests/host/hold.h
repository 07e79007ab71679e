#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/host/frame_computation.h"

namespace hvp::host::test {

// All nodes of the contact at one displacement; to the letter of thesis §3.7 where no time is
// given.
inline void hold(FrameComputation& computation, const Eigen::Vector3d& u_c, double elapsed_s = 0) {
  const std::vector<Eigen::Vector3d> displacement(computation.contact().size(), u_c);
  computation.hold({computation.contact(), displacement, {}, elapsed_s});
}

// The frame's right-hand side in words. Returns how many were clamped.
inline std::int64_t form_rhs(FrameComputation& computation, std::span<std::int32_t> b) {
  computation.begin();
  computation.method().next(b);
  return computation.method().clamped();
}

// The board's answer to it.
inline void accept(FrameComputation& computation, std::span<const std::int32_t> x) {
  computation.method().accept(x, {});
}

}  // namespace hvp::host::test
