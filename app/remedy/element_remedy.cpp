#include "app/remedy/element_remedy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace hvp::app {

namespace {

using stability::Flag;

std::vector<std::string> texts_of(const std::vector<std::string>& settings) {
  std::vector<std::string> texts(settings.size());
  std::ranges::transform(settings, texts.begin(), results::override_text);
  return texts;
}

// What helps against the larger condition number, the cheapest first.
std::vector<std::vector<std::string>> words_to_try(const Scenario& s) {
  std::vector<std::vector<std::string>> tried = {{}};
  if (s.host.solver != host::SolvedBy::board) return tried;
  const std::string scaled = "solver.matrix_scaling = \"diagonal\"";
  tried.push_back({scaled});
  for (const int passes : {2, 4}) {
    tried.push_back({scaled, fmt::format("solver.iterations = {}", 2 * s.solver.iterations),
                     fmt::format("refinement.passes = {}", passes)});
  }
  return tried;
}

bool may_have_mean_dilatation(const Scenario& s) {
  return s.object.elements != fem::Elements::mean_dilatation && !s.object.nonlinear() &&
         s.host.solver != host::SolvedBy::steps && !s.judged_by_another_model();
}

}  // namespace

std::optional<results::TriedRemedy> try_element_remedy(const Scenario& s, stability::Flags flags,
                                                       const Rerun& rerun) {
  if (!flags.has(Flag::locking) || !may_have_mean_dilatation(s)) return std::nullopt;
  results::TriedRemedy best;
  best.of = flags;
  best.left = flags;
  best.whole_run = true;
  best.frames = static_cast<std::size_t>(s.frames);
  for (const double share : {1.0, 0.7, 0.5}) {
    std::vector<std::string> elements = {"object.elements = \"quadratic-mean-dilatation\""};
    if (share < 1) {
      const double tens = std::floor(share * s.object.mesh.nodes / 10);
      elements.push_back(fmt::format("object.mesh.nodes = {:.0f}", 10 * tens));
    }
    for (const std::vector<std::string>& words : words_to_try(s)) {
      std::vector<std::string> all = elements;
      all.insert(all.end(), words.begin(), words.end());
      const std::optional<WholeRun> run = rerun(texts_of(all));
      if (!run) break;  // it does not fit
      ++best.attempts;
      if (!run->held || (run->flags.bits() & ~flags.bits()) != 0) continue;
      if (std::popcount(run->flags.bits()) >= std::popcount(best.left.bits())) continue;
      best.left = run->flags;
      best.verdict = run->verdict;
      best.held = run->held;
      best.after = run->worst;
      best.settings = all;
      if (run->flags.empty()) return best;
    }
    if (best.attempts > 0) break;
  }
  if (best.attempts == 0) return std::nullopt;
  return best;
}

}  // namespace hvp::app
