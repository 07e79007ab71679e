#pragma once

#include <array>

#include "models/plant/axis_motion.h"
#include "models/plant/device.h"
#include "models/plant/plant.h"

namespace hvp::plant {

// A device with mass, free or in a hand, each axis by itself (LinearAxis, AxisMotion).
//
// Its motors' commands are constant between their changes, and the intended motion is a polynomial
// within a stroke, so the motion is exact to rounding. How often it is asked for changes no bit: it
// is carried on from changes of the force, ends of strokes, the hand's letting go and whole
// milliseconds only, and from where friction changes in between, found when it is carried on.
class MovingDevice final : public Device {
 public:
  // Throws InputError: a motion too fast to be followed.
  explicit MovingDevice(const Plant& plant);

  bool has_mass() const override { return true; }

 private:
  struct Anchor {
    Picoseconds time = 0;
    Picoseconds until = 0;  // the motion from `time` on is known until then
    std::array<AxisMotion, 3> axes;
    Energy energy;  // until `time`
  };

  void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) override;
  TipState state() const override;
  PlantState mechanics() const override;

  void move_anchor(Picoseconds time);
  void let_go(std::array<LinearAxis::State, 3>& states);
  // Finds the motion from the anchor's time on.
  void carry_on(const std::array<LinearAxis::State, 3>& states);
  double since_anchor(Picoseconds time) const { return to_seconds(time - anchor_.time); }
  // Of all axes: what has flowed until a time and the states then, without what is stored.
  Energy flowed(Picoseconds time, const std::array<LinearAxis::State, 3>& then) const;
  std::array<LinearAxis::State, 3> states(Picoseconds time) const;
  // What axis i has stored in that state.
  Energy stored(std::size_t i, const LinearAxis::State& state,
                const LinearAxis::Drive& drive) const;

  std::array<LinearAxis, 3> axes_;
  std::optional<Friction> friction_;
  Eigen::Vector3d weight_;  // N
  Eigen::Vector3d push_;    // N
  Trajectory intended_;
  Picoseconds stroke_begins_ = 0;
  Trajectory::Piece stroke_{};  // of the intended motion, from there on
  Picoseconds lets_go_;         // the hand; the largest number where it never does
  bool held_;
  Anchor anchor_;
  Eigen::Vector3d command_ = Eigen::Vector3d::Zero();
  Picoseconds reached_ = 0;
};

}  // namespace hvp::plant
