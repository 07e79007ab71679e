#include "app/results/performance.h"

namespace hvp::results {

void Performance::report(config::Figures& f) const {
  f.quantity("build_scene_s", build_scene_s, "s",
             "wall-clock time to read the scenario, to mesh and to assemble");
  f.quantity("simulate_s", simulate_s, "s", "to simulate and to write the result files");
  f.quantity("remedy_s", remedy_s, "s", "to try the remedies of flags");
  f.quantity("frames_per_s", frames_per_s, "1/s", "frames over `simulate_s`");
  f.quantity("draw_s", draw_s, "s", "to draw the pictures");
  f.quantity("simulated_s", simulated_s, "s",
             "of the model, from the first tick to the end of the last frame");
  f.quantity("peak_memory_mb", peak_memory_mb, "MiB", "the most that was resident");
}

}  // namespace hvp::results
