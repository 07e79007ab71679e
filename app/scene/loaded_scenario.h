#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/scenario/document.h"
#include "app/scene/scenario.h"
#include "models/accel/device.h"

namespace hvp::app {

// A scenario as a user names it.
struct ScenarioSource {
  std::filesystem::path scenario;
  std::vector<std::filesystem::path> includes;  // laid over it
  std::vector<std::string> overrides;           // --set key=value, over both
};

// It, read and checked, with the text that errors name the lines of.
struct LoadedScenario {
  scenario::Document document;
  Scenario scenario;
  accel::Device device;
  std::filesystem::path device_file;  // that can be opened; empty for a built-in device
};

// Its title stays the scenario's own, whatever --set changes. Throws InputError, complete with file
// and line.
LoadedScenario load_untitled(const ScenarioSource& source);

// Reads what effects draw from the user's own files into the scenario. Throws InputError with the
// full key.
void take_samples(Scenario& scenario);

}  // namespace hvp::app
