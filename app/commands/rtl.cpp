#include <CLI/CLI.hpp>
#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

struct RtlArguments : ScenarioArguments {
  bool cmake = false;
};

// Returns status 1 if this build does not have the size.
int rtl_command(const RtlArguments& arguments) {
  vp::require_rtl();
  const LoadedScenario loaded = load(arguments);
  try {
    // What a run at that level would refuse needs no engine.
    Scenario at_level = loaded.scenario;
    at_level.fidelity.accelerator = vp::Timing::rtl;
    at_level.check();
    const Scene scene(loaded.scenario, loaded.device, make_progress(arguments.quiet));
    end_progress(arguments.quiet);
    if (!scene.has_board()) {
      throw InputError("host.solver",
                       "no board is built, whose engine this would be: expected "
                       "\"board\"");
    }
    const Scenario& s = scene.scenario();
    within("accelerator", [&] { vp::require_rtl(s.accelerator); });
    within("solver", [&] { vp::require_rtl(scene.computation().board().settings()); });
    within("accelerator", [&] { vp::require_rtl(s.accelerator, s.solver); });
    const vp::RtlSize size = rtl_size(scene);
    if (arguments.cmake) {
      if (!size.built) print("hvp_scenario_size({} {})\n", size.identifier, size.parameters);
      return kHeld;
    }
    print("engine.sv for {}: {}\n", loaded.scenario.title, size.parameters);
    if (size.built) {
      print("fidelity.accelerator = \"rtl\" has it in this build\n");
    } else {
      print("this build does not have it; ./hvp rtl {} translates it\n", loaded.arguments);
    }
    return size.built ? kHeld : kNotHeld;
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
}

}  // namespace

void add_rtl(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<RtlArguments>();
  CLI::App* command = app.add_subcommand(
      "rtl",
      "the size of the engine in SystemVerilog for a scenario; ./hvp rtl translates and keeps it");
  add_scenario_arguments(*command, *arguments);
  // For ./hvp, which has the build add it: what CMake takes, and nothing if the size is there.
  command->add_flag("--cmake", arguments->cmake)->group("");
  command->callback([arguments, &status] { status = rtl_command(*arguments); });
}

}  // namespace hvp::app
