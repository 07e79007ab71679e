#include "app/remedy/whole_runs.h"

#include <algorithm>
#include <bit>

namespace hvp::app {

namespace {

using stability::Flags;

std::vector<std::string> override_texts(const std::vector<std::string>& settings) {
  std::vector<std::string> texts(settings.size());
  std::ranges::transform(settings, texts.begin(), results::override_text);
  return texts;
}

void note(const WholeRun& run, results::TriedRemedy& remedy) {
  remedy.left = run.flags;
  remedy.verdict = run.held ? run.verdict : "not held";
  remedy.held = run.held;
  remedy.whole_run = true;
  remedy.after = run.worst;
}

}  // namespace

void verify(results::TriedRemedy& remedy, Flags of_run, const Rerun& rerun) {
  const Flags not_judged(of_run.bits() & ~remedy.of.bits());
  remedy.left.merge(not_judged);
  remedy.of = of_run;
  if (remedy.settings.empty() || !remedy.fits || !rerun) return;
  const std::optional<WholeRun> run = rerun(override_texts(remedy.settings));
  if (run) note(*run, remedy);
}

std::optional<results::TriedRemedy> try_whole_runs(
    const Trouble& trouble, const std::vector<std::vector<std::string>>& candidates,
    const Rerun& rerun) {
  results::TriedRemedy best;
  best.of = trouble.flags;
  best.left = trouble.flags;
  best.whole_run = true;
  best.frames = static_cast<std::size_t>(trouble.frames);
  for (const std::vector<std::string>& settings : candidates) {
    const std::optional<WholeRun> run = rerun(override_texts(settings));
    if (!run) continue;
    ++best.attempts;
    // One that raises flags of its own, or breaks a budget, is no remedy.
    const bool held = run->held || !trouble.held;
    if (!held || (run->flags.bits() & ~trouble.flags.bits()) != 0) continue;
    const int count = std::popcount(run->flags.bits());
    const int fewest = std::popcount(best.left.bits());
    // Of those without flags a PASS is better than another word.
    const bool passes = count == 0 && run->verdict.starts_with("PASS");
    if (count >= fewest && !passes) continue;
    note(*run, best);
    best.settings = settings;
    if (passes || (count == 0 && !trouble.wants_pass)) break;
  }
  if (best.attempts == 0) return std::nullopt;
  return best;
}

}  // namespace hvp::app
