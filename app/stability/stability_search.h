#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/stability/loop_trial.h"
#include "models/config/figures.h"

namespace hvp::app {

// The stiffest wall, or body at its contact, with which a scenario's loop is stable.
struct StabilityFigures {
  double stiffness_max = 0;      // N/m, by runs of the platform; 0: no stiffness is stable
  double left_m = 0;             // half of the remaining peak-to-peak swing at that stiffness
  double unstable_from = 0;      // the least stiffness found unstable, N/m; 0: none
  double stiffness_linear = 0;   // N/m, by the exact eigenvalues with the delay of the runs
  bool linear_computed = false;  // false: coupled axes, or a delay of more than kMostPeriods
  double stiffness_passive = 0;  // N/m, by Colgate & Schenkel's bound with that delay
  double encoder_bound = 0;  // N/m, 2·f_c/Δ of Abbott & Okamura 2005; 0: no friction or encoder
  double delay_s = 0;        // from the latch to the force at the motor, mean
  double period_s = 0;
  double damping_N_s_m = 0;     // of the wall
  double young_modulus_Pa = 0;  // of the body at stiffness_max; 0: a wall
  int runs = 0;
  // The stiffness of a trial that would have taken more frames than one has: what is softer was not
  // searched; 0: there was none.
  double undecided_N_m = 0;
  bool stuck = false;  // friction held the device in the trial at stiffness_max: it is no edge

  // Eigenvalues of a longer delay take too long to search.
  static constexpr double kMostPeriods = 64;

  void report(config::Figures& f) const;
};

struct SearchSettings {
  TrialSettings trial;
  double tolerance = 1e-3;  // relative, of stiffness_max
  double largest_N_m = 1e7;
};

// Searches the largest stable stiffness by bisection over runs of the platform. The stiffness is
// the wall's, or that of the body at its contact, changed by Young's modulus. Throws InputError if
// the scenario has no device with mass, and as the trials do.
StabilityFigures find_stability(const Scene& scene, const SearchSettings& settings,
                                const Progress& progress);

// Repeats the search for `count` dampings of the wall, from none to the damping at which no
// stiffness is stable. Throws InputError for a body.
std::vector<StabilityFigures> stability_map(const Scene& scene, const SearchSettings& settings,
                                            int count, const Progress& progress);

}  // namespace hvp::app
