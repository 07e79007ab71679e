#pragma once

#include <string>
#include <vector>

#include "app/fit/fit_figures.h"

namespace hvp::app {

// What a parameter is in a scenario.
struct FittedSetting {
  std::string table;      // "device.dynamics"
  std::string key;        // "mass"
  std::string value;      // as a scenario writes it: "\"0.1 kg\""
  std::string parameter;  // whose interval is said beside it; empty: none
};

// A file that a scenario takes with `include`: a table a line group, each value with its interval.
// What the log does not give is there as a comment, and so is what no key stands for.
std::string fitted_toml(const FitFigures& figures, const std::vector<FittedSetting>& settings);

// A quantity as a scenario writes it: "\"0.1 kg\"".
std::string toml_quantity(double value, std::string_view unit);

}  // namespace hvp::app
