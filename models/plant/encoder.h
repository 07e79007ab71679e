#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

namespace hvp::plant {

// A count in a counter of `bits` (1 to 32), in two's complement: modulo 2^bits.
std::int32_t wrapped(std::int64_t counts, int bits);

// Encoders on the motors' shafts, read by the board's counters. Each joint has one step, and the
// step at the tip differs over the workspace.
struct JointEncoder {
  std::int64_t counts_per_turn = 8192;     // of the motor, all edges counted
  Eigen::Vector3d gear{13.3, 11.2, 11.2};  // turns of the motor a turn of the joint
  int counter_bits = 24;

  void declare(config::Visitor& v);
  Eigen::Vector3d step() const;  // the step of each joint, rad
  // The tip as the host computes it from the counters, which are zero where the joints are, m.
  // Empty where the tip is out of reach. `wraps` is set where a counter has wrapped, and else left
  // unchanged.
  std::optional<Eigen::Vector3d> read(const Kinematics& kinematics, const Eigen::Vector3d& tip,
                                      bool& wraps) const;
};

// The effect [device.encoder]: the position is read in steps. A data sheet states the step at the
// tip; the same step all over the workspace and along x, y and z is a simplification. Encoders at
// the joints of a device whose kinematics are known are finer in some places and coarser in others.
struct Encoder {
  enum class At { tip, joints };

  At at = At::tip;
  double resolution = 55e-6;  // m
  JointEncoder joints;

  void declare(config::Visitor& v);

  struct Reading {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    // The tip is out of the joints' reach, or a counter has wrapped: the position is not the tip's.
    bool wrong = false;
  };
  // `kinematics`: not null for encoders at the joints.
  Reading read(const Eigen::Vector3d& position, const Kinematics* kinematics = nullptr) const;
};

}  // namespace hvp::plant
