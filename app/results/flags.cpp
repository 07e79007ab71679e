#include "app/results/flags.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "app/results/figures.h"
#include "app/results/number_text.h"

namespace hvp::results {

namespace {
template <class Visit>
void for_each_flag(stability::Flags flags, const Visit& visit) {
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (flags.has(flag)) visit(stability::describe(flag));
  }
}
}  // namespace

std::vector<std::string> flag_names(stability::Flags flags) {
  std::vector<std::string> names;
  for_each_flag(flags, [&names](const stability::Description& d) { names.emplace_back(d.name); });
  return names;
}

stability::Flags flags_named(const std::vector<std::string>& names) {
  stability::Flags flags;
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (std::ranges::find(names, stability::describe(flag).name) != names.end()) flags.raise(flag);
  }
  return flags;
}

nlohmann::ordered_json remedies_json(stability::Flags flags) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for_each_flag(flags, [&list](const stability::Description& d) {
    list.push_back({{"flag", d.name}, {"meaning", d.meaning}, {"remedy", d.remedy}});
  });
  return list;
}

std::string override_text(std::string_view setting) {
  std::string text;
  // TOML's blanks and quotes are optional in --set, and a shell would remove them.
  std::ranges::copy_if(setting, std::back_inserter(text),
                       [](char c) { return c != ' ' && c != '"'; });
  return text;
}

std::string override_line(const std::vector<std::string>& settings) {
  std::string line;
  for (const std::string& setting : settings) {
    line += (line.empty() ? "--set " : " --set ") + override_text(setting);
  }
  return line;
}

std::string remedy_text(const TriedRemedy& r) {
  std::string text;
  const auto out = std::back_inserter(text);
  const std::string frames = counted(static_cast<std::int64_t>(r.frames), "frame");
  if (r.settings.empty() || r.taken_away().empty()) {
    fmt::format_to(out, "  no remedy       {} tried on {} of this run, each leaves a flag: {}\n",
                   counted(r.attempts, "setting"), frames, fmt::join(flag_names(r.left), ", "));
    return text;
  }
  fmt::format_to(out, "  what would help {}\n", override_line(r.settings));
  const std::string stays = r.left.empty()
                                ? std::string("no flag stays")
                                : fmt::format("stays: {}", fmt::join(flag_names(r.left), ", "));
  fmt::format_to(out, "    {:<13} takes away {}; {}{}\n",
                 r.whole_run ? "the whole run" : "not run whole",
                 fmt::join(flag_names(r.taken_away()), ", "), stays,
                 r.whole_run ? "; " + r.verdict : std::string());
  fmt::format_to(out, "    tried on      {}",
                 r.frames > 0 ? frames + " of it" : "no frame in which the body is displaced");
  if (r.p95 > 0) {
    fmt::format_to(out,
                   ", displacement {} from the true model (median; 95 % of the frames within {})",
                   percent(r.median), percent(r.p95));
  }
  fmt::format_to(out, "\n");
  if (r.after.latency_ps > 0) {
    fmt::format_to(
        out, "    costs         worst force after {}{} instead of {}, load {} instead of {}: {}\n",
        r.whole_run ? "" : "about ", readable_time(r.after.latency_ps),
        readable_time(r.before.latency_ps), readable_time(r.after.load_ps),
        readable_time(r.before.load_ps), r.in_time ? "in time" : "beyond the budget");
  }
  if (!r.fits) fmt::format_to(out, "    does not fit  {}\n", r.shortage);
  return text;
}

void TriedRemedy::report(config::Figures& f) const {
  std::vector<std::string> set;
  std::ranges::transform(settings, std::back_inserter(set), override_text);
  f.value("of", flag_names(of), {}, "the flags of the run");
  f.truth("works", works(), "it leaves none, and breaks no budget");
  f.truth("whole_run", whole_run,
          "the run itself was repeated with it, as printed; else what it leaves is that of "
          "`frames`, and what those do not show");
  f.text("verdict", verdict, "what that run is called; empty where there was none");
  f.value("takes_away", flag_names(taken_away()), {}, "the flags of the run that are gone with it");
  f.value("set", set, {}, "its `--set` arguments");
  f.value("leaves", flag_names(left), {}, "the flags that are left");
  f.count("attempts", attempts, "plans that were tried");
  f.count("frames", frames, "of the run, solved again with each");
  f.text("line", override_line(settings), "its `--set` arguments as a line");
  f.ratio("displacement_median_rel", median, "error against the true model");
  f.ratio("displacement_p95_rel", p95, "95 % of the frames are within it");
  f.truth("fits", fits, "the device holds it");
  const auto us = [this](std::int64_t ps) -> std::optional<double> {
    if (after.latency_ps <= 0) return std::nullopt;
    return static_cast<double>(ps) * 1e-6;
  };
  f.quantity(
      "latency_us", us(after.latency_ps), config::kMicroseconds,
      "what the worst latency comes to: measured over `whole_run`, else by the annotated costs "
      "of a frame's large steps");
  f.quantity("load_us", us(after.load_ps), config::kMicroseconds, "and the worst load");
  f.truth("in_time", in_time, "those are within the budget and the period");
}

}  // namespace hvp::results
