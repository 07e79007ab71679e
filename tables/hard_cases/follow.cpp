#include <algorithm>
#include <utility>

#include "models/config/input_error.h"
#include "tables/hard_cases/cases.h"

namespace hvp::tables {

Trail follow(const Case& hard_case) {
  constexpr int kMostSteps = 40;
  Trail trail;
  trail.plan = hard_case.plan;
  try {
    trail.scene = hard_case.make();
  } catch (const InputError& error) {
    trail.refusal = error.what();
    return trail;
  }
  CaseScene& scene = *trail.scene;
  trail.model = scene.model;
  trail.first = scene.attempt(trail.plan);
  trail.last = trail.first;
  trail.refusal = trail.first.refusal;
  ++trail.attempts;
  const auto trial = [](const CaseOutcome& outcome) {
    return fixed::Trial{.refused = !outcome.refusal.empty(), .flags = outcome.flags()};
  };
  // The displacements are those of the double-precision solution: no plan changes them.
  const fixed::Extent extent{.largest_displacement = trail.first.largest_displacement};
  const fixed::Attempt attempt = [&](const fixed::Plan& plan) {
    const CaseOutcome outcome = scene.attempt(plan);
    // Plans that are only faster are dropped if they fail.
    if (!trail.last.converged() || outcome.converged()) trail.last = outcome;
    return trial(outcome);
  };
  fixed::Search search =
      fixed::follow_remedies(trail.plan, trial(trail.first), extent, attempt, kMostSteps - 1);
  if (!search.remedies.empty()) {
    // An increment needs fewer iterations than the whole.
    fixed::save_time(hard_case.plan.settings.iterations / 4, attempt, search);
  }
  trail.converged = search.last.cured();
  trail.plan = search.plan;
  trail.remedies = std::move(search.remedies);
  trail.attempts += search.attempts;
  return trail;
}

}  // namespace hvp::tables
