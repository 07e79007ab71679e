#pragma once

#include <array>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/device.h"
#include "models/plant/linear_axis.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// The effect [device.dynamics]: the device is a mass that its motors and the hand move.
struct DeviceDynamics {
  double mass_kg = 0.1;
  double damping_N_s_m = 1;

  void declare(config::Visitor& v);
};

// The effect [hand]: a mass on a spring and a damper whose other end follows the intended motion,
// [probe].
struct Hand {
  double mass_kg = 0;
  double stiffness_N_m = 375;
  double damping_N_s_m = 4.5;

  void declare(config::Visitor& v);
};

// A device with mass, free or in a hand, each axis by itself:
//
//   (m + m_h)·x″ + b·x′ + b_h·(x′ − x_i′) + k_h·(x − x_i) = F
//
// F: the motors' force, constant between its changes; x_i: the intended motion, a polynomial within
// a stroke. So the motion is exact to rounding, and how often it is asked for changes no bit: it is
// carried on from changes of the force, from ends of strokes and from whole milliseconds only.
class MovingDevice final : public Device {
 public:
  MovingDevice(const DeviceDynamics& dynamics, const std::optional<Hand>& hand,
               const Trajectory& intended);

 private:
  struct Anchor {
    Picoseconds time = 0;
    Picoseconds until = 0;  // the intended motion is one polynomial until then
    std::array<LinearAxis::State, 3> state{};
    std::array<LinearAxis::Drive, 3> drive{};
  };

  void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) override;
  TipState state() const override;

  void move_anchor(Picoseconds time, const Eigen::Vector3d& force);
  std::array<LinearAxis::State, 3> moved_to(Picoseconds time) const;

  LinearAxis axis_;
  bool held_;
  Trajectory intended_;
  Anchor anchor_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Picoseconds reached_ = 0;
};

}  // namespace hvp::plant
