#pragma once

#include "models/config/figures.h"

namespace hvp::results {

// performance.json: what differs between two runs of the same scenario.
struct Performance {
  double build_scene_s = 0;
  double simulate_s = 0;
  double remedy_s = 0;
  double frames_per_s = 0;
  double draw_s = 0;
  double simulated_s = 0;
  double peak_memory_mb = 0;

  void report(config::Figures& f) const;
};

}  // namespace hvp::results
