#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/plant/energy.h"
#include "models/time/picoseconds.h"

namespace hvp::plant {

// The state of a device's tip.
struct TipState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
};

// The work of commanded forces, J, as if each had acted at once: Σ F·(p' − p) with p the tip's
// place when a command began to act and p' when the next one did.
struct CommandWork {
  double of_command = 0;  // by the forces that the motors were commanded
  double of_host = 0;     // by the forces that the host had asked for
};

// The mechanical state of a device. Forces and energy are 0 where it has no mass.
struct PlantState {
  TipState tip;
  // What the hand holds, beyond the device's structure; the tip without one.
  TipState handle{};
  Eigen::Vector3d motor_force = Eigen::Vector3d::Zero();  // N, the real one, after any lag
  Eigen::Vector3d hand_force = Eigen::Vector3d::Zero();   // N, on the device
  Energy energy{};
  CommandWork works{};
};

// A haptic device: it has the position of its tip at a time, and is driven by its motors with a
// force from a time on. It has no clock: the caller brings it forward, through every change of the
// force, so that an implementation is exact between those. Times count from the beginning of the
// servo loop; before that the device rests at its start.
//
// An implementation moves the tip under a constant force (advance) and returns its state (state).
// This class sees to the order of times and of changes.
class Device {
 public:
  virtual ~Device() = default;

  // The tip at a time. Throws std::logic_error for a time before that of the last call.
  TipState at(Picoseconds time);
  // From `from` on the motors exert `force` on the tip (N). That time may lie ahead of the last
  // at(), because a converter takes time. Throws std::logic_error where it lies before the last
  // at() or the last drive(). `of_host` is the force that the host had asked for, of which
  // converter and limits left `force`.
  void drive(Picoseconds from, const Eigen::Vector3d& force, const Eigen::Vector3d& of_host);
  void drive(Picoseconds from, const Eigen::Vector3d& force) { drive(from, force, force); }
  // True where forces move the device.
  virtual bool has_mass() const { return false; }
  // The state at the last at(). The call changes nothing.
  PlantState plant() const;

 private:
  // Moves the tip from one time to a later one; the force is constant in between.
  virtual void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) = 0;
  // The tip after the last advance().
  virtual TipState state() const = 0;
  virtual PlantState mechanics() const { return {.tip = state(), .handle = state()}; }

  struct Change {
    Picoseconds from;
    Eigen::Vector3d force;
    Eigen::Vector3d of_host;
  };
  void advance_to(Picoseconds time);
  CommandWork works_until(const Eigen::Vector3d& place) const;

  Picoseconds reached_ = 0;
  Picoseconds asked_;  // time of the last at()
  Picoseconds driven_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d of_host_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d began_at_ = Eigen::Vector3d::Zero();  // place of the tip when force_ began to act
  CommandWork works_;                                   // work until then
  std::vector<Change> ahead_;                           // in the order of time

 protected:
  Device();
};

}  // namespace hvp::plant
