#include "app/remedy/contact_remedy.h"

#include <algorithm>

namespace hvp::app {

namespace {

using stability::Flag;

bool may_be_proxy(const Scenario& s) {
  return s.contact.search.kind == collision::ContactKind::node && !s.wall && !s.timing_only() &&
         s.host.solver != host::SolvedBy::steps && s.faults.empty();
}

}  // namespace

std::optional<results::TriedRemedy> try_contact_remedy(const Scenario& s,
                                                       const results::Outcome& outcome,
                                                       const std::vector<std::string>& found,
                                                       const Rerun& rerun, const Rerun& search) {
  const bool rough = outcome.flags.has(Flag::force_step) || outcome.flags.has(Flag::force_ringing);
  if (!rough || !may_be_proxy(s)) return std::nullopt;
  const std::string proxy = "contact.kind = \"proxy\"";
  std::vector<std::vector<std::string>> candidates = {{proxy}};
  std::vector<std::string> with_words = found;
  std::erase_if(with_words, [](const std::string& set) { return set.starts_with("contact."); });
  with_words.push_back(proxy);
  if (with_words.size() > 1) candidates.push_back(std::move(with_words));
  const Trouble trouble{.flags = outcome.flags, .held = outcome.held(), .frames = s.frames};
  std::optional<results::TriedRemedy> remedy = try_whole_runs(trouble, candidates, rerun);
  if (!remedy || remedy->works() || !search) return remedy;
  const std::optional<WholeRun> of_proxy = search({results::override_text(proxy)});
  if (!of_proxy || of_proxy->remedy.empty()) return remedy;
  std::vector<std::string> with_its_own = {proxy};
  with_its_own.insert(with_its_own.end(), of_proxy->remedy.begin(), of_proxy->remedy.end());
  std::optional<results::TriedRemedy> of_both = try_whole_runs(trouble, {with_its_own}, rerun);
  if (!of_both) return remedy;
  of_both->attempts += remedy->attempts + 1;
  return of_both->works() || remedy->settings.empty() ? of_both : remedy;
}

}  // namespace hvp::app
