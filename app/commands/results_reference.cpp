#include "app/commands/results_reference.h"

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/misses/miss_search.h"
#include "app/record/replay_figures.h"
#include "app/results/design_report.h"
#include "app/results/figures.h"
#include "app/results/frames_csv.h"
#include "app/results/keys_json.h"
#include "app/results/outcome.h"
#include "app/scenario/outline.h"
#include "app/scene/scenario.h"
#include "app/stability/stability_search.h"
#include "models/stability/flag.h"

namespace hvp::app {

namespace {

// Of two probes, each with all that a device may have.
results::ProbeColumns all_columns() {
  return {std::vector<results::ProbeColumnsOf>(2, {{}, true, true, plant::Hand{}, true}),
          {},
          true,
          true,
          true,
          true};
}

using nlohmann::ordered_json;

constexpr std::string_view kTable = ".*";

// The figures themselves, or the tables that have a line of help of their own.
enum class Which { figures, tables };

ordered_json listed(const std::vector<results::ListedFigure>& all, Which which) {
  ordered_json list = ordered_json::array();
  for (const results::ListedFigure& figure : all) {
    const bool is_table = figure.key.ends_with(kTable);
    if (is_table != (which == Which::tables)) continue;
    if (is_table) {
      const std::string table = figure.key.substr(0, figure.key.size() - kTable.size());
      list.push_back({{"key", table}, {"help", figure.help}});
    } else {
      list.push_back({{"key", figure.key}, {"unit", figure.unit}, {"help", figure.help}});
    }
  }
  return list;
}

template <class Part>
ordered_json figures_of_declaration() {
  return listed(results::declared_figures<Part>(), Which::figures);
}

void append(ordered_json& list, const std::vector<results::FrameColumn>& columns) {
  for (const results::FrameColumn& column : columns) {
    list.push_back({{"name", column.name}, {"help", column.help}});
  }
}

ordered_json flags_json() {
  ordered_json list = ordered_json::array();
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const stability::Description& d = stability::describe(static_cast<stability::Flag>(i));
    list.push_back({{"name", d.name}, {"meaning", d.meaning}, {"remedy", d.remedy}});
  }
  return list;
}

}  // namespace

std::string reference_json(std::string_view version) {
  ordered_json j;
  j["version"] = version;
  const scenario::Outline outline = scenario::describe(Scenario{});
  j["keys"] = results::keys_json(outline);
  j["effects"] = results::effects_json(outline);
  j["figures"] = figures_of_declaration<results::Outcome>();
  j["figure_tables"] = listed(results::declared_figures<results::Outcome>(), Which::tables);
  j["device_figures"] = figures_of_declaration<results::DesignReport>();
  j["stability_figures"] = figures_of_declaration<StabilityFigures>();
  j["miss_figures"] = figures_of_declaration<MissFigures>();
  j["replay_figures"] = figures_of_declaration<record::ReplayFigures>();
  j["performance_figures"] = figures_of_declaration<results::Performance>();
  j["columns"] = ordered_json::array();
  append(j["columns"], results::frame_columns());
  j["further_columns"] = ordered_json::array();
  const results::ProbeColumns all = all_columns();
  for (std::size_t probe = 0; probe < 2; ++probe) {
    append(j["further_columns"], results::probe_columns(all, probe));
  }
  j["flags"] = flags_json();
  return j.dump(2) + "\n";
}

namespace {

constexpr std::string_view kHead = "| key | unit | what it is |\n|---|---|---|\n";

std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

// "deadline" of "deadline.worst_us", "faults[]" of "faults[].kind"; empty for a key of no table.
std::string_view table_of(std::string_view key) {
  const std::size_t end = key.find('.');
  return end == std::string_view::npos ? std::string_view() : key.substr(0, end);
}

// The keys of no table come first; tables in the order in which they begin.
std::string summary_section(const std::vector<results::ListedFigure>& figures) {
  std::vector<std::string_view> order = {""};
  std::map<std::string_view, std::string> sections = {{"", std::string(kHead)}};
  for (const results::ListedFigure& figure : figures) {
    const std::string_view table = table_of(figure.key);
    const bool heads = !table.empty() && figure.key == fmt::format("{}.*", table);
    const auto [at, is_new] = sections.try_emplace(table);
    if (is_new) order.push_back(table);
    if (is_new || heads) {
      at->second += fmt::format("\n### `{}`\n\n{}\n\n{}", table, heads ? figure.help : "", kHead);
    }
    if (heads) continue;
    at->second += fmt::format("| `{}` | {} | {} |\n", figure.key, figure.unit, cell(figure.help));
  }
  std::string text;
  for (const std::string_view table : order) text += sections[table];
  return text;
}

}  // namespace

std::string results_reference_page() {
  std::string text =
      "# Results reference\n\n"
      "Written from the declarations of the figures; do not edit. What the files are for stands in "
      "[results.md](results.md).\n\n"
      "## summary.json\n\n"
      "`a[].b` stands for `b` of each entry of the list `a`, `a.<item>.b` for `b` of any table in "
      "`a`, and `a.*` for all of the table `a`. Numbers are in SI units unless the key says "
      "otherwise. A line that says \"with\" is of a key that is left out elsewhere.\n\n";
  text += summary_section(results::declared_figures<results::Outcome>());
  text += "\n## frames.csv\n\n| column | what it is |\n|---|---|\n";
  for (const results::FrameColumn& column : results::frame_columns()) {
    text += fmt::format("| `{}` | {} |\n", column.name, cell(column.help));
  }
  const results::ProbeColumns all = all_columns();
  text +=
      "\nBehind these, with a proxy, with `[device.dynamics]` and for each further `[[probe]]`; "
      "names of a further probe begin with `probe1_`, `probe2_`, …\n\n"
      "| column | what it is |\n|---|---|\n";
  for (std::size_t i = 0; i < 2; ++i) {
    for (const results::FrameColumn& column : results::probe_columns(all, i)) {
      if (i == 1 && column.name.starts_with("probe1_tip")) break;
      text += fmt::format("| `{}` | {} |\n", column.name, cell(column.help));
    }
  }
  return text;
}

}  // namespace hvp::app
