#include <CLI/CLI.hpp>
#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/design/design_figures.h"
#include "app/results/design_report.h"
#include "app/results/figures.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

struct DeviceArguments : ScenarioArguments {
  bool json = false;
};

// Returns status 1 if the system does not fit its FPGA or the clock is not reached.
int device_command(const DeviceArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Scene scene = build_scene(loaded, make_progress(arguments.quiet), Scene::Limits::reported);
  end_progress(arguments.quiet);
  if (!scene.has_board()) {
    throw loaded.document.complete(InputError(
        "host.solver", "no board is built, whose device this would be: expected \"board\""));
  }
  const DesignFigures figures = design_figures(scene);
  if (arguments.json) {
    print("{}\n", results::figures_json(results::design_report(scene, figures)).dump(2));
  } else {
    print("{}", results::design_text(scene, figures));
  }
  const bool held = figures.usage.fits() && figures.clock_is_reached(scene.scenario().accelerator);
  return held ? kHeld : kNotHeld;
}

}  // namespace

void add_device(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<DeviceArguments>();
  CLI::App* command = app.add_subcommand(
      "device",
      "the accelerator of a scenario: cycles, critical path, memory, largest mesh, what if");
  add_scenario_arguments(*command, *arguments);
  command->add_flag("--json", arguments->json, "as one JSON object");
  command->callback([arguments, &status] { status = device_command(*arguments); });
}

}  // namespace hvp::app
