#pragma once

#include <string>
#include <vector>

#include "app/scenario/document.h"
#include "app/scenario/reader.h"

namespace hvp::app {

// A model's own settings, as --set gives them.
template <class Settings>
Settings model_settings(const std::vector<std::string>& overrides) {
  Settings settings;
  scenario::read(scenario::Document::of_overrides(overrides), settings);
  return settings;
}

}  // namespace hvp::app
