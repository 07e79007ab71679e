#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/config/figures.h"
#include "models/fit/fit.h"

namespace hvp::app {

// What `hvp fit` says of a log: its --json.
struct FitFigures {
  std::string model;
  std::string log;  // the file's name
  std::int64_t samples = 0;
  std::string residual_unit;
  fit::Fit fit;
  std::vector<std::string> warnings;  // of the reader, the model and the fit

  void report(config::Figures& f) const;
};

// The same for a terminal.
std::string fit_text(const FitFigures& figures);

}  // namespace hvp::app
