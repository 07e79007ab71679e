#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/joint_inertia.h"
#include "models/plant/linear_axis.h"
#include "models/plant/linkages.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// The effect [device.friction]: dry friction (Coulomb's) along each axis by itself. A device that
// slips is opposed by `force_N`; one that stands sticks until the other forces on it are larger
// than hold(). Friction along each axis is a simplification: a real drive's is in its joints.
struct Friction {
  double force_N = 0.26;
  double static_force_N = 0;  // 0: as large as force_N

  double hold() const { return static_force_N > 0 ? static_force_N : force_N; }

  void declare(config::Visitor& v);
  // Throws InputError where stiction is smaller than the friction of slipping.
  void check() const;
};

// The effect [hand]: a spring and a damper between the intended motion, [probe], and a mass, and a
// grip between that and the device (LinearAxis). It is the same along each axis.
struct Hand {
  enum class Model { spring_damper, arm, custom };

  double mass_kg = 0;
  double stiffness_N_m = 375;
  double damping_N_s_m = 4.5;
  double grip_stiffness_N_m = 0;  // 0: rigid
  double grip_damping_N_s_m = 0;
  double lets_go_s = 0;  // the time at which the hand lets go; 0: never
  Model model = Model::spring_damper;

  // The values of a named model; for `custom` those of the default.
  static Hand of(Model model);

  void declare(config::Visitor& v);
  // Throws InputError where the grip has no hand's mass behind it, or only damps.
  void check() const;

  // Sets the hand's members of an axis.
  void hold(LinearAxis& axis) const;
};

// The effect [device.dynamics]: the device is a mass that its motors and the hand move. The mass is
// the same in every pose, or follows the pose, where the inertia is the joints'.
struct DeviceDynamics {
  enum class At { tip, joints };

  double mass_kg = 0.1;
  double damping_N_s_m = 1;
  Eigen::Vector3d mass_factor = Eigen::Vector3d::Ones();  // along x, y and z, of mass_kg
  At at = At::tip;
  JointInertia joints{};

  void declare(config::Visitor& v);
};

// The effect [device.structure]: the device's first structural mode along each axis, between the
// part that motors drive and encoders read, which every result calls the tip, and the handle, which
// the hand holds (Diaz & Gil 2010).
struct Structure {
  double frequency_Hz = 100;
  double damping_ratio = 0.05;
  double handle_share = 0.5;

  void declare(config::Visitor& v);
  // Divides the mass of an axis. With both masses free they swing at that frequency against each
  // other, without damping: k_s = m·m₂/(m + m₂)·ω², and b_s is that share of the critical damping.
  void divide(LinearAxis& axis) const;
};

// The effect [device.gravity]: the apparent mass has weight; of a device whose inertia is the
// joints', the mass at its tip.
struct Gravity {
  Eigen::Vector3d acceleration = {0, 0, -9.80665};  // m/s²
  double compensated = 0;                           // the compensated share of the weight

  void declare(config::Visitor& v);
};

// A device with mass and the hand that grips it.
struct Plant {
  DeviceDynamics dynamics{};
  std::optional<Hand> hand{};
  std::optional<Friction> friction{};
  std::optional<Gravity> gravity{};
  std::optional<KinematicsSettings> kinematics{};  // of DeviceDynamics::At::joints; else unused
  std::optional<Structure> structure{};
  double force_lag_rate = 0;  // 1/s; 0: no lag
  Trajectory intended{};

  // For programs that study the device by itself: the distance of its tip at time 0 from the start
  // of the intended motion (a hand's mass on a soft grip begins at that start, and nothing moves),
  // and a force that pushes it, or its handle, all the time.
  Eigen::Vector3d displaced = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d push = Eigen::Vector3d::Zero();       // N

  // The device's kinematics where its mass follows the pose; null where it does not.
  std::unique_ptr<Kinematics> pose_of_mass() const;
  // The apparent mass along each axis at the start of the intended motion, kg. Throws InputError
  // where it follows the pose and that is a singular one.
  Eigen::Vector3d masses() const;
  // Axis i (0 to 2) with that mass, gripped by the hand where there is one.
  LinearAxis axis(int i) const;
  // The weight of the device, N; a hand carries its own.
  Eigen::Vector3d weight() const;
};

}  // namespace hvp::plant
