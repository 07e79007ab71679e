#include "app/fit/fit_request.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "models/config/input_error.h"

namespace hvp::app {

files::Log FitRequest::read(std::vector<std::string> quantities) const {
  files::LogOptions wanted = reading;
  wanted.quantities = std::move(quantities);
  return files::read_log(log, wanted);
}

void FitPlot::part() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!x.empty()) add(kNone, kNone, kNone);
}

void FitPlot::add(double at, double seen, double left) {
  x.push_back(at);
  observed.push_back(seen);
  residual.push_back(left);
}

const std::vector<FitModel>& fit_models() {
  static const std::vector<FitModel> kModels = {
      {"device", "mass, friction, delay of an axis from its command and its position", fit_device},
      {"qlv", "soft tissue under an indenter, quasi-linear viscoelastic", fit_qlv},
      {"tissue", "a scenario's body from force and displacement at a contact", fit_tissue}};
  return kModels;
}

const FitModel& fit_model(std::string_view name) {
  const std::vector<FitModel>& models = fit_models();
  const auto found =
      std::find_if(models.begin(), models.end(), [&](const FitModel& m) { return m.name == name; });
  if (found != models.end()) return *found;
  std::string names;
  for (const FitModel& m : models) names += (names.empty() ? "" : ", ") + std::string(m.name);
  throw InputError(
      fmt::format("--model {}: expected one of {}", scenario::one_line(std::string(name)), names));
}

FitFigures figures_of(std::string_view model, const files::Log& log, const fit::Problem& problem,
                      fit::Fit fit, const std::vector<std::string>& of_model) {
  FitFigures figures;
  figures.model = model;
  figures.log = std::filesystem::path(log.file).filename().string();
  for (const std::vector<double>& stretch : fit.residuals) {
    figures.samples += static_cast<std::int64_t>(stretch.size());
  }
  figures.residual_unit = problem.unit();
  figures.warnings = log.warnings;
  for (const std::string& w : of_model) figures.warnings.push_back(w);
  for (const std::string& w : fit.warnings) figures.warnings.push_back(w);
  figures.fit = std::move(fit);
  return figures;
}

const fit::Estimate& estimate(const fit::Fit& fit, std::string_view name) {
  for (const fit::Estimate& e : fit.parameters) {
    if (e.name == name) return e;
  }
  throw std::logic_error(fmt::format("no parameter {}", name));
}

}  // namespace hvp::app
