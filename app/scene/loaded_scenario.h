#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/scenario/document.h"
#include "app/scene/scenario.h"
#include "models/accel/device.h"

namespace hvp::app {

// The scenario as a user names it.
struct ScenarioSource {
  std::filesystem::path scenario;
  std::vector<std::filesystem::path> includes;  // laid over the scenario
  std::vector<std::string> overrides;           // --set key=value, laid over both
};

// The scenario, read and checked, with the document from which errors take their lines.
struct LoadedScenario {
  scenario::Document document;
  Scenario scenario;
  accel::Device device;
  std::filesystem::path device_file;  // can be opened; empty for a built-in device
  std::string arguments;              // of the command line, as a shell takes them; may be empty
};

// Loads the scenario without adding the overrides to its title. Throws InputError, complete with
// file and line.
LoadedScenario load_untitled(const ScenarioSource& source);
// The same of a document that is not a file of its own.
LoadedScenario read_document(scenario::Document document);

// Throws InputError if the scenario has no board ([wall], a host that solves) or a board without
// words (`fidelity.numbers`); for a loaded one it is complete with file and line.
void require_board_with_words(const Scenario& scenario);
void require_board_with_words(const LoadedScenario& loaded);

// Reads the user's files of samples, from which effects draw, into the scenario. Throws InputError
// with the full key.
void take_samples(Scenario& scenario);

}  // namespace hvp::app
