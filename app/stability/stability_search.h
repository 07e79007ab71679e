#pragma once

#include <optional>
#include <vector>

#include "app/stability/edge_search.h"
#include "app/stability/loop_trial.h"
#include "models/config/figures.h"

namespace hvp::app {

// The stiffest wall, or body at its contact, with which a scenario's loop is stable.
struct StabilityFigures {
  // By runs of the platform; of those that are none of friction's the one with the least stiffness.
  StabilityEdge least;
  double stiffness_linear = 0;   // N/m, by the exact eigenvalues with the delay of the runs
  bool linear_computed = false;  // false: coupled axes, or a delay of more than kMostPeriods
  double stiffness_passive = 0;  // N/m, by Colgate & Schenkel's bound with that delay
  double encoder_bound = 0;  // N/m, 2·f_c/Δ of Abbott & Okamura 2005; 0: no friction or encoder
  double delay_s = 0;        // from the latch to the force at the motor, mean
  double period_s = 0;
  double damping_N_s_m = 0;     // of the wall
  double young_modulus_Pa = 0;  // of the body at the edge; 0: a wall
  std::vector<StabilityEdge> edges;
  // The least push of the ladder at which a force is clamped even in a soft wall, N; 0: none was.
  double beyond_device_N = 0;
  // The edge is that of the last push, and a harder one may have a lower edge.
  bool falling = false;

  // Eigenvalues of a longer delay take too long to search.
  static constexpr double kMostPeriods = 64;

  int runs() const;  // of all edges
  void report(config::Figures& f) const;
};

struct SearchSettings {
  TrialSettings trial;
  // Every push of a ladder is tried, and the scenario's own motion, where friction, an encoder or a
  // limit makes an edge depend on how far the device swings; else, and in a body, trial.push_N.
  bool all_amplitudes = false;
  double tolerance = 1e-3;  // relative, of stiffness_max
  double largest_N_m = 1e7;
};

// Searches the largest stable stiffness by bisection over runs of the platform, for each amplitude
// that is asked for, of which the least is the result. The stiffness is
// the wall's, or that of the body at its contact, changed by Young's modulus. Throws InputError if
// the scenario has no device with mass, and as the trials do.
StabilityFigures find_stability(const Scene& scene, const SearchSettings& settings,
                                const Progress& progress);

// Repeats the search for `count` dampings of the wall, from none to the damping at which no
// stiffness is stable. Throws InputError for a body.
std::vector<StabilityFigures> stability_map(const Scene& scene, const SearchSettings& settings,
                                            int count, const Progress& progress);

}  // namespace hvp::app
