#include "app/results/reference_json.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/results/design_report.h"
#include "app/results/figure_list.h"
#include "app/results/frames_csv.h"
#include "app/results/keys_json.h"
#include "app/results/outcome.h"
#include "app/results/performance.h"
#include "app/scene/scenario.h"
#include "app/stability/stability_search.h"
#include "models/stability/flag.h"

namespace hvp::results {

namespace {

using nlohmann::ordered_json;

constexpr std::string_view kTable = ".*";

// The figures themselves, or the tables that have a line of help of their own.
enum class Which { figures, tables };

ordered_json listed(const std::vector<ListedFigure>& all, Which which) {
  ordered_json list = ordered_json::array();
  for (const ListedFigure& figure : all) {
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
  return listed(declared_figures<Part>(), Which::figures);
}

void append(ordered_json& list, const std::vector<FrameColumn>& columns) {
  for (const FrameColumn& column : columns) {
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
  KeysJson keys;
  app::Scenario scenario;
  keys.visit(scenario);
  j["keys"] = keys.keys();
  j["effects"] = keys.effects();
  j["figures"] = figures_of_declaration<Outcome>();
  j["figure_tables"] = listed(declared_figures<Outcome>(), Which::tables);
  j["device_figures"] = figures_of_declaration<DesignReport>();
  j["stability_figures"] = figures_of_declaration<app::StabilityFigures>();
  j["performance_figures"] = figures_of_declaration<Performance>();
  j["columns"] = ordered_json::array();
  append(j["columns"], frame_columns());
  j["further_columns"] = ordered_json::array();
  const ProbeColumns all{std::vector<plant::Trajectory>(2), true, true, plant::Hand{}};
  for (std::size_t probe = 0; probe < 2; ++probe) {
    append(j["further_columns"], probe_columns(all, probe));
  }
  j["flags"] = flags_json();
  return j.dump(2) + "\n";
}

}  // namespace hvp::results
