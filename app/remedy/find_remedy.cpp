#include "app/remedy/find_remedy.h"

#include <bit>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/remedy/contact_remedy.h"
#include "app/remedy/element_remedy.h"
#include "app/remedy/replay.h"
#include "app/remedy/tissue_remedy.h"

namespace hvp::app {

namespace {

// Takes what leaves fewer flags than the remedy that is there, or as few where it is `preferred`.
// Where nothing helps, the attempts are said.
void take_better(std::optional<results::TriedRemedy> found, bool was_held,
                 std::optional<results::TriedRemedy>& remedy, bool preferred = false) {
  if (!found) return;
  const auto left = [](const results::TriedRemedy& tried) {
    return std::popcount(tried.left.bits());
  };
  if (remedy) {
    const bool fewer = left(*found) < left(*remedy);
    const bool as_few = left(*found) == left(*remedy) && (found->held || !remedy->held);
    if (found->settings.empty() || !(fewer || (preferred && as_few))) return;
  }
  found->was_held = was_held;
  if (remedy) found->attempts += remedy->attempts;
  remedy = std::move(found);
}

std::optional<results::TriedRemedy> search_remedy(const Scene& scene,
                                                  const results::Outcome& outcome,
                                                  const Recorder* recorder, const Again& searched,
                                                  const Progress& progress) {
  int whole_runs = 0;
  Again again = searched;
  const auto counted = [&](const Rerun& rerun) -> Rerun {
    if (!rerun || !progress) return rerun;
    return [&](const std::vector<std::string>& texts) {
      progress(fmt::format("looking for a remedy: whole run {}", ++whole_runs));
      return rerun(texts);
    };
  };
  again.rerun = counted(searched.rerun);
  again.search = counted(searched.search);
  std::optional<results::TriedRemedy> remedy;
  if (recorder != nullptr && again.rebuild) {
    remedy = try_remedies(
        scene, outcome.flags, recorder->sightings(),
        {outcome.verdict.worst_latency(), outcome.verdict.worst_load(), outcome.verdict.budget(),
         outcome.verdict.period(), outcome.matrix ? outcome.matrix->counts.growth : 0},
        again.rebuild, progress);
  }
  if (remedy) {
    remedy->was_held = outcome.held();
    verify(*remedy, outcome.flags, again.rerun);
  }
  if (!remedy && again.rerun) {
    remedy = try_tissue_remedy(scene.scenario(), outcome, again.rerun);
    if (remedy) remedy->was_held = outcome.held();
  }
  if (again.rerun) {
    // A longer hand-over only spreads a node's steps.
    take_better(try_contact_remedy(scene.scenario(), outcome,
                                   remedy ? remedy->settings : std::vector<std::string>(),
                                   again.rerun, again.search),
                outcome.held(), remedy, true);
    take_better(try_law_remedy(scene.scenario(), outcome, again.rerun), outcome.held(), remedy);
    take_better(try_element_remedy(scene.scenario(), outcome.flags, again.rerun), outcome.held(),
                remedy);
  }
  if (!outcome.stiffness || !again.rerun) return remedy;
  const bool helps = remedy && remedy->whole_run && !remedy->taken_away().empty();
  const stability::Flags flags = helps ? remedy->left : outcome.flags;
  std::optional<results::TriedRemedy> of_loop =
      try_loop_remedy(scene.scenario(), flags, *outcome.stiffness,
                      helps ? remedy->settings : std::vector<std::string>(), again.rerun);
  if (!of_loop || (remedy && of_loop->settings.empty())) return remedy;
  of_loop->was_held = outcome.held();
  of_loop->of = outcome.flags;
  if (remedy) of_loop->attempts += remedy->attempts;
  return of_loop;
}

}  // namespace

std::optional<results::TriedRemedy> find_remedy(const Scene& scene, const results::Outcome& outcome,
                                                const Recorder* recorder, const Again& searched,
                                                const Progress& progress) {
  std::optional<results::TriedRemedy> remedy =
      search_remedy(scene, outcome, recorder, searched, progress);
  if (!remedy || !remedy->whole_run || remedy->after.latency_ps <= 0) return remedy;
  const vp::Verdict& run = outcome.verdict;
  remedy->before = {run.worst_latency(), run.worst_load()};
  remedy->in_time =
      remedy->after.latency_ps <= run.budget() && remedy->after.load_ps <= run.period();
  return remedy;
}

}  // namespace hvp::app
