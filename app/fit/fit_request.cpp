#include "app/fit/fit_request.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/files/one_line.h"

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

void FitPlot::add_stretches(const std::vector<double>& time, const std::vector<double>& seen,
                            const std::vector<std::vector<double>>& left, std::size_t first) {
  std::size_t sample = first;
  for (const std::vector<double>& stretch : left) {
    part();
    for (const double rest : stretch) {
      add(time[sample], seen[sample], rest);
      ++sample;
    }
  }
}

namespace {

// Leaves the samples of a stretch.
void cut(files::Log& log, const files::Stretch& stretch) {
  const auto keep = [&](std::vector<double>& values) {
    values = {values.begin() + static_cast<std::ptrdiff_t>(stretch.begin),
              values.begin() + static_cast<std::ptrdiff_t>(stretch.end)};
  };
  keep(log.time);
  for (files::LogColumn& column : log.columns) keep(column.values);
  log.samples = log.time.size();
  log.spacing.stretches = {{0, log.samples}};
}

}  // namespace

files::Log longest_stretch(files::Log log, const FitRequest& request) {
  if (!log.spacing.even) {
    // The last warning has the line of the stamp that strays farthest, and how far.
    throw InputError(
        fmt::format("{}; expected a constant rate, or --rate where only the time stamps are uneven",
                    log.warnings.empty() ? files::one_line(log.file) : log.warnings.back()));
  }
  const auto longer = [](const files::Stretch& a, const files::Stretch& b) {
    return a.end - a.begin < b.end - b.begin;
  };
  const std::vector<files::Stretch>& all = log.spacing.stretches;
  const files::Stretch longest = *std::max_element(all.begin(), all.end(), longer);
  if (longest.end - longest.begin != log.samples) {
    const std::size_t whole = log.samples;
    cut(log, longest);
    log.warnings.push_back(
        fmt::format("{}: of {} samples the {} of the longest stretch without a gap are fitted",
                    files::one_line(log.file), whole, log.samples));
  }
  if (request.parts > 1) {
    const std::size_t samples = log.samples;
    cut(log,
        {samples * request.part / request.parts, samples * (request.part + 1) / request.parts});
  }
  return log;
}

const std::vector<FitModel>& fit_models() {
  static const std::vector<FitModel> kModels = {
      {"device", "mass, friction, delay of an axis from its command and its position", fit_device,
       true, true},
      {"hand", "mass, stiffness and damping of a hand from force and position", fit_hand, true,
       true},
      {"qlv", "soft tissue under an indenter, quasi-linear viscoelastic", fit_qlv},
      {"tissue", "a scenario's body from force and displacement at a contact", fit_tissue},
      {"bus", "latency and bandwidth of a link from sizes and times", fit_bus},
      {"host", "how wake-up latency is distributed, from cyclictest's histogram", fit_host, false}};
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
      fmt::format("--model {}: expected one of {}", files::one_line(std::string(name)), names));
}

FitFigures figures_of(std::string_view model, const files::Log& log, std::string_view unit,
                      fit::Fit fit, const std::vector<std::string>& of_model) {
  FitFigures figures;
  figures.model = model;
  figures.log = std::filesystem::path(log.file).filename().string();
  for (const std::vector<double>& stretch : fit.residuals) {
    figures.samples += static_cast<std::int64_t>(stretch.size());
  }
  figures.residual_unit = unit;
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
