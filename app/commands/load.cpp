#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/commands.h"
#include "app/devices/devices.h"
#include "app/scenario/files.h"
#include "app/scenario/message.h"
#include "app/scenario/reader.h"
#include "models/config/input_error.h"
#include "models/fixed/kernel.h"

namespace hvp::app {

LoadedScenario load(const ScenarioArguments& arguments) {
  LoadedScenario loaded{
      scenario::Document::load(arguments.scenario, arguments.overrides), {}, {}, {}, {}};
  scenario::read(loaded.document, loaded.scenario);
  loaded.openable = loaded.scenario;
  scenario::resolve_files(loaded.document, loaded.openable);
  const accel::Architecture& accelerator = loaded.scenario.accelerator;
  loaded.device = devices::find(loaded.document, accelerator);
  loaded.device_file = devices::openable(loaded.document, accelerator.device);
  return loaded;
}

Scene build_scene(const LoadedScenario& loaded, const Progress& progress, Scene::Limits limits) {
  try {
    return {loaded.openable, loaded.scenario, loaded.device, progress, limits};
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
}

void check_kernel(const std::string& chosen_by) {
  try {
    fixed::chosen_kernel();
  } catch (const InputError& e) {
    throw InputError(scenario::one_line(fmt::format("{}: {}", chosen_by, e.what())));
  }
}

Progress make_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [](std::string_view what) {
    fmt::print(stderr, "\r\033[K{} …", scenario::one_line(what));
    std::fflush(stderr);
  };
}

void end_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r\033[K");
}

}  // namespace hvp::app
