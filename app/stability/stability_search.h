#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/stability/loop_trial.h"
#include "models/config/figures.h"

namespace hvp::app {

// The stiffest wall, or body at its contact, that a scenario's loop holds.
struct StabilityFigures {
  double stiffness_max = 0;      // N/m, by runs of the platform; 0: none is stable
  double left_m = 0;             // what it swings on by then, half of peak to peak
  double unstable_from = 0;      // the softest that was seen not to be; 0: none was
  double stiffness_linear = 0;   // by the exact eigenvalues at the runs' own delay
  double stiffness_passive = 0;  // by Colgate & Schenkel's bound at that delay
  double encoder_bound = 0;      // 2·f_c/Δ of Abbott & Okamura 2005; 0: not both are there
  double delay_s = 0;            // from the latch to the force at the motor, mean
  double period_s = 0;
  double damping_N_s_m = 0;     // of the wall
  double young_modulus_Pa = 0;  // of the body at stiffness_max; 0: a wall
  int runs = 0;

  void report(config::Figures& f) const;
};

struct SearchSettings {
  TrialSettings trial;
  double tolerance = 1e-3;  // relative, of stiffness_max
  double largest_N_m = 1e7;
};

// Bisects over runs of the platform between a stable and an unstable stiffness: the wall's, or by
// its Young's modulus the body's at its contact. The scenario has a device with mass; throws
// InputError otherwise, and as the trials do.
StabilityFigures find_stability(const Scene& scene, const SearchSettings& settings,
                                const Progress& progress);

// The same for `count` dampings of the wall from none to where no stiffness is stable any more.
// Throws InputError for a body.
std::vector<StabilityFigures> stability_map(const Scene& scene, const SearchSettings& settings,
                                            int count, const Progress& progress);

}  // namespace hvp::app
