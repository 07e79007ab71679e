#pragma once

#include <array>
#include <memory>

#include "models/plant/axis_motion.h"
#include "models/plant/device.h"
#include "models/plant/plant.h"
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

// A device with mass, free or in a hand, with each axis by itself (LinearAxis, AxisMotion).
//
// The motors' commands are constant between their changes, and the intended motion is a polynomial
// within a stroke, so that the motion is exact to rounding. The times of queries change no bit of
// it: the motion is carried on only from changes of the force, ends of strokes, the hand's letting
// go and whole milliseconds, and from changes of friction in between, which are found then.
//
// A mass that follows the pose is taken from it at whole milliseconds and held in between. There
// the velocity changes so that the kinetic energy does not: that is the part −½·m′·v of the
// Coriolis forces, which along one axis is all of them. At a singular pose the last mass stays.
class MovingDevice final : public Device {
 public:
  // Throws InputError: a motion too fast to be followed.
  explicit MovingDevice(const Plant& plant);

  bool has_mass() const override { return true; }

 private:
  struct Anchor {
    Picoseconds time = 0;
    Picoseconds until = 0;  // end of the known motion from `time` on
    std::array<AxisMotion, 3> axes;
    Energy energy;  // until `time`
  };

  void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) override;
  TipState state() const override;
  PlantState mechanics() const override;

  // The force that weight and push exert on the handle along axis i, N; 0 without a structure.
  double on_handle(std::size_t i) const;
  void move_anchor(Picoseconds time);
  void let_go(std::array<LinearAxis::State, 3>& states);
  // Takes the masses from the pose.
  void follow_pose(std::array<LinearAxis::State, 3>& states);
  // Finds the motion from the anchor's time on.
  void carry_on(const std::array<LinearAxis::State, 3>& states);
  double since_anchor(Picoseconds time) const { return to_seconds(time - anchor_.time); }
  // The energy that has flowed in all axes until a time, without stored energy; `then` is the
  // states at that time.
  Energy flowed(Picoseconds time, const std::array<LinearAxis::State, 3>& then) const;
  std::array<LinearAxis::State, 3> states(Picoseconds time) const;
  // The energy stored in axis i in that state.
  Energy stored(std::size_t i, const LinearAxis::State& state,
                const LinearAxis::Drive& drive) const;

  std::array<LinearAxis, 3> axes_;
  std::optional<Friction> friction_;
  Eigen::Vector3d weight_;            // N
  Eigen::Vector3d push_;              // N
  double handle_share_;               // of mass and weight; 0 without a structure
  std::unique_ptr<Kinematics> pose_;  // null where the mass is the same in every pose
  JointInertia joints_;
  Trajectory intended_;
  Picoseconds stroke_begins_ = 0;
  Trajectory::Piece stroke_{};  // the intended motion's, from there on
  Picoseconds lets_go_;         // when the hand lets go; the largest number where it never does
  bool held_;
  Anchor anchor_;
  Eigen::Vector3d command_ = Eigen::Vector3d::Zero();
  Picoseconds reached_ = 0;
};

}  // namespace hvp::plant
