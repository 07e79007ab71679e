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
#include "models/tissue/model.h"
#include "vp/frame/ledger.h"

// Observers of frames that collect a run's figures. Each keeps the reference that it is given.

namespace hvp::app {

// Counts the frames in contact with the body or the wall.
class ContactWatch : public vp::FrameObserver {
 public:
  // A wall that also pulls has a force wherever a probe begins.
  explicit ContactWatch(bool pulls = false) : pulls_(pulls) {}

  void solved(const vp::Frame& frame, const vp::Solution& /*solution*/) override {
    ++figures_.frames;
    if (frame.in_contact()) ++figures_.frames_in_contact;
    for (const collision::Touch& touch : frame.touches) figures_.proxy.add(touch, frame.number);
    if (frame.number == 0 && !pulls_) begins_pressed_ = begins_pressed(frame);
  }
  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  // The first frame with the flag no_start; −1: none.
  std::int64_t first_without_start() const { return first_without_start_; }
  // The figures from frames; those that only the processes count are zero.
  virtual results::ContactFigures figures() const { return figures_; }
  // The flag force_step where the first frame has a force, which nothing had before.
  virtual stability::Flags flags() const;

  // True if any probe is pressed upon in the frame.
  static bool begins_pressed(const vp::Frame& frame);

 protected:
  results::ContactFigures figures_;

 private:
  bool pulls_;
  bool begins_pressed_ = false;
  std::int64_t first_without_start_ = -1;
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
  // `at_rest` is the surface where contact glides; null where it is a node's.
  ForceWatch(const collision::ContactSearch& contacts, const collision::DeformedSurface* at_rest,
             std::size_t probes)
      : contacts_(contacts), at_rest_(at_rest), qualities_(probes) {}

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // One a probe.
  const std::vector<stability::ForceQuality>& qualities() const { return qualities_; }

 private:
  const collision::ContactSearch& contacts_;
  const collision::DeformedSurface* at_rest_;
  std::vector<stability::ForceQuality> qualities_;
};

// The body's largest strain, over all frames: a tap is over in a few of them.
class StrainWatch : public vp::FrameObserver {
 public:
  // `model` is the run's law, absent: linear. Strains beyond what it assumes are flagged.
  StrainWatch(const fem::Body& body, const std::optional<tissue::Model>& model);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  // The strains of the frame with the largest one, and the most inverted elements of any frame.
  const fem::Strains& worst() const { return worst_; }
  std::int64_t worst_frame() const { return worst_frame_; }
  stability::Flags flags() const;

 private:
  const fem::Body& body_;
  std::optional<tissue::LawKind> law_;  // absent: springs
  fem::StrainMeter meter_;
  std::vector<double> solution_;      // of the last frame, whose strains are known
  std::vector<double> displacement_;  // all mesh nodes'
  fem::Strains worst_;
  std::int64_t worst_frame_ = -1;
};

// The quality of the closed loop, in every run with devices that have mass.
class LoopWatch : public vp::FrameObserver {
 public:
  explicit LoopWatch(const Scenario& scenario);

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;

  // One a device; empty of one without mass.
  const std::vector<plant::LoopQuality>& qualities() const { return qualities_; }
  stability::Flags flags() const;
  // The time from the latch to the force at the motor, s: the mean of the frames in contact in
  // which a force changes, or of all frames where there are none. A frame in which nothing moves
  // may have nothing to solve; its short delay makes no moving loop any stiffer.
  double mean_delay_s() const;
  // Of each device with mass, in their order: one where no probe has its own, for they are alike
  // then. `contact_N_m` is the stiffness of the wall or of the body at its contact, where it is
  // known. Empty where a budget is not computed.
  std::vector<results::StiffnessBudget> stiffnesses(std::optional<double> contact_N_m) const;

 private:
  bool rests(std::size_t probe, Picoseconds time) const;
  bool force_changed(const vp::Frame& frame);
  // The device's axis without the hand, where that lets go during the run.
  std::optional<plant::LinearAxis> axis_without_hand(std::size_t probe) const;
  std::optional<results::StiffnessBudget> stiffness(std::size_t probe,
                                                    std::optional<double> contact_N_m) const;

  const Scenario& scenario_;
  std::vector<std::unique_ptr<plant::Kinematics>> kinematics_;  // null without any
  std::vector<plant::LoopQuality> qualities_;
  struct Delays {
    std::int64_t frames = 0;
    Picoseconds sum = 0;
    Picoseconds worst = 0;
    std::array<Picoseconds, vp::kParts * vp::kPhases> parts{};  // the addends of `sum`

    void add(const vp::Frame& frame, const vp::CriticalPath& path);
  };
  const Delays& delays() const { return moving_.frames > 0 ? moving_ : all_; }

  Delays all_;
  Delays moving_;                        // in contact, with a force that changes
  std::vector<Eigen::Vector3d> forces_;  // of the last frame, one a probe
};

// The loop of a probe's device and a wall with the scenario's damping, along `direction` (of any
// length but zero), for the computation of exact eigenvalues. Absent where `direction` is no axis
// of the device and its masses differ: its axes are then coupled.
std::optional<plant::WallLoop> wall_loop(const Scenario& scenario, std::size_t probe,
                                         double delay_s, const Eigen::Vector3d& direction);

}  // namespace hvp::app
