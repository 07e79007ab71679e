#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/scene/scene.h"
#include "app/stability/loop_trial.h"
#include "models/config/figures.h"

namespace hvp::app {

// The edge of stability that a device finds which leans on a wall with one force, or moves as the
// scenario says.
struct StabilityEdge {
  std::optional<double> push_N;  // absent: the scenario's own motion
  double stiffness_max = 0;      // N/m; 0: no stiffness is stable
  double left_m = 0;             // half of the remaining peak-to-peak swing at that stiffness
  double unstable_from = 0;      // the least stiffness found unstable, N/m; 0: none
  // The stiffness of a trial that would have taken more frames than one has: what is softer was not
  // searched; 0: there was none.
  double undecided_N_m = 0;
  bool stuck = false;    // friction held the device in the trial at stiffness_max: it is no edge
  bool clamped = false;  // a force was clamped even in a soft wall: the edge is the clamp's
  int runs = 0;

  void report(config::Figures& f) const;
};

// The search of one edge: trials of stiffnesses from 0.01 N/m on, N/m.
class EdgeSearch {
 public:
  using TryAt = std::function<Trial(double stiffness_N_m)>;

  // `what` stands before each trial in the progress, which has to outlive the search.
  EdgeSearch(TryAt try_at, double largest_N_m, const Progress& progress, std::string what);

  // A first trial, for its delay. Returns false where a force was clamped in it.
  bool begin(double stiffness);
  // Brackets the edge from a guess on and bisects it, to this share of it.
  StabilityEdge find(double guess, double tolerance);
  // Looks below the edge that was found, down to a third, for a softer wall that is not stable,
  // whose edge is then the result: a loop that is not linear may have several.
  StabilityEdge look_below(double tolerance);

  double delay_s() const { return delay_s_; }
  // False where a trial never came to the wall.
  bool pressed() const { return pressed_; }

 private:
  bool stable(double stiffness);
  void bracket(double guess);
  // From an unstable stiffness down to a stable one, if there is any.
  void go_down(double from, double stride);
  StabilityEdge bisect(double tolerance);

  TryAt try_at_;
  double largest_N_m_;
  const Progress& progress_;
  std::string what_;
  StabilityEdge edge_;
  double below_ = 0;  // the stiffest that was stable
  double above_ = 0;  // the softest that was not
  double delay_s_ = 0;
  bool clamped_ = false;  // in the last trial
  bool pressed_ = true;
};

}  // namespace hvp::app
