#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/friction.h"
#include "models/plant/hand.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// The effect [device.dynamics]: the device is a mass that its motors and the hand move.
struct DeviceDynamics {
  double mass_kg = 0.1;
  double damping_N_s_m = 1;
  Eigen::Vector3d mass_factor = Eigen::Vector3d::Ones();  // along x, y and z, of mass_kg

  void declare(config::Visitor& v);
};

// The effect [device.gravity]: the apparent mass has weight.
struct Gravity {
  Eigen::Vector3d acceleration = {0, 0, -9.80665};  // m/s²
  double compensated = 0;                           // share of the weight

  void declare(config::Visitor& v);
};

// A device with mass and who holds it.
struct Plant {
  DeviceDynamics dynamics{};
  std::optional<Hand> hand{};
  std::optional<Friction> friction{};
  std::optional<Gravity> gravity{};
  double force_lag_rate = 0;  // 1/s; 0: a force is there at once
  Trajectory intended{};

  // For programs that study the device by itself: at time 0 its tip is this far from where the
  // intended motion starts (a hand's mass on a soft grip is not, and nothing moves), and this
  // force pushes it all the time.
  Eigen::Vector3d displaced = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d push = Eigen::Vector3d::Zero();       // N

  // Of an axis (0 to 2), held by the hand where there is one.
  LinearAxis axis(int i) const;
  // N; of the device, not of the hand, which holds its own.
  Eigen::Vector3d weight() const;
};

}  // namespace hvp::plant
