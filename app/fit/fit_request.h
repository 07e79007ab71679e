#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/fit/fit_figures.h"
#include "app/scenario/document.h"
#include "app/scenario/reader.h"
#include "app/scene/scenario.h"
#include "models/files/log_table.h"
#include "models/fit/fit.h"

namespace hvp::app {

// The request of one `hvp fit`.
struct FitRequest {
  std::filesystem::path log;
  std::filesystem::path out_folder;    // of the table for a scenario; empty: the present one
  files::LogOptions reading;           // columns, sample rate, size of a count
  std::vector<std::string> overrides;  // --set, for the model's own settings
  std::optional<Scenario> scenario;    // for models that need a body
  fit::Options options;
  // The part of the log that is fitted, of equal ones: one part is the whole log. For models that
  // may begin anywhere in a log.
  std::size_t part = 0;
  std::size_t parts = 1;

  // Reads these quantities of the log, as far as it contains them.
  files::Log read(std::vector<std::string> quantities) const;
};

// The log, the model and their difference for each sample; NaN separates stretches.
struct FitPlot {
  std::string x_label;  // "time (s)"
  std::string y_label;  // "force"
  std::string unit;     // "N"
  std::vector<double> x;
  std::vector<double> observed;
  std::vector<double> residual;

  void part();  // the next sample is another stretch's
  void add(double at, double seen, double left);
  // Adds the residuals of consecutive stretches of a log; `first` is the index of their first
  // sample.
  void add_stretches(const std::vector<double>& time, const std::vector<double>& seen,
                     const std::vector<std::vector<double>>& left, std::size_t first = 0);
};

struct FitOutcome {
  FitFigures figures;
  std::vector<FittedSetting> settings;
  FitPlot plot;
  // The settings of other values of the same parameters; empty where the model has none.
  std::function<std::vector<FittedSetting>(const fit::Fit&)> settings_of = {};
};

// A model of `hvp fit`. `fit` reads the log, fits the model and returns its values as keys of a
// scenario. Throws InputError for an unsuitable log.
struct FitModel {
  std::string_view name;
  std::string_view help;
  FitOutcome (*fit)(const FitRequest& request);
  bool several = true;  // whether several logs can be put together
  bool parts = false;   // whether a part of a log can be fitted by itself
};
const std::vector<FitModel>& fit_models();
// Throws InputError that lists the models if there is none of that name.
const FitModel& fit_model(std::string_view name);

// Fits of the individual models.
FitOutcome fit_device(const FitRequest& request);
FitOutcome fit_hand(const FitRequest& request);
FitOutcome fit_qlv(const FitRequest& request);
FitOutcome fit_tissue(const FitRequest& request);
FitOutcome fit_bus(const FitRequest& request);
FitOutcome fit_host(const FitRequest& request);

// The figures that all models have in common. The warnings of the reader and the model come before
// those of the fit.
FitFigures figures_of(std::string_view model, const files::Log& log, std::string_view unit,
                      fit::Fit fit, const std::vector<std::string>& of_model);

// Returns the longest stretch without a gap, with a warning if the log has gaps, or the part of it
// that is asked for. Throws InputError if the log is not evenly spaced.
files::Log longest_stretch(files::Log log, const FitRequest& request);

// Returns the estimate of a parameter of the fit. `name` must exist.
const fit::Estimate& estimate(const fit::Fit& fit, std::string_view name);

// Reads a model's own settings from the overrides of --set.
template <class Settings>
Settings model_settings(const std::vector<std::string>& overrides) {
  Settings settings;
  scenario::read(scenario::Document::of_overrides(overrides), settings);
  return settings;
}

}  // namespace hvp::app
