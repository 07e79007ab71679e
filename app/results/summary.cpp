#include "app/results/summary.h"

#include "app/results/figures_json.h"
#include "models/config/effects.h"

namespace hvp::results {

std::vector<std::string> effects(const app::Scenario& s) {
  std::vector<std::string> names;
  for (const config::Effect& effect : config::survey_effects(s).effects()) {
    if (effect.present) names.push_back(effect.path);
  }
  return names;
}

std::string summary_json(const Outcome& outcome) { return figures_json(outcome).dump(2) + "\n"; }

}  // namespace hvp::results
