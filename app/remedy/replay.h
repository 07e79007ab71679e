#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/scene/scene.h"
#include "models/collision/contact.h"
#include "models/fem/hold.h"
#include "models/fixed/remedy.h"
#include "models/host/reference_run.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"
#include "vp/frame/ledger.h"

namespace hvp::app {

// The probes' positions and contacts in a frame.
struct Sighting {
  Picoseconds time = 0;  // the frame's tick
  std::vector<collision::Touch> touches;

  const collision::Touch& touch() const { return touches.front(); }
};

// Records the first frames of contact of a run, so that they can be solved again in another way.
// Before there is contact it keeps the last two frames, which the hand-over needs.
class Recorder : public vp::FrameObserver {
 public:
  static constexpr std::size_t kMostFrames = 4096;

  explicit Recorder(std::int64_t frames);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  const std::vector<Sighting>& sightings() const { return sightings_; }

 private:
  std::vector<Sighting> sightings_;
  bool touched_ = false;
};

// Solves a run's recorded frames again with another plan: the same body, the same probe, the same
// contacts, in the board's words but without its time. A contact that the run found late or lost
// remains late or lost.
class Replay {
 public:
  enum class Span { first, whole };
  // Solves the recording in double precision once, with `hand_over_s` in place of the scenario's
  // time, to find the displacements that contact prescribes and the true solutions; with
  // Span::first only as many frames as are needed. attempt() solves at most `frames` of them again:
  // of a static body, which has no state, frames spread over all of the recording, of a dynamic one
  // the first.
  Replay(const Scene& scene, std::span<const Sighting> recording, std::size_t frames,
         double hand_over_s, Span span, const Progress& progress = {});

  // The quality of the exact solution's force, to which rounding does not contribute.
  const stability::ForceQuality& exact_force() const { return exact_force_; }
  // The largest component of a node's displacement in the exact solution, m.
  double largest_displacement() const { return largest_; }
  std::size_t frames() const { return frames_.size(); }

  // The result of an attempt, which fails at the first frame whose words raise a flag and ends
  // there.
  struct Result {
    bool refused = false;  // the plan's words cannot represent the system
    stability::Flags flags;
    // ‖u − u_true‖/‖u_true‖ over the frames in contact, median and 95 %.
    double median = 0;
    double p95 = 0;
    double growth = 0;  // of a renewed matrix, over that of the body at rest
  };
  Result attempt(const fixed::Plan& plan) const;

 private:
  // A frame: the displacements that contact prescribed, and the exact solution.
  struct Held {
    Sighting sighting;
    fem::KeptHold kept;
    std::vector<double> exact;
  };

  void solve_exactly(std::span<const Sighting> recording, std::size_t frames, double hand_over_s,
                     const Progress& progress);
  void add_force(const Sighting& at, bool fades, std::int64_t frame, const Eigen::Vector3d& force,
                 stability::ForceQuality& quality) const;

  const Scene& scene_;
  std::vector<Held> frames_;
  stability::ForceQuality exact_force_;
  double largest_ = 0;
  std::size_t stride_ = 1;  // of the frames that are solved again
};

}  // namespace hvp::app
