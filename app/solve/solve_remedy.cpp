#include <cstdint>
#include <utility>

#include "app/devices/devices.h"
#include "app/solve/system_solve.h"
#include "models/accel/fit.h"
#include "models/accel/operations.h"
#include "models/config/input_error.h"
#include "models/fixed/remedy.h"

namespace hvp::app {

namespace {

constexpr int kMostAttempts = 40;
// Products of a matrix entry and a vector entry that a whole search may take: some ten seconds.
constexpr double kMostWork = 1e10;

SolveTask with_plan(const SolveTask& task, const fixed::Plan& plan) {
  SolveTask changed = task;
  changed.settings.solver = plan.settings;
  changed.settings.spectrum.reset();
  if (plan.passes > 1 && !changed.settings.refinement) changed.settings.refinement.emplace();
  if (changed.settings.refinement) changed.settings.refinement->passes = plan.passes;
  return changed;
}

double work_of(const LinearSystem& system, const fixed::Plan& plan) {
  return static_cast<double>(system.matrix.value.size()) * plan.settings.iterations * plan.passes;
}

// Finds what the words need of the device, where they do not fit its present architecture.
void make_fit(const SolveTask& task, const SystemSolution& solution, const LinearSystem& system,
              results::TriedRemedy& remedy) {
  remedy.fits = solution.usage.fits();
  if (remedy.fits || task.settings.accelerator.several) return;
  const accel::WordLengths words = accel::word_lengths(solution.solver);
  const accel::Pattern pattern = accel::pattern_of(system.matrix.row_begin);
  for (const accel::Proposal& proposal : accel::proposals_that_fit(
           task.device, task.settings.accelerator, words, pattern, devices::all_built_in())) {
    if (!proposal.remark.empty()) continue;
    remedy.settings.insert(remedy.settings.end(), proposal.settings.begin(),
                           proposal.settings.end());
    remedy.fits = true;
    return;
  }
}

}  // namespace

std::optional<results::TriedRemedy> try_remedies(const LinearSystem& system, const SolveTask& task,
                                                 const SystemSolution& solution) {
  if (solution.flags.empty()) return std::nullopt;
  const fixed::Plan original{task.settings.solver,
                             task.settings.refinement ? task.settings.refinement->passes : 1};
  if (!fixed::next_remedy(solution.flags, original)) return std::nullopt;
  std::optional<SystemSolution> cured;
  double work = 0;
  const fixed::Attempt attempt = [&](const fixed::Plan& plan) {
    work += work_of(system, plan);
    if (work > kMostWork) return fixed::Trial{.refused = true, .flags = {}};
    try {
      plan.settings.check();
      SystemSolution s = solve_system(system, with_plan(task, plan));
      const fixed::Trial trial{.refused = false, .flags = s.flags};
      if (trial.cured()) cured = std::move(s);
      return trial;
    } catch (const InputError&) {
      return fixed::Trial{.refused = true, .flags = {}};
    }
  };
  fixed::Search search = fixed::follow_remedies(
      original, {.refused = false, .flags = solution.flags}, {}, attempt, kMostAttempts);
  fixed::take_back(original, attempt, search);
  results::TriedRemedy remedy;
  remedy.of = solution.flags;
  remedy.attempts = search.attempts;
  if (!search.last.cured()) {
    remedy.left = search.last.flags.empty() ? solution.flags : search.last.flags;
    return remedy;
  }
  remedy.settings = fixed::changes(original, search.plan);
  remedy.median = cured->error;
  make_fit(task, *cured, system, remedy);
  return remedy;
}

}  // namespace hvp::app
