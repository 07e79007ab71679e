#include "app/results/tried_remedy.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

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
  nlohmann::ordered_json j = remedy_json(r);
  for (const char* of_a_run :
       {"frames", "displacement_p95_rel", "latency_us", "load_us", "in_time"}) {
    j.erase(of_a_run);
  }
  j["error_rel"] = r.left.empty() ? nlohmann::ordered_json(r.median) : nullptr;
  if (!r.left.empty()) j["fits"] = nullptr;
  j.erase("displacement_median_rel");
  return j;
}

nlohmann::ordered_json remedy_json(const TriedRemedy& r) {
  nlohmann::ordered_json j;
  j["of"] = flag_names(r.of);
  j["works"] = r.left.empty();
  j["set"] = nlohmann::ordered_json::array();
  for (const std::string& setting : r.settings) j["set"].push_back(override_text(setting));
  j["leaves"] = flag_names(r.left);
  j["attempts"] = r.attempts;
  j["frames"] = r.frames;
  j["line"] = override_line(r.settings);
  j["displacement_median_rel"] = r.median;
  j["displacement_p95_rel"] = r.p95;
  j["fits"] = r.fits;
  const auto us = [&r](std::int64_t ps) {
    return r.after.latency_ps > 0 ? nlohmann::ordered_json(static_cast<double>(ps) * 1e-6)
                                  : nullptr;
  };
  j["latency_us"] = us(r.after.latency_ps);
  j["load_us"] = us(r.after.load_ps);
  j["in_time"] = r.in_time;
  return j;
}

}  // namespace hvp::results
