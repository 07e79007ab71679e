#include "app/remedy/find_remedy.h"

#include <bit>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/remedy/element_remedy.h"
#include "app/remedy/replay.h"
#include "app/remedy/tissue_remedy.h"

namespace hvp::app {

namespace {

// Where nothing helps, the attempts are said.
void take_better(std::optional<results::TriedRemedy> found, bool was_held,
                 std::optional<results::TriedRemedy>& remedy) {
  if (!found) return;
  const auto left = [](const results::TriedRemedy& tried) {
    return std::popcount(tried.left.bits());
  };
  if (remedy && (found->settings.empty() || left(*found) >= left(*remedy))) return;
  found->was_held = was_held;
  if (remedy) found->attempts += remedy->attempts;
  remedy = std::move(found);
}

}  // namespace

std::optional<results::TriedRemedy> find_remedy(const Scene& scene, const results::Outcome& outcome,
                                                const Recorder* recorder, const Again& searched,
                                                const Progress& progress) {
  int whole_runs = 0;
  Again again = searched;
  if (searched.rerun && progress) {
    again.rerun = [&](const std::vector<std::string>& texts) {
      progress(fmt::format("looking for a remedy: whole run {}", ++whole_runs));
      return searched.rerun(texts);
    };
  }
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

}  // namespace hvp::app
