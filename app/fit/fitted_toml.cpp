#include "app/fit/fitted_toml.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "models/files/one_line.h"

namespace hvp::app {

namespace {

const fit::Estimate* find(const FitFigures& figures, const std::string& name) {
  const std::vector<fit::Estimate>& all = figures.fit.parameters;
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const fit::Estimate& e) { return e.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string interval(const fit::Estimate& e) {
  if (e.fixed) return "fixed";
  return fmt::format("95 %: {:.6g} to {:.6g} {}", e.low, e.high, e.unit);
}

}  // namespace

std::string toml_quantity(double value, std::string_view unit) {
  return fmt::format("\"{} {}\"", results::shortest(value), unit);
}

std::string fitted_toml(const FitFigures& figures, const std::vector<FittedSetting>& settings) {
  std::string text =
      fmt::format("# {} fitted to {} by hvp fit: {:.4g} {} rms left over{}\n", figures.model,
                  files::one_line(figures.log), figures.fit.residual_rms, figures.residual_unit,
                  figures.fit.converged ? "" : ", NOT CONVERGED");
  for (const std::string& w : figures.warnings) {
    text += fmt::format("# note: {}\n", files::one_line(w, 1000));
  }
  for (const fit::Estimate& e : figures.fit.parameters) {
    const bool used = std::any_of(settings.begin(), settings.end(),
                                  [&](const FittedSetting& s) { return s.parameter == e.name; });
    if (!used) text += fmt::format("# {} = {:.6g} {} ({})\n", e.name, e.value, e.unit, interval(e));
  }
  // A table stands once, where its first key does.
  std::vector<FittedSetting> ordered;
  for (const FittedSetting& of : settings) {
    const bool first = std::none_of(ordered.begin(), ordered.end(),
                                    [&](const FittedSetting& s) { return s.table == of.table; });
    if (!first) continue;
    std::copy_if(settings.begin(), settings.end(), std::back_inserter(ordered),
                 [&](const FittedSetting& s) { return s.table == of.table; });
  }
  std::string table;
  for (const FittedSetting& s : ordered) {
    const fit::Estimate* e = find(figures, s.parameter);
    if (s.table != table) text += fmt::format("\n[{}]\n", s.table);
    table = s.table;
    const bool given = e == nullptr || e->identifiable;
    text += fmt::format("{}{} = {}", given ? "" : "# ", s.key, s.value);
    if (e != nullptr) text += fmt::format("  # {}", given ? interval(*e) : "not given by this log");
    text += '\n';
  }
  return text;
}

}  // namespace hvp::app
