#pragma once

#include <string>

#include "models/config/input_error.h"

namespace hvp::scenario {

// Something is wrong in a scenario or in what --set changed. what() is the complete line:
// "scenarios/x.toml:12: solver.iteratons: unknown key; did you mean "iterations"?"
class SourceError : public InputError {
 public:
  SourceError(std::string key, const std::string& line) : InputError(std::move(key), line) {}
  explicit SourceError(const std::string& line) : InputError(line) {}
};

}  // namespace hvp::scenario
