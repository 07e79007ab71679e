#pragma once

#include <string>
#include <vector>

#include "models/config/figures.h"

namespace hvp::app {
class Scene;
}

namespace hvp::results {

// What a material of the body has of it.
struct RegionFigures {
  std::string name;  // of the region; "object.material" for what no region has
  int elements = 0;
  double volume_m3 = 0;
  double share = 0;  // of the body's volume
  double mass_kg = 0;
  double young_modulus_pa = 0;
  double poisson_ratio = 0;
  double density_kg_m3 = 0;

  void report(config::Figures& f) const;
};

// The body's own material first, then the regions in the scenario's order; empty for a body
// without regions.
std::vector<RegionFigures> region_figures(const app::Scene& scene);

// The lines of a run and of `hvp explain` that say what each region has of the body; empty for a
// body without regions.
std::string regions_text(const app::Scene& scene);

}  // namespace hvp::results
