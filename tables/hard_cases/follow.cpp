#include <algorithm>
#include <utility>

#include "models/config/input_error.h"
#include "tables/hard_cases/cases.h"

namespace hvp::tables {

namespace {

// Plans that take less time than this one and differ in nothing else, the fastest first.
std::vector<fixed::Plan> faster(const fixed::Plan& plan, int least_iterations) {
  std::vector<fixed::Plan> plans;
  for (int passes = 1; passes <= plan.passes; ++passes) {
    for (int n = least_iterations; n <= plan.settings.iterations; n *= 2) {
      if (passes * n >= plan.passes * plan.settings.iterations) break;
      plans.push_back(plan);
      plans.back().passes = passes;
      plans.back().settings.iterations = n;
    }
  }
  std::ranges::stable_sort(plans, {},
                           [](const fixed::Plan& p) { return p.passes * p.settings.iterations; });
  return plans;
}

void save_time(Scene& scene, int least_iterations, Trail& trail) {
  for (const fixed::Plan& plan : faster(trail.plan, least_iterations)) {
    const Outcome outcome = scene.attempt(plan);
    ++trail.attempts;
    if (!outcome.converged()) continue;
    trail.plan = plan;
    trail.last = outcome;
    return;
  }
}

}  // namespace

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
  Scene& scene = *trail.scene;
  trail.model = scene.model;
  trail.first = scene.attempt(trail.plan);
  trail.last = trail.first;
  trail.refusal = trail.first.refusal;
  ++trail.attempts;
  while (trail.last.refusal.empty() && !trail.last.converged() && trail.attempts < kMostSteps) {
    const fixed::Extent extent{.largest_displacement = trail.last.largest_displacement};
    std::optional<fixed::Remedy> remedy =
        fixed::next_remedy(trail.last.flags(), trail.plan, extent);
    if (!remedy) break;
    trail.plan = remedy->plan;
    trail.remedies.push_back(std::move(*remedy));
    trail.last = scene.attempt(trail.plan);
    ++trail.attempts;
  }
  trail.converged = trail.last.converged();
  if (trail.converged && !trail.remedies.empty()) {
    // An increment needs fewer iterations than the whole.
    save_time(scene, hard_case.plan.settings.iterations / 4, trail);
  }
  return trail;
}

}  // namespace hvp::tables
