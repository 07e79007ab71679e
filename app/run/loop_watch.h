#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "app/results/stiffness_budget.h"
#include "app/scene/scenario.h"
#include "models/plant/kinematics.h"
#include "models/plant/loop_quality.h"
#include "models/plant/wall_stability.h"
#include "vp/frame/observer.h"

namespace hvp::app {

// What the closed loop is like, in every run with devices that have mass.
class LoopWatch : public vp::FrameObserver {
 public:
  // Keeps the reference.
  explicit LoopWatch(const Scenario& scenario);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;

  // One a device.
  const std::vector<plant::LoopQuality>& qualities() const { return qualities_; }
  stability::Flags flags() const;
  // From the latch to the force at the motor, s: the mean of the frames in contact, of all where
  // none was.
  double mean_delay_s() const;
  std::optional<results::StiffnessBudget> stiffness() const;

 private:
  bool rests(std::size_t probe, Picoseconds time) const;

  const Scenario& scenario_;
  std::unique_ptr<plant::Kinematics> kinematics_;  // null without [device.kinematics]
  std::vector<plant::LoopQuality> qualities_;
  struct Delays {
    std::int64_t frames = 0;
    Picoseconds sum = 0;
    std::array<Picoseconds, vp::kParts * vp::kPhases> parts{};  // they sum to it

    void add(const vp::Frame& frame, const vp::CriticalPath& path);
  };
  const Delays& delays() const { return in_contact_.frames > 0 ? in_contact_ : all_; }

  Delays all_;
  Delays in_contact_;
};

// The device of a probe in front of a wall with the scenario's damping, along `direction` (of any
// length but zero), as the exact eigenvalues want it. None where that is no axis of the device and
// its masses differ: its axes then move by each other.
std::optional<plant::WallLoop> wall_loop(const Scenario& scenario, double delay_s,
                                         const Eigen::Vector3d& direction);

}  // namespace hvp::app
