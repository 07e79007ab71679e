#include "app/draw/series_files.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/draw/run_files.h"
#include "models/config/input_error.h"
#include "models/files/csv.h"

namespace hvp::draw {

FitSeries read_fit(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  files::CsvTable table(file, path.filename().string());
  FitSeries series;
  series.title = table.title();
  const std::array<std::pair<std::size_t, std::vector<double>*>, 4> columns = {
      {{table.column("x"), &series.x},
       {table.column("observed"), &series.observed},
       {table.column("modelled"), &series.modelled},
       {table.column("residual"), &series.residual}}};
  double last = -std::numeric_limits<double>::infinity();
  bool any = false;
  while (table.next()) {
    for (const auto& [column, values] : columns) values->push_back(table.number_or_nan(column));
    const double x = series.x.back();
    if (std::isnan(x)) {
      series.x.back() = last;
      continue;
    }
    any = true;
    if (!std::isfinite(x) || x < last) {
      throw InputError(fmt::format("{}: x is '{}', expected no less than in the row before",
                                   table.where(), table.text(columns.front().first)));
    }
    last = x;
  }
  if (!any) throw InputError(table.name() + ": has no row");
  return series;
}

StabilityMap read_stability_map(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  files::CsvTable table(file, path.filename().string());
  StabilityMap map;
  map.title = table.title();
  const std::array<std::pair<std::string_view, std::vector<double>*>, 4> columns = {
      {{"damping_N_s_m", &map.damping_N_s_m},
       {"stiffness_max_N_m", &map.runs_N_m},
       {"stiffness_linear_N_m", &map.linear_N_m},
       {"stiffness_passive_N_m", &map.passive_N_m}}};
  const auto bad = [&](std::string_view name, const char* expected) {
    return InputError(fmt::format("{}: {} is '{}', expected {}", table.where(), name,
                                  table.text(table.column(name)), expected));
  };
  for (const auto& [name, values] : columns) table.column(name);
  while (table.next()) {
    for (const auto& [name, values] : columns) {
      const auto value = table.number<double>(table.column(name));
      if (!std::isfinite(value)) throw bad(name, "a finite number");
      values->push_back(value);
    }
    const std::vector<double>& damping = map.damping_N_s_m;
    if (damping.size() > kMostDampings)
      throw InputError(
          fmt::format("{}: expected no more than {} rows", table.where(), kMostDampings));
    if (damping.size() > 1 && damping.back() <= damping[damping.size() - 2])
      throw bad(columns.front().first, "more than in the row before");
  }
  if (map.damping_N_s_m.empty()) throw InputError(table.name() + ": has no row");
  return map;
}

}  // namespace hvp::draw
