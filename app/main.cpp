#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <systemc>

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "app/commands/commands.h"
#include "models/config/input_error.h"

namespace {

using namespace hvp::app;

void scenario_arguments(CLI::App& command, ScenarioArguments& arguments) {
  command.add_option("scenario", arguments.scenario, "a scenario file (TOML)")->required();
  command
      .add_option("--set", arguments.overrides, "key=value: set a scenario key, as often as wanted")
      ->allow_extra_args(false);
  command.add_flag("--quiet", arguments.quiet, "no progress");
}

// Warnings of the run go to stderr, a line each, without a date that would differ between runs.
void set_up_log() {
  auto log =
      std::make_shared<spdlog::logger>("hvp", std::make_shared<spdlog::sinks::stderr_sink_st>());
  log->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(log));
}

int parse_and_run(int argc, char** argv) {
  CLI::App app{
      "A virtual platform of a haptic system: does it meet its deadline, is it accurate "
      "enough, is it stable?",
      "hvp"};
  app.require_subcommand(1);
  app.set_version_flag("--version", HVP_VERSION);
  app.footer(
      "Exit status: 0 every budget held; 1 a budget did not hold; 2 wrong input; 3 other.\n"
      "hvp test runs everything that CI runs.");
  int status = kHeld;

  RunArguments run;
  CLI::App* command = app.add_subcommand("run", "simulate a scenario; the verdict");
  scenario_arguments(*command, run);
  command->add_option("--out", run.out, "folder for the results (default runs/<scenario>)");
  command->add_flag("--trace-registers", run.trace_registers,
                    "log every access to the board in registers.log");
  command->callback([&] { status = run_command(run); });

  ScenarioArguments explain;
  command = app.add_subcommand("explain", "what a scenario builds, how finely, at what cost");
  scenario_arguments(*command, explain);
  command->callback([&] { status = explain_command(explain); });

  MeshArguments mesh;
  command = app.add_subcommand("mesh", "tetrahedra in a surface, and their quality");
  command->add_option("surface", mesh.surface, "STL, PLY, OBJ, VTP or VTU; or sphere, or box")
      ->required();
  command->add_option("--nodes", mesh.nodes, "how many nodes are wanted")
      ->check(CLI::Range(4, 10'000'000));
  command->add_option("--unit", mesh.unit, "one unit of the file (default \"1 mm\")");
  command->add_option("--size", mesh.size, "radius of the sphere, edge of the box: \"50 mm\"");
  command->add_option("--out", mesh.out, "a .vtu file to write");
  command->add_flag("--quiet", mesh.quiet, "no progress");
  command->callback([&] { status = mesh_command(mesh); });

  ExportArguments exporting;
  command = app.add_subcommand("export", "K, M, b (Matrix Market) and the mesh");
  scenario_arguments(*command, exporting);
  command->add_option("--out", exporting.out, "folder to write into")->required();
  command->callback([&] { status = export_command(exporting); });

  command = app.add_subcommand("reference", "print the reference page of scenario files");
  command->callback([&] { status = reference_command(); });

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);  // --help, --version
    return kHeld;
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "hvp: {} (hvp --help shows the commands)\n", e.what());
    return kWrongInput;
  }
  return status;
}

}  // namespace

// SystemC's library has a main of its own that calls this; it is not used.
int sc_main(int /*argc*/, char** /*argv*/) { return kFailed; }

int main(int argc, char** argv) {
  set_up_log();
  // "Simulation stopped by user" is how every run ends.
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  try {
    return parse_and_run(argc, argv);
  } catch (const hvp::InputError& e) {
    end_progress(false);
    fmt::print(stderr, "{}\n", e.what());
    return kWrongInput;
  } catch (const std::exception& e) {
    end_progress(false);
    fmt::print(stderr, "hvp: {}\n", e.what());
    return kFailed;
  }
}
