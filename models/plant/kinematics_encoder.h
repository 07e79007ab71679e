#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

namespace hvp::plant {

// A count as a counter of `bits` (1 to 32) holds it, in two's complement: modulo 2^bits.
std::int32_t wrapped(std::int64_t counts, int bits);

// Encoders on the motors' shafts, read by the board's counters: the step is one of each joint, and
// what it is at the tip differs over the workspace.
struct JointEncoder {
  std::int64_t counts_per_turn = 8192;     // of the motor, all edges counted
  Eigen::Vector3d gear{13.3, 11.2, 11.2};  // turns of the motor a turn of the joint
  int counter_bits = 24;

  void declare(config::Visitor& v);
  Eigen::Vector3d step() const;  // of each joint, rad
  // The tip as the host computes it from the counters, which are zero where the joints are, m.
  // Empty where the tip is out of reach. `wraps`: set where a counter has, else left.
  std::optional<Eigen::Vector3d> read(const Kinematics& kinematics, const Eigen::Vector3d& tip,
                                      bool& wraps) const;
};

}  // namespace hvp::plant
