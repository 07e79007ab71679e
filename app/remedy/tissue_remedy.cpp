#include "app/remedy/tissue_remedy.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

namespace hvp::app {

namespace {

using stability::Flag;

constexpr int kMostPasses = 16;  // that a scenario may ask for

// A tenth between a substep and the estimate of the limit (docs/tissue.md), and more where the
// motion with it comes nearer to a limit that this run has not seen.
std::vector<std::vector<std::string>> more_substeps(const results::ExplicitFigures& steps,
                                                    double period_s) {
  constexpr double kShare = 0.9;
  constexpr int kMostSubsteps = 1000;
  int needed = steps.substeps + 1;
  if (steps.least_limit_s > 0 && std::isfinite(steps.least_limit_s)) {
    needed =
        std::max(needed, static_cast<int>(std::min<double>(
                             kMostSubsteps, std::ceil(period_s / (kShare * steps.least_limit_s)))));
  }
  std::vector<std::vector<std::string>> found;
  // A body that was thrown apart says little of the limit that a stable run would have.
  if (needed > 2 * steps.substeps) {
    found.push_back({fmt::format("host.substeps = {}", steps.substeps + 1)});
    found.push_back({fmt::format("host.substeps = {}", 2 * steps.substeps + 1)});
  }
  for (const double times : {1.0, 1.5, 2.0, 4.0}) {
    const int substeps = static_cast<int>(std::ceil(times * needed));
    if (substeps <= kMostSubsteps) found.push_back({fmt::format("host.substeps = {}", substeps)});
  }
  return found;
}

std::vector<std::vector<std::string>> more_passes(int passes) {
  std::vector<std::vector<std::string>> found;
  for (int more = 2 * passes; more < 2 * kMostPasses && passes < kMostPasses; more *= 2) {
    found.push_back({fmt::format("refinement.passes = {}", std::min(more, kMostPasses))});
  }
  return found;
}

// Passes with the matrix at rest are cheaper than a matrix that follows the body.
std::vector<std::vector<std::string>> passes_and_renewals(const Scenario& s) {
  const int passes = s.refinement->passes;
  std::vector<std::vector<std::string>> found = more_passes(passes);
  const fem::MatrixRenewal renewal = s.object.renewal();
  for (const int every : {50, 10, 1}) {
    if (renewal.present() && every >= renewal.every) continue;
    const std::string often = fmt::format("object.model.matrix.renew_every = {}", every);
    found.push_back({often});
    if (2 * passes <= kMostPasses) {
      found.push_back({often, fmt::format("refinement.passes = {}", 2 * passes)});
    }
  }
  return found;
}

}  // namespace

std::optional<results::TriedRemedy> try_tissue_remedy(const Scenario& s,
                                                      const results::Outcome& outcome,
                                                      const Rerun& rerun) {
  const stability::Flags flags = outcome.flags;
  const Trouble trouble{
      .flags = flags, .held = outcome.held(), .frames = s.frames, .wants_pass = false};
  const bool inexact = flags.has(Flag::not_converged) || flags.has(Flag::divergence);
  if (outcome.explicit_steps) {
    if (!inexact && !flags.has(Flag::unstable_step) && !flags.has(Flag::inverted_element)) {
      return std::nullopt;
    }
    return try_whole_runs(trouble, more_substeps(*outcome.explicit_steps, s.budget.period_s),
                          rerun);
  }
  const bool host_solves =
      s.host.solver == host::SolvedBy::cg || s.host.solver == host::SolvedBy::cholesky;
  if (!host_solves || !s.refinement || !inexact) return std::nullopt;
  return try_whole_runs(trouble, passes_and_renewals(s), rerun);
}

std::optional<results::TriedRemedy> try_law_remedy(const Scenario& s,
                                                   const results::Outcome& outcome,
                                                   const Rerun& rerun) {
  const std::optional<tissue::Model>& model = s.object.model;
  const bool gives_way = model && (model->springs || model->kind == tissue::LawKind::corotational ||
                                   model->kind == tissue::LawKind::st_venant_kirchhoff);
  const bool beyond =
      outcome.flags.has(Flag::inverted_element) || outcome.flags.has(Flag::beyond_linearity);
  if (!gives_way || !beyond) return std::nullopt;
  std::vector<std::vector<std::string>> candidates;
  for (const std::string_view kind : {"neo-hookean-isochoric", "neo-hookean-log"}) {
    const std::string law = fmt::format("object.model.kind = \"{}\"", kind);
    candidates.push_back({law});
    if (!s.refinement) continue;
    for (const std::vector<std::string>& passes : more_passes(s.refinement->passes)) {
      candidates.push_back({law, passes.front()});
    }
  }
  return try_whole_runs(
      {.flags = outcome.flags, .held = outcome.held(), .frames = s.frames, .wants_pass = false},
      candidates, rerun);
}

}  // namespace hvp::app
