#include "app/draw/fit_series.h"

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/draw/open_file.h"
#include "models/config/input_error.h"
#include "models/files/csv_table.h"

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

}  // namespace hvp::draw
