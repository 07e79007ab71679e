#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "app/remedy/recorder.h"
#include "app/scene/scene.h"
#include "models/fem/hold.h"
#include "models/fixed/remedy.h"
#include "models/host/reference_run.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"

namespace hvp::app {

// A run's recorded frames, solved again with another plan: the same body, the same probe, the same
// contacts, in the board's words but without its time. What was found late or lost in the run
// stays so.
class Replay {
 public:
  enum class Span { first, whole };
  // The recording's frames are solved in double precision once, with `hand_over_s` in place of the
  // scenario's, which tells what contact prescribes and what is true; of `first` no more than are
  // needed. `frames` of them at most are solved again by attempt(): of a static body, which has no
  // state, so many over all of the recording, of a dynamic one the first.
  Replay(const Scene& scene, std::span<const Sighting> recording, std::size_t frames,
         double hand_over_s, Span span);

  // What the exact solution's force is like: rounding has no part in it.
  const stability::ForceQuality& exact_force() const { return exact_force_; }
  // m, of the exact solution's nodes: the largest component.
  double largest_displacement() const { return largest_; }
  std::size_t frames() const { return frames_.size(); }

  // An attempt ends with the first frame whose words are flagged: it has failed.
  struct Result {
    bool refused = false;  // there is no such system
    stability::Flags flags;
    // Of frames in contact: ‖u − u_true‖/‖u_true‖, median and 95 %.
    double median = 0;
    double p95 = 0;
  };
  Result attempt(const fixed::Plan& plan) const;

 private:
  // What contact prescribed, and where the exact solution was.
  struct Held {
    Sighting sighting;
    fem::KeptHold kept;
    std::vector<double> exact;
  };

  void solve_exactly(std::span<const Sighting> recording, std::size_t frames, double hand_over_s);
  void add_force(const Sighting& at, bool fades, std::int64_t frame, const Eigen::Vector3d& force,
                 stability::ForceQuality& quality) const;
  stability::Flags rounding_flags(const host::FrameComputation& computation, bool refined) const;

  const Scene& scene_;
  std::vector<Held> frames_;
  stability::ForceQuality exact_force_;
  double largest_ = 0;
  std::size_t stride_ = 1;  // of the frames that are solved again
};

}  // namespace hvp::app
