#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/results/contact.h"
#include "app/results/loop.h"
#include "app/scene/scenario.h"
#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/fem/strain.h"
#include "models/plant/kinematics.h"
#include "models/plant/loop_quality.h"
#include "models/plant/wall_stability.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"
#include "vp/frame/ledger.h"

// Observers of frames that collect a run's figures. Each keeps the reference that it is given.

namespace hvp::app {

// Counts the frames in contact with the body or the wall.
class ContactWatch : public vp::FrameObserver {
 public:
  void solved(const vp::Frame& frame, const vp::Solution& /*solution*/) override {
    ++figures_.frames;
    if (frame.in_contact()) ++figures_.frames_in_contact;
  }
  // The figures from frames; those that only the processes count are zero.
  virtual results::ContactFigures figures() const { return figures_; }
  virtual stability::Flags flags() const { return {}; }

 protected:
  results::ContactFigures figures_;
};

// Finds also how near the probe came to a body before the first contact, and how deep it was in the
// body without contact.
class ApproachWatch : public ContactWatch {
 public:
  explicit ApproachWatch(const collision::ContactSearch& contacts);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  results::ContactFigures figures() const override;
  // The flag contact_missed, or none.
  stability::Flags flags() const override;

 private:
  // The deepest place without contact, where it is deeper than a late collision pass explains.
  std::optional<results::Approach> missed() const;

  const collision::ContactSearch& contacts_;
  double allowed_;  // m
  bool touched_ = false;
  std::optional<results::Approach> deepest_;
};

// The quality of the force, in every run that computes one.
class ForceWatch : public vp::FrameObserver {
 public:
  ForceWatch(const collision::ContactSearch& contacts, std::size_t probes)
      : contacts_(contacts), qualities_(probes) {}

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // One a probe.
  const std::vector<stability::ForceQuality>& qualities() const { return qualities_; }

 private:
  const collision::ContactSearch& contacts_;
  std::vector<stability::ForceQuality> qualities_;
};

// The body's largest strain, examined every kEveryFrames frames: a body that follows a hand hardly
// changes within them.
class StrainWatch : public vp::FrameObserver {
 public:
  static constexpr std::int64_t kEveryFrames = 20;
  explicit StrainWatch(const fem::Body& body);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // The strains of the frame with the largest one, and the most inverted elements of any frame.
  const fem::Strains& worst() const { return worst_; }
  std::int64_t worst_frame() const { return worst_frame_; }
  stability::Flags flags() const;

 private:
  const fem::Body& body_;
  fem::StrainMeter meter_;
  std::vector<double> displacement_;  // all mesh nodes'
  fem::Strains worst_;
  std::int64_t worst_frame_ = -1;
};

// The quality of the closed loop, in every run with devices that have mass.
class LoopWatch : public vp::FrameObserver {
 public:
  explicit LoopWatch(const Scenario& scenario);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;

  // One a device.
  const std::vector<plant::LoopQuality>& qualities() const { return qualities_; }
  stability::Flags flags() const;
  // The time from the latch to the force at the motor, s: the mean of the frames in contact, or of
  // all frames where none was in contact.
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
    std::array<Picoseconds, vp::kParts * vp::kPhases> parts{};  // the addends of `sum`

    void add(const vp::Frame& frame, const vp::CriticalPath& path);
  };
  const Delays& delays() const { return in_contact_.frames > 0 ? in_contact_ : all_; }

  Delays all_;
  Delays in_contact_;
};

// The loop of a probe's device and a wall with the scenario's damping, along `direction` (of any
// length but zero), for the computation of exact eigenvalues. Absent where `direction` is no axis
// of the device and its masses differ: its axes are then coupled.
std::optional<plant::WallLoop> wall_loop(const Scenario& scenario, double delay_s,
                                         const Eigen::Vector3d& direction);

}  // namespace hvp::app
