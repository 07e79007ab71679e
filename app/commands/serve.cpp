#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/board/model_commands.h"
#include "app/board/outside_board.h"
#include "app/board/stop_points.h"
#include "app/commands/commands.h"
#include "app/record/recorder.h"
#include "app/results/board_records.h"
#include "app/results/driver_findings.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "app/serve/server.h"

namespace hvp::app {

namespace {

struct ServeArguments : ScenarioArguments {
  std::filesystem::path socket;
  bool once = false;  // ends with its first client
  bool trace_registers = false;
  std::vector<std::string> stop_at;
  std::vector<std::string> checks;  // what is looked for in the driver
  std::filesystem::path record;     // empty: none
  std::filesystem::path out;        // of the trace; empty: runs/<scenario>-serve
};

namespace fs = std::filesystem;

// Ends at the first of the points, as hvp linux does.
void stop_here(vp::BoardFunction& board, serve::Server& server, const Stop& stop) {
  if (server.stopped()) return;
  server.stop();
  board.host().frames().stop();
  print("stopped: {}\n", stop.what);
  std::fflush(stdout);
}

int serve_command(const ServeArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  check_kernel("HVP_KERNEL");
  const vp::PlatformSettings settings = outside_board(loaded);
  require_strong_order(loaded, "a socket");
  require_stops(arguments.stop_at);
  fs::path out = arguments.out;
  std::optional<results::FolderLock> lock;
  std::optional<results::RegisterTrace> registers;
  if (arguments.trace_registers) {
    if (out.empty()) (out = results_folder(arguments)) += "-serve";
    results::create_folder(out, "--out");
    lock.emplace(out);
  }
  // From here on a signal ends the program properly, so that the socket is removed.
  const results::DeferredInterruption deferred;
  bool broken = false;
  {
    serve::ListeningSocket socket(arguments.socket);
    if (lock) registers.emplace(out);
    std::optional<vp::DriverRules> rules;
    if (!arguments.checks.empty()) rules.emplace(registers ? &*registers : nullptr);
    std::optional<record::RecordFile> record;
    if (!arguments.record.empty()) {
      record.emplace(arguments.record, "--record", record::Layer::socket, loaded);
    }
    serve::BoardPort board(settings, registers ? &*registers : nullptr, rules ? &*rules : nullptr);
    const ModelCommands commands(board.function(), loaded.scenario);
    board.obey(commands);
    if (record) record->watch(board.function());
    print(
        "listening on {}; simulated time passes with the client's accesses and its jobs, not "
        "with the clock: for function, not for timing\n",
        arguments.socket.string());
    std::fflush(stdout);
    serve::Server server(board, socket);
    std::optional<StopPoints> stops;
    for (const std::string& point : arguments.stop_at) {
      if (!stops) stops.emplace(board.function());
      stops->add(point, [&](const Stop& stop) { stop_here(board.function(), server, stop); });
    }
    server.run(arguments.once);
    if (stops) warn_of_a_stop_that_never_came(stops->never_came());
    warn_of_faults_that_never_struck(board.function());
    if (rules) {
      rules->finish();
      const vp::DriverReport report = rules->report();
      for (const std::string& line : results::report_lines(report)) print("driver: {}\n", line);
      broken = !report.findings.empty();
    }
    if (record) {
      record->finish();
      print("what passed between client and board is in {}\n", arguments.record.string());
    }
    if (registers) {
      registers->finish();
      print("every access is in {}\n", (out / "registers.log").string());
    }
  }
  if (results::interrupted() != 0) {
    complain("hvp: interrupted");
    std::fflush(stdout);
    results::end_as_interrupted();
  }
  return broken ? kNotHeld : kHeld;
}

}  // namespace

void add_serve(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand(
      "serve",
      "give the board of a scenario to another program, as a PCI device (docs/vfio-user.md)");
  add_scenario_arguments(*command, *arguments);
  command->add_option("--vfio-user", arguments->socket, "listen on a Unix socket at this path")
      ->required()
      ->type_name("SOCKET");
  command->add_flag("--once", arguments->once, "end when the first client has gone");
  command
      ->add_option(
          "--check", arguments->checks,
          "what to look for besides; driver: the rules of docs/driver-rules.md, and status "
          "1 if one was broken")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({kCheckDriver}))
      ->type_name("WORD");
  CLI::Option* trace = command->add_flag(
      "--trace-registers", arguments->trace_registers,
      "also log every access to the board, in registers.log, and as a waveform, in registers.vcd; "
      "and what a board moves by itself, in dma.log");
  command
      ->add_option("--stop-at", arguments->stop_at,
                   "a point at which it ends: \"write to CONTROL\", \"read of STATUS\", "
                   "\"interrupt 3\", \"message 3\", \"job 7\"; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("POINT");
  command
      ->add_option("--record", arguments->record,
                   "also record all that passes between client and board, for hvp replay")
      ->type_name("FILE");
  command->add_option("--out", arguments->out, "folder for these in place of runs/<scenario>-serve")
      ->needs(trace)
      ->type_name("FOLDER");
  command->callback([arguments, &status] { status = serve_command(*arguments); });
}

}  // namespace hvp::app
