#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/plant/energy.h"
#include "models/time/picoseconds.h"

namespace hvp::plant {

// Of a device's tip.
struct TipState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
};

// What commanded forces did, J, as if each had been there at once: Σ F·(p' − p) with p the tip's
// place when a command began to act and p' when the next one did.
struct CommandWork {
  double of_command = 0;  // what the motors were told
  double of_host = 0;     // what the host had asked for
};

// What a device is and does besides: forces and energy are 0 where it has no mass.
struct PlantState {
  TipState tip;
  Eigen::Vector3d motor_force = Eigen::Vector3d::Zero();  // N, the real one, after any lag
  Eigen::Vector3d hand_force = Eigen::Vector3d::Zero();   // N, on the device
  Energy energy{};
  CommandWork works{};
};

// A haptic device: where its tip is at a time, driven by its motors with a force from a time on. It
// has no clock: whoever asks brings it forward, through every change of the force, so that an
// implementation is exact between those. Times count from when the servo loop begins; before that
// the device rests where it starts.
//
// An implementation says how the tip moves while the force is constant (advance) and where it then
// is (state); order and changes are seen to here.
class Device {
 public:
  virtual ~Device() = default;

  // Throws std::logic_error for a time before the last at()'s.
  TipState at(Picoseconds time);
  // The motors exert `force` on the tip (N) from `from` on. That may lie ahead of what at() has
  // been asked: a converter takes its time. Throws std::logic_error where it lies before the last
  // at() or the last drive(). `of_host`: what the host had asked for, of which converter and limits
  // left `force`.
  void drive(Picoseconds from, const Eigen::Vector3d& force, const Eigen::Vector3d& of_host);
  void drive(Picoseconds from, const Eigen::Vector3d& force) { drive(from, force, force); }
  // Whether forces move it.
  virtual bool has_mass() const { return false; }
  // At the last at(). To ask changes nothing.
  PlantState plant() const;

 private:
  // Brings the tip from one time to a later one; the force is constant in between.
  virtual void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) = 0;
  // Where advance() has left it.
  virtual TipState state() const = 0;
  virtual PlantState mechanics() const { return {.tip = state()}; }

  struct Change {
    Picoseconds from;
    Eigen::Vector3d force;
    Eigen::Vector3d of_host;
  };
  void advance_to(Picoseconds time);
  CommandWork works_until(const Eigen::Vector3d& place) const;

  Picoseconds reached_ = 0;
  Picoseconds asked_;  // the last at()
  Picoseconds driven_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d of_host_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d began_at_ = Eigen::Vector3d::Zero();  // the tip's place when force_ began to act
  CommandWork works_;                                   // until then
  std::vector<Change> ahead_;                           // in the order of time

 protected:
  Device();
};

}  // namespace hvp::plant
