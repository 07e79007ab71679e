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

std::string remedy_text(const TriedRemedy& r, std::int64_t budget_ps) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (!r.left.empty()) {
    fmt::format_to(out, "  no remedy       {} tried on {}: each leaves a flag ({})\n",
                   counted(r.attempts, "setting"),
                   counted(static_cast<std::int64_t>(r.frames), "frame"),
                   fmt::join(flag_names(r.left), ", "));
    return text;
  }
  fmt::format_to(out, "  what would help {}\n", override_line(r.settings));
  fmt::format_to(out, "    tried on      {} of this run: no flags",
                 counted(static_cast<std::int64_t>(r.frames), "frame"));
  if (r.p95 > 0) {
    fmt::format_to(out,
                   ", displacement {} from the true model (median; 95 % of the frames within {})",
                   percent(r.median), percent(r.p95));
  }
  fmt::format_to(out, "\n");
  if (r.frame_ps_before > 0) {
    fmt::format_to(
        out, "    costs         a frame's large steps take {} instead of {}, {} a budget of {}\n",
        readable_time(r.frame_ps), readable_time(r.frame_ps_before),
        r.frame_ps <= budget_ps ? "within" : "beyond", readable_time(budget_ps));
  }
  if (!r.fits) fmt::format_to(out, "    does not fit  {}\n", r.shortage);
  return text;
}

nlohmann::ordered_json solve_remedy_json(const TriedRemedy& r) {
  nlohmann::ordered_json j = remedy_json(r);
  for (const char* of_a_run : {"frames", "displacement_p95_rel", "frame_us"}) j.erase(of_a_run);
  j["error_rel"] = r.median;
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
  j["line"] = r.left.empty() ? override_line(r.settings) : "";
  j["displacement_median_rel"] = r.median;
  j["displacement_p95_rel"] = r.p95;
  j["fits"] = r.fits;
  j["frame_us"] = static_cast<double>(r.frame_ps) * 1e-6;
  return j;
}

}  // namespace hvp::results
