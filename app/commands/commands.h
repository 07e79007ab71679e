#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/scene/loaded_scenario.h"
#include "app/scene/scene.h"

// One function a command. Each returns the exit status and throws InputError for wrong input.
namespace hvp::app {

enum ExitStatus { kHeld = 0, kNotHeld = 1, kWrongInput = 2, kFailed = 3 };

struct ScenarioArguments : ScenarioSource {
  bool quiet = false;
};

struct RunArguments : ScenarioArguments {
  std::filesystem::path out;  // empty: runs/<scenario>
  bool trace_registers = false;
  bool record_jobs = false;  // settings, matrix, b and U of each job, for another host
  bool details = false;      // the report has times by phase and by bus transaction
};
int run_command(const RunArguments& arguments);

struct LinuxArguments : ScenarioArguments {
  std::filesystem::path kernel;  // empty: the one that driver/linux/kernel/build.sh has built
  std::filesystem::path initrd;  // likewise
  std::filesystem::path script;  // empty: none
  std::filesystem::path out;     // empty: runs/<scenario>-linux
  std::string memory = "64M";    // the guest's
  std::vector<std::string> kernel_arguments;
  double patience_s = 60;  // of wall-clock time without a word of the guest
  bool gdb = false;        // the kernel waits for a debugger, and nobody loses patience with it
  bool trace_registers = false;
};
// Exit status 3 where the guest did not end as it should, or its script failed.
int linux_command(const LinuxArguments& arguments);

struct ResolveArguments : ScenarioArguments {
  bool each = false;  // for every line of the standard input, with its overrides
};
int resolve_command(const ResolveArguments& arguments);

struct ExplainArguments : ScenarioArguments {
  bool json = false;
  bool measure = false;  // each effect's wall-clock time, by runs
};
int explain_command(const ExplainArguments& arguments);

struct DeviceArguments : ScenarioArguments {
  bool json = false;
};
// Exit status 1 where the system does not fit its device or the clock is not reached.
int device_command(const DeviceArguments& arguments);

struct StabilityArguments : ScenarioArguments {
  bool json = false;
  std::filesystem::path map;  // a picture; empty: none
  double push_N = 1;
  int frames = 2000;  // of each run
};
int stability_command(const StabilityArguments& arguments);

struct FitArguments {
  std::filesystem::path log;
  std::string model;
  std::filesystem::path out;   // a table for a scenario; empty: none
  std::filesystem::path plot;  // a picture; empty: none
  bool json = false;
  bool quiet = false;
  double hold_out = 0.2;
  int starts = 8;
  std::string loss = "squares";
  std::uint64_t seed = 1;
  std::vector<std::string> fixed;     // --fix NAME=VALUE
  std::vector<std::string> columns;   // --column QUANTITY_UNIT=NAME
  std::optional<double> sample_rate;  // Hz
  std::optional<double> count_size;   // of a position in counts
  std::string count_unit = "rad";
  std::vector<std::string> overrides;  // --set KEY=VALUE, of the model
  std::filesystem::path scenario;      // of a body
};
// Exit status 1 where the search did not converge.
int fit_command(const FitArguments& arguments);

struct ExportArguments : ScenarioArguments {
  std::filesystem::path out;
};
int export_command(const ExportArguments& arguments);

struct MeshArguments {
  std::string surface;  // a file, "sphere" or "box"
  std::string unit;     // of a file; empty: the default, like size
  std::string size;     // of a sphere or box
  int nodes = 500;
  std::filesystem::path out;
  bool quiet = false;
};
int mesh_command(const MeshArguments& arguments);

struct SolveArguments {
  std::filesystem::path matrix;
  std::filesystem::path rhs;
  std::filesystem::path solution = "solution.mtx";
  std::vector<std::string> overrides;  // --set key=value
  std::optional<double> tolerance;     // of error_rel; given: exit 1 beyond it
  std::string kernel;                  // in place of the environment's HVP_KERNEL
};
int solve_command(const SolveArguments& arguments);

struct ServeArguments : ScenarioArguments {
  std::filesystem::path socket;
  bool once = false;  // ends with its first client
  bool trace_registers = false;
  std::filesystem::path out;  // of the trace; empty: runs/<scenario>-serve
};
int serve_command(const ServeArguments& arguments);

struct ReferenceArguments {
  bool results = false;  // docs/results-reference.md in place of docs/scenario-reference.md
  bool json = false;     // all that is declared, in place of a page
};
int reference_command(const ReferenceArguments& arguments);

LoadedScenario load(const ScenarioArguments& arguments);
// Where `hvp run` writes without --out: runs/thesis, and for a what-if a folder of its own,
// runs/thesis+frames=300.
std::filesystem::path results_folder(const ScenarioArguments& arguments);

// The scenario's system; what it throws names the line of the scenario.
Scene build_scene(const LoadedScenario& loaded, const Progress& progress,
                  Scene::Limits limits = Scene::Limits::refused);

// Throws InputError that begins with `chosen_by` where HVP_KERNEL names no kernel of this machine.
void check_kernel(const std::string& chosen_by);

// Progress to stderr, and only to a terminal.
Progress make_progress(bool quiet);
// Wipes the line that progress stands on.
void end_progress(bool quiet);

}  // namespace hvp::app
