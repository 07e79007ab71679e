#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/fit/fit_figures.h"
#include "app/fit/fitted_toml.h"
#include "app/scene/scenario.h"
#include "models/files/log_table.h"
#include "models/fit/fit.h"

namespace hvp::app {

// What `hvp fit` is asked.
struct FitRequest {
  std::filesystem::path log;
  files::LogOptions reading;           // columns, sample rate, size of a count
  std::vector<std::string> overrides;  // --set, of the model's own settings
  std::optional<Scenario> scenario;    // of models that need a body
  fit::Options options;

  // The log, of which these quantities are read as far as it has them.
  files::Log read(std::vector<std::string> quantities) const;
};

// A log, its model and the difference, sample by sample; NaN between stretches that are apart.
struct FitPlot {
  std::string x_label;  // "time (s)"
  std::string y_label;  // "force"
  std::string unit;     // "N"
  std::vector<double> x;
  std::vector<double> observed;
  std::vector<double> residual;

  void part();  // the next sample is another stretch's
  void add(double at, double seen, double left);
  // Residuals of stretches that follow each other along a log from its first sample on.
  void add_stretches(const std::vector<double>& time, const std::vector<double>& seen,
                     const std::vector<std::vector<double>>& left, std::size_t first = 0);
};

struct FitOutcome {
  FitFigures figures;
  std::vector<FittedSetting> settings;
  FitPlot plot;
};

// A model of `hvp fit`: reads the log, fits it and says what its values are in a scenario. Throws
// InputError for a log that it cannot use.
struct FitModel {
  std::string_view name;
  std::string_view help;
  FitOutcome (*fit)(const FitRequest& request);
};
const std::vector<FitModel>& fit_models();
// Throws InputError with the names that there are.
const FitModel& fit_model(std::string_view name);

// The models.
FitOutcome fit_device(const FitRequest& request);
FitOutcome fit_hand(const FitRequest& request);
FitOutcome fit_qlv(const FitRequest& request);
FitOutcome fit_tissue(const FitRequest& request);
FitOutcome fit_bus(const FitRequest& request);
FitOutcome fit_host(const FitRequest& request);

// What all of them have in common: the figures of a fit of a log, with the warnings of the reader
// and of the model before those of the fit itself.
FitFigures figures_of(std::string_view model, const files::Log& log, std::string_view unit,
                      fit::Fit fit, const std::vector<std::string>& of_model);

// Of a log with gaps the longest stretch without one, with a warning. Throws InputError for a log
// that is not evenly spaced.
files::Log longest_stretch(files::Log log);

// The value of a parameter; its name is one of the fit's.
const fit::Estimate& estimate(const fit::Fit& fit, std::string_view name);

}  // namespace hvp::app
