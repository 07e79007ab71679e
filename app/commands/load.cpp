#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/commands.h"
#include "app/scenario/reader.h"

namespace hvp::app {

LoadedScenario load(const ScenarioArguments& arguments) {
  LoadedScenario loaded{scenario::Document::load(arguments.scenario, arguments.overrides), {}, {}};
  scenario::read(loaded.document, loaded.scenario);
  loaded.openable = loaded.scenario;
  std::string& surface = loaded.openable.object.mesh.surface;
  if (!surface.empty()) surface = loaded.document.resolve(surface).string();
  return loaded;
}

Progress make_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [](std::string_view what) {
    fmt::print(stderr, "\r\033[K{} …", what);
    std::fflush(stderr);
  };
}

void end_progress(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r\033[K");
}

}  // namespace hvp::app
