#include "app/remedy/contact_remedy.h"

#include <algorithm>
#include <optional>
#include <string>

namespace hvp::app {

namespace {

using stability::Flag;

// The kind of contact that may help: a proxy in place of a node whose force steps or rings, a patch
// in place of a proxy that is doubtful.
std::optional<std::string> other_kind(const Scenario& s, const stability::Flags& flags) {
  if (s.wall || s.timing_only() || s.host.solver == host::SolvedBy::steps || !s.faults.empty()) {
    return std::nullopt;
  }
  const bool rough = flags.has(Flag::force_step) || flags.has(Flag::force_ringing);
  if (s.contact.search.kind == collision::ContactKind::node && rough) return "proxy";
  const bool large =
      std::ranges::any_of(s.probes, [](const auto& probe) { return probe.radius > 0; });
  if (s.contact.search.kind == collision::ContactKind::proxy && large &&
      flags.has(Flag::contact_doubtful)) {
    return "patch";
  }
  return std::nullopt;
}

}  // namespace

std::optional<results::TriedRemedy> try_contact_remedy(const Scenario& s,
                                                       const results::Outcome& outcome,
                                                       const std::vector<std::string>& found,
                                                       const Rerun& rerun, const Rerun& search) {
  const std::optional<std::string> other = other_kind(s, outcome.flags);
  if (!other) return std::nullopt;
  const std::string kind = "contact.kind = \"" + *other + "\"";
  std::vector<std::vector<std::string>> candidates = {{kind}};
  std::vector<std::string> with_words = found;
  std::erase_if(with_words, [](const std::string& set) { return set.starts_with("contact."); });
  with_words.push_back(kind);
  if (with_words.size() > 1) candidates.push_back(std::move(with_words));
  const Trouble trouble{.flags = outcome.flags, .held = outcome.held(), .frames = s.frames};
  std::optional<results::TriedRemedy> remedy = try_whole_runs(trouble, candidates, rerun);
  if (!remedy || remedy->works() || !search) return remedy;
  const std::optional<WholeRun> of_kind = search({results::override_text(kind)});
  if (!of_kind || of_kind->remedy.empty()) return remedy;
  std::vector<std::string> with_its_own = of_kind->remedy;
  // Its own may be another kind still.
  const auto is_kind = [](const std::string& set) { return set.starts_with("contact.kind "); };
  if (std::ranges::none_of(with_its_own, is_kind)) with_its_own.insert(with_its_own.begin(), kind);
  std::optional<results::TriedRemedy> of_both = try_whole_runs(trouble, {with_its_own}, rerun);
  if (!of_both) return remedy;
  of_both->attempts += remedy->attempts + 1;
  return of_both->works() || remedy->settings.empty() ? of_both : remedy;
}

}  // namespace hvp::app
