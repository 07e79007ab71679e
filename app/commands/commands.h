#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/scene/loaded_scenario.h"
#include "app/scene/scene.h"
#include "vp/fpga/rtl_timing.h"

// NOLINTNEXTLINE(readability-identifier-naming): the library's own name
namespace CLI {
class App;
}  // namespace CLI

// The program's commands, and what several of them use.
namespace hvp::app {

// A word of --check: the rules of docs/driver-rules.md.
inline constexpr const char* kCheckDriver = "driver";

enum ExitStatus { kHeld = 0, kNotHeld = 1, kWrongInput = 2, kFailed = 3 };

// Parses the command line and runs its command. Returns the exit status; throws what the command
// throws, InputError for wrong input.
int parse_and_run(int argc, char** argv);

// Each function adds one command with its options to the program. When the command line names it,
// the command runs during the parse and writes its exit status to `status`, which must outlive the
// parse.
using AddCommand = void (*)(CLI::App& app, int& status);
void add_run(CLI::App& app, int& status);
void add_explain(CLI::App& app, int& status);
void add_misses(CLI::App& app, int& status);
void add_device(CLI::App& app, int& status);
void add_stability(CLI::App& app, int& status);
void add_serve(CLI::App& app, int& status);
void add_linux(CLI::App& app, int& status);
void add_replay(CLI::App& app, int& status);
void add_fit(CLI::App& app, int& status);
void add_measure(CLI::App& app, int& status);
void add_solve(CLI::App& app, int& status);
void add_mesh(CLI::App& app, int& status);
void add_export(CLI::App& app, int& status);
void add_rtl(CLI::App& app, int& status);
void add_resolve(CLI::App& app, int& status);
void add_reference(CLI::App& app, int& status);
// The program's commands in the order of its help: of hvp all (all_commands.cpp), of hvp-run those
// that a first run needs (first_commands.cpp).
std::span<const AddCommand> commands();

// The arguments that all commands with a scenario have in common.
struct ScenarioArguments : ScenarioSource {
  bool quiet = false;
};
// `arguments` must outlive the command.
void add_scenario_arguments(CLI::App& command, ScenarioArguments& arguments);

// Reads and checks the scenario; its title lists the changes that the command line makes.
LoadedScenario load(const ScenarioArguments& arguments);
// The folder to which `hvp run` writes without --out: runs/thesis, and runs/thesis+frames=300 for a
// what-if.
std::filesystem::path results_folder(const ScenarioArguments& arguments);

// The scenario's system. Throws InputError with the line of the scenario; also where this build has
// the engine of the level rtl in other sizes only, unless limits are reported.
Scene build_scene(const LoadedScenario& loaded, const Progress& progress,
                  Scene::Limits limits = Scene::Limits::refused);

// The size of engine.sv for the scene's board. Throws InputError with the full key for what it does
// not have in any.
vp::RtlSize rtl_size(const Scene& scene);

// Throws InputError that begins with `chosen_by` where HVP_KERNEL names no kernel of this machine.
void check_kernel(const std::string& chosen_by);

// Titles and file names are a user's words and may contain any character: all of these functions
// escape those that a terminal would obey.
void print_text(std::string_view text);

// Prints to standard output.
template <class... Arguments>
void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}

// Prints one line to standard error.
void complain(std::string_view line);

// Progress is shown on standard error, and only if that is a terminal.
Progress make_progress(bool quiet);
// Wipes the line that shows the progress.
void end_progress(bool quiet);

}  // namespace hvp::app
