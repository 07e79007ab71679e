#include "app/results/tried_remedy.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/results/figures_json.h"
#include "app/results/flag_json.h"
#include "app/results/number_text.h"

namespace hvp::results {

std::string override_text(std::string_view setting) {
  std::string text;
  // Neither the blanks nor the quotes of TOML have to be there, and a shell would take them.
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
  if (r.settings.empty()) {
    fmt::format_to(out, "  no remedy       {} tried on {} of this run, each leaves a flag: {}\n",
                   counted(r.attempts, "setting"), frames, fmt::join(flag_names(r.left), ", "));
    return text;
  }
  fmt::format_to(out, "  what would help {}\n", override_line(r.settings));
  if (r.left.empty()) {
    fmt::format_to(out, "    tried on      {} of this run: no flags", frames);
  } else {
    fmt::format_to(out, "    tried on      {} of this run: leaves {}", frames,
                   fmt::join(flag_names(r.left), ", "));
  }
  if (r.p95 > 0) {
    fmt::format_to(out,
                   ", displacement {} from the true model (median; 95 % of the frames within {})",
                   percent(r.median), percent(r.p95));
  }
  fmt::format_to(out, "\n");
  if (r.after.latency_ps > 0) {
    fmt::format_to(
        out,
        "    costs         worst force after about {} instead of {}, load {} instead of {}: {}\n",
        readable_time(r.after.latency_ps), readable_time(r.before.latency_ps),
        readable_time(r.after.load_ps), readable_time(r.before.load_ps),
        r.in_time ? "in time" : "beyond the budget");
  }
  if (!r.fits) fmt::format_to(out, "    does not fit  {}\n", r.shortage);
  return text;
}

nlohmann::ordered_json solve_remedy_json(const TriedRemedy& r) {
  nlohmann::ordered_json j = figures_json(r);
  for (const char* of_a_run :
       {"frames", "displacement_p95_rel", "latency_us", "load_us", "in_time"}) {
    j.erase(of_a_run);
  }
  j["error_rel"] = r.left.empty() ? nlohmann::ordered_json(r.median) : nullptr;
  if (!r.left.empty()) j["fits"] = nullptr;
  j.erase("displacement_median_rel");
  return j;
}

void TriedRemedy::report(config::Figures& f) const {
  std::vector<std::string> set;
  std::ranges::transform(settings, std::back_inserter(set), override_text);
  f.value("of", flag_names(of), {}, "the flags that it was looked for");
  f.truth("works", left.empty(), "it leaves none");
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
  f.quantity("latency_us", us(after.latency_ps), config::kMicroseconds,
             "what the worst latency comes to, by the annotated costs of a frame's large steps");
  f.quantity("load_us", us(after.load_ps), config::kMicroseconds, "and the worst load");
  f.truth("in_time", in_time, "those are within the budget and the period");
}

}  // namespace hvp::results
