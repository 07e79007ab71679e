#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <regex>
#include <stdexcept>
#include <string>
#include <systemc>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/commands/usage_error.h"
#include "app/results/interruption.h"
#include "models/config/input_error.h"

namespace {

using hvp::app::complain;
using hvp::app::describe_usage_error;
using hvp::app::device_command;
using hvp::app::DeviceArguments;
using hvp::app::end_progress;
using hvp::app::explain_command;
using hvp::app::ExplainArguments;
using hvp::app::export_command;
using hvp::app::ExportArguments;
using hvp::app::fit_command;
using hvp::app::FitArguments;
using hvp::app::kFailed;
using hvp::app::kHeld;
using hvp::app::kWrongInput;
using hvp::app::linux_command;
using hvp::app::LinuxArguments;
using hvp::app::mesh_command;
using hvp::app::MeshArguments;
using hvp::app::reference_command;
using hvp::app::ReferenceArguments;
using hvp::app::resolve_command;
using hvp::app::ResolveArguments;
using hvp::app::run_command;
using hvp::app::RunArguments;
using hvp::app::ScenarioArguments;
using hvp::app::serve_command;
using hvp::app::ServeArguments;
using hvp::app::solve_command;
using hvp::app::SolveArguments;
using hvp::app::stability_command;
using hvp::app::StabilityArguments;

void scenario_arguments(CLI::App& command, ScenarioArguments& arguments) {
  command.add_option("scenario", arguments.scenario, "a scenario file")
      ->required()
      ->type_name("FILE.toml");
  command
      .add_option("--include", arguments.includes,
                  "lays a file of some keys over the scenario; as often as wanted, the last on top")
      ->allow_extra_args(false)
      ->type_name("FILE.toml");
  command
      .add_option("--set", arguments.overrides,
                  "gives a key of the scenario another value; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_flag("--quiet", arguments.quiet, "no progress on the terminal");
}

void fit_arguments(CLI::App& command, FitArguments& a) {
  command
      .add_option("log", a.log, "a CSV file whose columns are named time_s, force_N, travel_mm …")
      ->required()
      ->type_name("LOG.csv");
  command.add_option("--model", a.model, "device, hand, qlv, tissue, bus or host")
      ->required()
      ->type_name("NAME");
  command.add_option("--out", a.out, "write a table that a scenario takes with `include`")
      ->type_name("FILE.toml");
  command.add_flag("--json", a.json, "as one JSON object");
  command.add_option("--plot", a.plot, "draw log, model and what is left over; samples beside it")
      ->type_name("FILE.png");
  command
      .add_option("--hold-out", a.hold_out,
                  "share of the log that another fit has to predict, 0.2 by default")
      ->check(CLI::Range(0.0, 0.9))
      ->type_name("SHARE");
  command.add_option("--fix", a.fixed, "a parameter's value is known; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("NAME=VALUE");
  command
      .add_option("--column", a.columns,
                  "a quantity is in a column of another name, or number; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("QUANTITY_UNIT=NAME");
  command.add_option("--rate", a.sample_rate, "samples a second, of a log without a time")
      ->check(CLI::Range(1e-3, 1e8))
      ->type_name("HZ");
  command.add_option("--count", a.count_size, "what a count of position_counts is")
      ->check(CLI::Range(1e-12, 1e3))
      ->type_name("SIZE");
  command.add_option("--count-unit", a.count_unit, "its unit, rad by default")
      ->check(CLI::IsMember({"m", "rad"}))
      ->type_name("UNIT");
  command.add_option("--starts", a.starts, "searches from different places, 8 by default")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  command
      .add_option("--loss", a.loss,
                  "squares, or huber or cauchy, for which outliers weigh less; of a bus cauchy")
      ->check(CLI::IsMember({"squares", "huber", "cauchy"}))
      ->type_name("NAME");
  command.add_option("--seed", a.seed, "of the searches' places, 1 by default")->type_name("N");
  command
      .add_option("--set", a.overrides,
                  "gives a setting of the model another value, such as elastic")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command.add_option("--scenario", a.scenario, "whose body the log is of: model tissue")
      ->type_name("FILE.toml");
  command.add_flag("--quiet", a.quiet, "no progress on the terminal");
}

void linux_arguments(CLI::App& command, LinuxArguments& a) {
  scenario_arguments(command, a);
  command
      .add_option(
          "--kernel", a.kernel,
          "a User-Mode Linux with time-travel and PCI over virtio, in place of the one that "
          "driver/linux/kernel/build.sh has built")
      ->type_name("FILE");
  command.add_option("--initrd", a.initrd, "its first file system, in place of the one built")
      ->type_name("FILE");
  command
      .add_option("--script", a.script,
                  "what the init of that is to run, with the guest's shell; its status counts")
      ->type_name("FILE");
  command.add_option("--out", a.out, "folder for the results in place of runs/<scenario>-linux")
      ->type_name("FOLDER");
  command.add_option("--memory", a.memory, "the guest's, 64M by default")
      ->check(CLI::Validator(
          [](const std::string& text) {
            const bool right = std::regex_match(text, std::regex("[1-9][0-9]{0,5}[MG]"));
            return right ? std::string() : "expected a size such as 64M, found " + text;
          },
          ""))
      ->type_name("SIZE");
  command
      .add_option("--kernel-argument", a.kernel_arguments,
                  "one more word of the kernel's command line; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("WORD");
  command
      .add_option("--patience", a.patience_s,
                  "seconds of wall-clock time without a word of the guest after which the run "
                  "ends, 60 by default")
      ->check(CLI::Range(1.0, 86400.0))
      ->type_name("S");
  command.add_flag("--gdb", a.gdb,
                   "a kernel with types and lines, stopped before its first instruction until gdb "
                   "lets it go on, which may take any time");
  command.add_flag("--trace-registers", a.trace_registers,
                   "also log every access to the board, in registers.log, and as a waveform with "
                   "the interrupt, in registers.vcd");
}

// An empty file name, folder or value means nothing.
void refuse_empty_values(CLI::App& app) {
  const CLI::Validator given(
      [](const std::string& text) {
        return text.empty() ? std::string("expected a value, found \"\"") : std::string();
      },
      "");
  for (CLI::App* command : app.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(given);
    }
  }
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
      "A virtual platform of a haptic system: does it meet its deadline, is it accurate\n"
      "enough, is it stable?\n\n"
      "  hvp run scenarios/thesis.toml\n"
      "  hvp run scenarios/thesis.toml --set solver.iterations=30 --set \"budget.period=1 ms\"",
      "hvp"};
  app.require_subcommand(1);
  app.set_help_flag("-h,--help", "what a command does and takes");
  app.set_version_flag("--version", "hvp " HVP_VERSION, "the program's version");
  app.footer(
      "Of many runs, by ./hvp of the checkout, which hands these to Python:\n"
      "  study    runs over axes, with screening and the price of accuracy\n"
      "  sweep    one scenario over values of a key\n"
      "  compare  two runs' settings, times, forces and flags\n"
      "  report   a page of a run or a study, for a browser\n"
      "  questions  the pages of docs/questions/, written anew from runs\n\n"
      "Exit status: 0 it ran and every budget held; 1 it ran and a budget did not hold;\n"
      "2 the input is wrong; 3 anything else. Ctrl-C ends a run after the frame at hand, with\n"
      "the results of those before, and the program as the signal would have.");
  int status = kHeld;

  RunArguments run;
  CLI::App* command =
      app.add_subcommand("run", "simulate a scenario and say whether its budgets held");
  scenario_arguments(*command, run);
  command
      ->add_option("--out", run.out,
                   "folder for the results in place of runs/<scenario>, with what --set changes")
      ->type_name("FOLDER");
  command->add_flag(
      "--trace-registers", run.trace_registers,
      "also log every access to the board, in registers.log, and as a waveform with the "
      "interrupt, in registers.vcd");
  command->add_flag(
      "--record-jobs", run.record_jobs,
      "also write what the board was asked and what it answered, jobs.hvpf and jobs.hvpu, for "
      "hvp-servo in a guest (docs/linux.md)");
  command->add_flag("--details", run.details,
                    "also report every frame's time by phase, and the bus' transactions");
  command->callback([&] { status = run_command(run); });

  ExplainArguments explain;
  command = app.add_subcommand("explain", "what a scenario builds, how finely, and what it costs");
  scenario_arguments(*command, explain);
  command->add_flag("--json", explain.json, "as one JSON object");
  command->add_flag("--measure", explain.measure,
                    "also what each effect costs in wall-clock time here, by some runs each; "
                    "half a minute or more");
  command->callback([&] { status = explain_command(explain); });

  DeviceArguments device;
  command = app.add_subcommand(
      "device",
      "the accelerator of a scenario: cycles, critical path, memory, largest mesh, what if");
  scenario_arguments(*command, device);
  command->add_flag("--json", device.json, "as one JSON object");
  command->callback([&] { status = device_command(device); });

  StabilityArguments stability;
  command = app.add_subcommand(
      "stability", "the stiffest wall that a scenario's loop holds, by runs and by eigenvalues");
  scenario_arguments(*command, stability);
  command->add_flag("--json", stability.json, "as one JSON object");
  command
      ->add_option("--map", stability.map,
                   "also draw the stiffest wall over its damping, and write its figures beside it")
      ->type_name("FILE.png");
  command
      ->add_option("--push", stability.push_N,
                   "with how many newtons the device leans on the wall, 1 by default")
      ->check(CLI::Range(1e-3, 1e3))
      ->type_name("N");
  command->add_option("--frames", stability.frames, "of each run, 2000 by default")
      ->check(CLI::Range(40, 10'000'000))
      ->type_name("N");
  command->callback([&] { status = stability_command(stability); });

  ServeArguments serve;
  command = app.add_subcommand(
      "serve",
      "give the board of a scenario to another program, as a PCI device (docs/vfio-user.md)");
  scenario_arguments(*command, serve);
  command->add_option("--vfio-user", serve.socket, "listen on a Unix socket at this path")
      ->required()
      ->type_name("SOCKET");
  command->add_flag("--once", serve.once, "end when the first client has gone");
  CLI::Option* trace = command->add_flag(
      "--trace-registers", serve.trace_registers,
      "also log every access to the board, in registers.log, and as a waveform, in registers.vcd");
  command->add_option("--out", serve.out, "folder for these in place of runs/<scenario>-serve")
      ->needs(trace)
      ->type_name("FOLDER");
  command->callback([&] { status = serve_command(serve); });

  LinuxArguments linux_run;
  command = app.add_subcommand(
      "linux", "a Linux kernel as the board's host, on simulated time, in place of the scenario's");
  linux_arguments(*command, linux_run);
  command->callback([&] { status = linux_command(linux_run); });

  FitArguments fit;
  command = app.add_subcommand(
      "fit", "parameters of a device, a hand, tissue, a bus or a host from a log, with intervals");
  fit_arguments(*command, fit);
  command->callback([&] { status = fit_command(fit); });

  SolveArguments solve;
  command = app.add_subcommand("solve",
                               "the accelerator's numbers on any symmetric positive definite "
                               "system: prints one JSON object");
  command->add_option("--matrix", solve.matrix, "the matrix, in Matrix Market form")
      ->required()
      ->type_name("A.mtx");
  command->add_option("--rhs", solve.rhs, "the right-hand side, likewise")
      ->required()
      ->type_name("b.mtx");
  command
      ->add_option("--solution,--out", solve.solution,
                   "write the solution into this file, solution.mtx by default")
      ->type_name("x.mtx");
  command
      ->add_option("--set", solve.overrides,
                   "gives a key of [solver], [refinement], [accelerator] or [spectrum] another "
                   "value; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  command
      ->add_option("--tolerance", solve.tolerance,
                   "exit with 1 where the error exceeds this part of the solution")
      ->type_name("T");
  command
      ->add_option("--kernel", solve.kernel,
                   "which implementation computes: reference, portable, avx2 or avx512; all give "
                   "the same words, and the fastest is the default")
      ->type_name("NAME");
  command->callback([&] { status = solve_command(solve); });

  MeshArguments mesh;
  command = app.add_subcommand("mesh", "fill a surface with tetrahedra and show their quality");
  command
      ->add_option("surface", mesh.surface,
                   "a file (STL, PLY, OBJ, VTP or VTU), or the word sphere or box")
      ->required()
      ->type_name("SURFACE");
  command->add_option("--nodes", mesh.nodes, "how many nodes are wanted, 500 by default")
      ->type_name("N");
  command->add_option("--unit", mesh.unit, "length of one unit of the file, \"1 mm\" by default")
      ->type_name("LENGTH");
  command
      ->add_option("--size", mesh.size,
                   "radius of the sphere, \"50 mm\" by default, or edge of the box, \"100 mm\"")
      ->type_name("LENGTH");
  command->add_option("--out", mesh.out, "write the mesh into this file, for ParaView")
      ->type_name("FILE.vtu");
  command->add_flag("--quiet", mesh.quiet, "no progress on the terminal");
  command->callback([&] { status = mesh_command(mesh); });

  ExportArguments exporting;
  command =
      app.add_subcommand("export", "write K, M, b (Matrix Market) and the mesh, for other tools");
  scenario_arguments(*command, exporting);
  command->add_option("--out", exporting.out, "folder to write into")
      ->required()
      ->type_name("FOLDER");
  command->callback([&] { status = export_command(exporting); });

  ResolveArguments resolve;
  command = app.add_subcommand(
      "resolve", "print every setting of a scenario as it would be run, checked, and run nothing");
  scenario_arguments(*command, resolve);
  command->add_flag("--each", resolve.each,
                    "for each line of the standard input, a JSON array of KEY=VALUE that are laid "
                    "over it, print one of JSON (docs/json.md)");
  command->callback([&] { status = resolve_command(resolve); });

  command = app.add_subcommand("reference",
                               "print every key of a scenario: unit, range, default, source");
  ReferenceArguments reference;
  CLI::Option* results = command->add_flag(
      "--results", reference.results, "every key of summary.json and column of frames.csv instead");
  command
      ->add_flag("--json", reference.json,
                 "keys, effects, figures, columns and flags as one JSON object")
      ->excludes(results);
  command->callback([&] { status = reference_command(reference); });

  refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    app.exit(e);  // --help, --version
    return kHeld;
  } catch (const CLI::ParseError& e) {
    complain("hvp: " + describe_usage_error(app, e));
    return kWrongInput;
  }
  return status;
}

}  // namespace

// SystemC's library has a main of its own that calls this; it is not used.
int sc_main(int /*argc*/, char** /*argv*/) { return kFailed; }

// LeakSanitizer reads the stacks of a program that ends and trips over the guard pages between
// SystemC's, now and then. What globals and the heap do not hold is found all the same.
#ifdef __SANITIZE_ADDRESS__
extern "C" const char* __lsan_default_options() { return "use_stacks=0"; }
#endif

int main(int argc, char** argv) {
  // Read by VTK, whose header for the same call is no C++20: its writer would start TBB's threads
  // for the ranges of a few thousand values, which takes 8 ms.
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 0);
  set_up_log();
  hvp::results::end_cleanly_when_interrupted();
  // "Simulation stopped by user" is how every run ends.
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_INFO,
                                          sc_core::SC_DO_NOTHING);
  try {
    const int status = parse_and_run(argc, argv);
    // A report that nobody got is not a run that went well.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      throw std::runtime_error("cannot write to standard output");
    }
    return status;
  } catch (const hvp::InputError& e) {
    end_progress(false);
    complain(e.what());
    return kWrongInput;
  } catch (const sc_core::sc_report& e) {
    // What a process threw, in the kernel's wrapping of several lines.
    end_progress(false);
    complain(std::string("hvp: ") + e.get_msg());
    return kFailed;
  } catch (const std::exception& e) {
    end_progress(false);
    complain(std::string("hvp: ") + e.what());
    return kFailed;
  }
}
