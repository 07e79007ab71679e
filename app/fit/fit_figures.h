#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/config/figures.h"
#include "models/fit/fit.h"

namespace hvp::app {

// The result of `hvp fit` for a log, as --json prints it.
struct FitFigures {
  std::string model;
  std::string log;  // the file's name; of several, with commas between
  std::int64_t samples = 0;
  std::string residual_unit;
  fit::Fit fit;
  std::vector<std::string> warnings;  // from the reader, the model and the fit
  // Each of several logs, with its own values of the parameters; empty of one.
  struct OneLog {
    std::string log;
    std::int64_t samples = 0;
    double residual_rms = 0;
    std::vector<double> values;  // not a number: this log does not give it
  };
  std::vector<OneLog> logs;

  void report(config::Figures& f) const;
};

// The result as text for a terminal.
std::string fit_text(const FitFigures& figures);

// The key of a scenario that a fitted parameter determines.
struct FittedSetting {
  std::string table;      // "device.dynamics"
  std::string key;        // "mass"
  std::string value;      // as a scenario writes it: "\"0.1 kg\""
  std::string parameter;  // its interval stands beside the value; empty: none
  bool derived = false;   // the parameter is another quantity, from which the value follows
};

// A file that a scenario takes with `include`: a group of lines for each table, each value with its
// interval. Values that the log does not determine, and parameters without a key, are comments.
std::string fitted_toml(const FitFigures& figures, const std::vector<FittedSetting>& settings);

// Writes a quantity as a scenario does: "\"0.1 kg\"".
std::string toml_quantity(double value, std::string_view unit);

}  // namespace hvp::app
