#include "app/draw/loop_series.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "app/draw/open_file.h"
#include "models/config/input_error.h"
#include "models/files/csv_table.h"

namespace hvp::draw {
namespace {

constexpr std::array kAxes = {'x', 'y', 'z'};

// A column of the file and where its values go.
struct Source {
  std::size_t column;
  std::vector<double>* values;
};

void add_sources(std::vector<Source>& sources, const files::CsvTable& table,
                 const std::string& prefix, ProbeSeries& probe) {
  const auto vector = [&](const char* quantity, const char* unit, auto& components) {
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const std::string name = fmt::format("{}{}_{}_{}", prefix, quantity, kAxes[axis], unit);
      sources.push_back({table.column(name), &components[axis]});
    }
  };
  vector("tip", "m", probe.tip_m);
  vector("intended", "m", probe.intended_m);
  vector("motor", "N", probe.motor_N);
  vector("hand", "N", probe.hand_N);
  sources.push_back({table.column(prefix + "stored_J"), &probe.stored_J});
  sources.push_back({table.column(prefix + "port_J"), &probe.port_J});
}

}  // namespace

std::optional<LoopSeries> read_loop(const std::filesystem::path& path) {
  std::ifstream file = open_file(path);
  files::CsvTable table(file, path.filename().string());
  std::vector<std::string> prefixes;
  for (std::string prefix; table.find(prefix + "tip_x_m");
       prefix = fmt::format("probe{}_", prefixes.size())) {
    prefixes.push_back(prefix);
  }
  if (prefixes.empty()) return {};

  LoopSeries out;
  out.probes.resize(prefixes.size());
  std::vector<Source> sources;
  for (std::size_t i = 0; i < prefixes.size(); ++i) {
    add_sources(sources, table, prefixes[i], out.probes[i]);
  }
  const std::size_t born = table.column("born_us");
  while (table.next()) {
    const double time_s = table.number<double>(born) * 1e-6;
    if (!std::isfinite(time_s) || (!out.time_s.empty() && time_s < out.time_s.back()))
      throw InputError(fmt::format("{}: born_us is '{}', expected no less than in the line before",
                                   table.where(), table.text(born)));
    out.time_s.push_back(time_s);
    for (const Source& source : sources) {
      source.values->push_back(table.number_or_nan(source.column));
    }
  }
  if (out.time_s.empty()) throw InputError(table.name() + ": has no frame");
  return out;
}

std::size_t main_axis(const ProbeSeries& probe) {
  std::size_t most = 0;
  double widest = -1.0;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const double width =
        std::max(range_of(probe.tip_m[axis]).size(), range_of(probe.intended_m[axis]).size());
    if (width > widest) most = axis;
    widest = std::max(widest, width);
  }
  return most;
}

void Range::include(const Range& other) {
  least = std::min(least, other.least);
  largest = std::max(largest, other.largest);
}

Range range_of(const std::vector<double>& values) {
  std::optional<Range> range;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (!range) range = {value, value};
    range->include({value, value});
  }
  return range.value_or(Range{});
}

}  // namespace hvp::draw
