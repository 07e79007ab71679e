#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "app/board/model_commands.h"
#include "app/board/outside_board.h"
#include "app/commands/commands.h"
#include "app/commands/number_check.h"
#include "app/linux/complaints.h"
#include "app/linux/guest.h"
#include "app/linux/guest_error.h"
#include "app/linux/guest_results.h"
#include "app/record/recorder.h"
#include "app/results/board_records.h"
#include "app/results/driver_findings.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "vp/function/outside_host.h"

namespace hvp::app {

namespace {

struct LinuxArguments : ScenarioArguments {
  std::filesystem::path kernel;  // empty: the one that driver/linux/kernel/build.sh has built
  std::filesystem::path initrd;  // likewise
  std::filesystem::path script;  // empty: none
  std::filesystem::path out;     // empty: runs/<scenario>-linux
  std::filesystem::path record;  // empty: none
  std::string memory;            // the guest's; empty: 64M, or what a kernel with checks needs
  std::vector<std::string> kernel_arguments;
  double patience_s = 60;            // of wall-clock time without a word of the guest
  std::optional<std::string> check;  // words with commas between them
  std::vector<std::string> stop_at;
  bool gdb = false;  // the kernel waits for a debugger, and nobody loses patience with it
  bool trace_registers = false;
  bool trace_dma = false;
};

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

// The output of driver/linux/kernel/build.sh: build/linux, beside this program's own folder
// (build/release/app/hvp).
fs::path built(std::string_view name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path().parent_path() / "linux" / name;
}

// Blanks separate the words of the kernel's command line.
void expect_one_word(std::string_view what, const fs::path& path) {
  if (path.native().find_first_of(" \t\n\"") == std::string::npos) return;
  throw InputError(
      fmt::format("{} {}: expected a path without blanks and quotes, which a kernel's "
                  "command line cannot have",
                  what, path.string()));
}

void expect_file(std::string_view option, const fs::path& file, int access, bool own) {
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored) && ::access(file.c_str(), access) == 0) return;
  if (own) {
    throw InputError(fmt::format("no file {}: expected one that ./hvp linux has built, or {}",
                                 file.string(), option));
  }
  throw InputError(fmt::format("{} {}: expected a file that can be {}", option, file.string(),
                               (access & X_OK) != 0 ? "run" : "read"));
}

// Which of the built kernels (driver/linux/kernel/build.sh): one with all that it is to check.
std::string variant_of(const LinuxArguments& arguments, const guest::Checks& checks) {
  if (!checks.of_kernel.empty()) return fmt::format("{}", fmt::join(checks.of_kernel, "+"));
  return arguments.gdb ? "debug" : "plain";
}

guest::Checks chosen_checks(const LinuxArguments& arguments) {
  if (!arguments.check) return {};
  guest::Checks checks = guest::parse_checks(*arguments.check);
  if (arguments.gdb && !checks.of_kernel.empty()) {
    throw InputError("--gdb and a kernel that checks: expected one of them");
  }
  return checks;
}

guest::GuestSettings guest_settings(const LinuxArguments& arguments, const guest::Checks& checks) {
  guest::GuestSettings settings;
  const fs::path variant = built(variant_of(arguments, checks));
  settings.kernel = arguments.kernel.empty() ? variant / "linux" : arguments.kernel;
  settings.initrd = arguments.initrd.empty() ? variant / "initramfs.cpio.gz" : arguments.initrd;
  settings.script = arguments.script;
  settings.memory = arguments.memory;
  if (settings.memory.empty()) settings.memory = checks.of_kernel.empty() ? "64M" : "256M";
  settings.arguments = arguments.kernel_arguments;
  settings.check_dma = checks.dma;
  settings.stop_at = arguments.stop_at;
  settings.patience =
      std::chrono::milliseconds(static_cast<std::int64_t>(arguments.patience_s * 1000));
  if (arguments.gdb) {
    settings.patience.reset();
    settings.hold = true;
  }
  expect_file("--kernel", settings.kernel, R_OK | X_OK, arguments.kernel.empty());
  expect_file("--initrd", settings.initrd, R_OK, arguments.initrd.empty());
  if (!settings.script.empty()) expect_file("--script", settings.script, R_OK, false);
  settings.kernel = fs::absolute(settings.kernel);
  for (const auto& [option, file] :
       {std::pair("--initrd", settings.initrd), std::pair("--script", settings.script)}) {
    if (!file.empty()) expect_one_word(option, fs::absolute(file));
  }
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (error) throw InputError("TMPDIR: expected a folder that is there, for the guest's sockets");
  expect_one_word("TMPDIR", temporary);
  return settings;
}

// Tells how to attach a debugger to the waiting kernel. A kernel of ours has a script beside it
// that loads the kernel's types, and those of the module once it is loaded.
std::string gdb_text(pid_t process, const fs::path& kernel) {
  const fs::path commands = kernel.parent_path() / "guest.gdb";
  std::error_code ignored;
  std::string text = fmt::format("the kernel waits for a debugger: gdb -p {}", process);
  if (fs::exists(commands, ignored)) text += fmt::format(" -x {}", commands.string());
  return text;
}

// Lists the effects of a simulated host that the scenario has and a run with a kernel lacks.
std::vector<std::string> not_counted(const Scenario& s) {
  std::vector<std::string> all = {
      s.guest ? "what the guest's processor does between its calls"
              : "the time of the guest's processor, its calls and interrupts ([guest])"};
  const host::Host& host = s.host;
  const auto add = [&all](bool there, const char* key) {
    if (there) all.emplace_back(key);
  };
  add(host.jitter.has_value(), "host.jitter");
  add(host.wake_up.has_value(), "host.wake_up");
  add(host.interrupt_latencies && !s.guest, "host.interrupt_latencies");
  add(host.delay.has_value(), "host.delay");
  add(host.virtual_coupling.has_value(), "host.virtual_coupling");
  add(host.passivity.has_value(), "host.passivity");
  add(host.cores == 1, "host.cores");
  add(s.transfer.notification == link::Notification::polling, "transfer.notification");
  return all;
}

std::string misses_text(const vp::Verdict& v) {
  if (v.misses() == 0) return "no miss";
  std::string text;
  if (const std::int64_t late = v.misses() - v.unsolved(); late > 0) {
    text = fmt::format("{} late", late);
  }
  if (v.unsolved() > 0) {
    text += fmt::format("{}{} whose job failed", text.empty() ? "" : ", ", v.unsolved());
  }
  return text;
}

std::string fault_lines(const guest::GuestFigures& figures) {
  std::string text;
  for (const vp::FaultRecord& fault : figures.faults) {
    text += fmt::format(
        "\n  fault         {}: {}", vp::name(fault.fault.kind),
        fault.injected == 0
            ? "did not happen: " + fault.why_not(figures.verdict.frames())
            : fmt::format(
                  "{}{}, first in frame {}; who noticed is the driver's to say",
                  results::counted(fault.injected, "time"),
                  fault.missing() == 0 ? std::string() : fmt::format(" of {}", fault.fault.count),
                  fault.first_frame));
  }
  return text;
}

std::string driver_lines(const guest::GuestFigures& figures) {
  if (!figures.guest.driver) return {};
  return fmt::format("\n  driver        {}",
                     fmt::join(results::report_lines(*figures.guest.driver), "\n  driver        "));
}

std::string order_lines(const guest::GuestFacts& facts) {
  if (!facts.memory_order) return {};
  const vp::WeakMemory::Counts& order = *facts.memory_order;
  if (order.transfers == 0) return {};
  return fmt::format(
      "\n  memory order  {} of the board's, {} to what had no barrier behind it{}",
      results::counted(order.transfers, "transfer"), order.unordered,
      order.unordered == 0
          ? std::string()
          : fmt::format("; with this seed {} of them got or left other words", order.changed));
}

std::string complaint_lines(const guest::GuestFacts& facts) {
  if (facts.checks.empty()) return {};
  std::string text = fmt::format(
      "\n  checked       {}: {}", fmt::join(facts.checks, ", "),
      facts.complaints.empty() ? "the kernel does not complain" : "the kernel complains");
  for (const guest::Complaints::Complaint& complaint : facts.complaints) {
    text += fmt::format("\n  complaint     {}, {}: {}", complaint.check,
                        results::counted(complaint.count, "time"), complaint.text);
  }
  return text;
}

std::string frames_text(const guest::GuestFigures& figures) {
  const vp::Verdict& v = figures.verdict;
  const std::string checked =
      driver_lines(figures) + order_lines(figures.guest) + complaint_lines(figures.guest);
  if (v.frames() == 0) return "no job was solved" + fault_lines(figures) + checked;
  std::string text =
      fmt::format("{} frames, {} a period of {}: worst {}, median {}; {}", v.frames(),
                  v.force_in_time() && v.load_held() ? "all within" : "not all within",
                  results::readable_time(v.budget()), results::readable_time(v.worst_latency()),
                  results::readable_time(v.percentile(0.5)), misses_text(v));
  text += "\n  worst frame   ";
  const char* separator = "";
  for (const vp::Attribution& a : v.attribution()) {
    text += fmt::format("{}{} {} {}", separator, vp::name(a.part), vp::name(a.phase),
                        results::readable_time(a.time));
    separator = ", ";
  }
  text += fault_lines(figures) + checked;
  text += fmt::format("\n  not counted   {}", fmt::join(figures.guest.not_counted, ", "));
  return text;
}

// Returns status 3 if the guest did not end properly or its script failed.
int linux_command(const LinuxArguments& arguments) {
  check_kernel("HVP_KERNEL");
  const guest::Checks checks = chosen_checks(arguments);
  const guest::GuestSettings chosen = guest_settings(arguments, checks);
  const LoadedScenario loaded = load(arguments);
  require_stops(arguments.stop_at);
  fs::path out = arguments.out;
  if (out.empty()) (out = results_folder(arguments)) += "-linux";
  const vp::PlatformSettings board_settings = outside_board(loaded);
  results::create_folder(out, "--out");
  const results::FolderLock lock(out);
  const results::DeferredInterruption deferred;

  const Clock::time_point start = Clock::now();
  results::remove_earlier_results(out);
  std::optional<results::RegisterTrace> registers;
  if (arguments.trace_registers) registers.emplace(out);
  std::optional<record::RecordFile> record;
  if (!arguments.record.empty()) {
    record.emplace(arguments.record, "--record", record::Layer::kernel, loaded);
  }
  vp::AccessObserver* observer = registers ? &*registers : nullptr;
  std::optional<vp::DriverRules> rules;
  if (checks.driver) observer = &rules.emplace(observer);
  vp::BoardFunction board(board_settings, observer);
  const ModelCommands commands(board, loaded.scenario);
  if (rules) watch_driver(*rules, board);
  if (record) record->watch(board);
  const Scenario& s = loaded.scenario;
  if (s.guest) board.host().take_interrupts_late(s.host, s.seed);
  if (registers) registers->watch(board.accelerator());
  guest::GuestResults results(out, s, loaded.device_file, board);
  std::optional<results::DmaLog> dma_log;
  if (arguments.trace_dma) {
    hvp::results::trace_dma(board.accelerator().dma(), results.lanes(),
                            registers ? fs::path() : out, dma_log);
  }
  guest::GuestSettings settings = chosen;
  if (settings.check_dma && board.memory() == nullptr) {
    spdlog::warn("--check dma: the board moves nothing by itself (transfer.method)");
  }
  if (s.guest && s.guest->memory_order == host::GuestCosts::MemoryOrder::weak) {
    settings.weak_memory_seed = s.seed;
  }
  if (s.guest) settings.system_call_ns = std::llround(1e9 * s.guest->system_call_s);
  std::ofstream console(out / "console.log", std::ios::trunc);
  guest::Complaints complaints(checks.of_kernel);
  settings.print = [&](std::string_view line) {
    complaints.read(line);
    // Each line is flushed, so that an observer sees how far a hanging guest came.
    console << line << std::endl;
    if (arguments.quiet) return;
    print("{}\n", line);
    std::fflush(stdout);
  };
  settings.say = [](std::string_view text) {
    print("{}\n", text);
    std::fflush(stdout);
  };
  guest::Guest::End end;
  std::optional<guest::GuestError> failed;
  guest::GuestFigures figures;
  {
    guest::Guest guest(board, settings);
    if (settings.hold) {
      print("{}\n", gdb_text(guest.process(), settings.kernel));
      std::fflush(stdout);
    }
    // Results up to a failure are written all the same.
    try {
      end = guest.run();
    } catch (const guest::GuestHung& error) {
      failed = error;
      print("\n{}\n", guest.hang_text());
    } catch (const guest::GuestError& error) {
      failed = error;
    }
    std::vector<std::string> missing = not_counted(s);
    if (settings.system_call_ns > 0 && !guest.system_calls_take_time()) {
      missing.emplace_back("guest.system_call");
      spdlog::warn(
          "guest.system_call: the kernel took no time for a system call; expected one with "
          "driver/linux/kernel/patches/system-call-time.patch");
    }
    warn_of_a_stop_that_never_came(guest.never_stopped());
    if (rules) rules->finish();
    figures = results.finish(
        s, {guest.counts(), guest.dma(), guest.memory_order(), guest.first_access(),
            std::move(missing), checks.of_kernel, complaints.found(),
            end.interrupted || end.stopped, rules ? std::optional(rules->report()) : std::nullopt});
    if (rules) rules->stop();
  }
  if (registers) registers->finish();
  if (dma_log) dma_log->finish();
  if (record) record->finish();

  print("\n{}\n\nResults in {} ({:.3g} s simulated in {:.2f} s)\n", frames_text(figures),
        out.string(), to_seconds(figures.simulated),
        std::chrono::duration<double>(Clock::now() - start).count());
  if (end.interrupted) {
    std::fflush(stdout);
    complain("hvp: interrupted: the results are of the frames before");
    results::end_as_interrupted();
  }
  if (failed) throw guest::GuestError(*failed);
  if (end.module_status) {
    throw guest::GuestError(
        fmt::format("the module did not load: insmod ended with status {}", *end.module_status));
  }
  if (!end.stopped && !chosen.script.empty() && end.script_status.value_or(-1) != 0) {
    throw guest::GuestError(end.script_status
                                ? fmt::format("the script ended with status {}", *end.script_status)
                                : std::string("the guest ended before its script did"));
  }
  return figures.held() ? kHeld : kNotHeld;
}

}  // namespace

void add_linux(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<LinuxArguments>();
  CLI::App* command = app.add_subcommand(
      "linux", "a Linux kernel as the board's host, on simulated time, in place of the scenario's");
  add_scenario_arguments(*command, *arguments);
  command
      ->add_option(
          "--kernel", arguments->kernel,
          "a User-Mode Linux with time-travel and PCI over virtio, in place of the one that "
          "driver/linux/kernel/build.sh has built")
      ->type_name("FILE");
  command
      ->add_option("--initrd", arguments->initrd,
                   "its first file system, in place of the one built")
      ->type_name("FILE");
  command
      ->add_option("--script", arguments->script,
                   "what the init of that is to run, with the guest's shell; its status counts")
      ->type_name("FILE");
  command
      ->add_option("--out", arguments->out,
                   "folder for the results in place of runs/<scenario>-linux")
      ->type_name("FOLDER");
  command
      ->add_option("--memory", arguments->memory, "the guest's, 64M by default, 256M with --check")
      ->check(CLI::Validator(
          [](const std::string& text) {
            const bool right = std::regex_match(text, std::regex("[1-9][0-9]{0,5}[MG]"));
            return right ? std::string() : "expected a size such as 64M, found " + text;
          },
          ""))
      ->type_name("SIZE");
  command
      ->add_option("--kernel-argument", arguments->kernel_arguments,
                   "one more word of the kernel's command line; as often as wanted")
      ->allow_extra_args(false)
      ->type_name("WORD");
  command
      ->add_option("--patience", arguments->patience_s,
                   "seconds of wall-clock time without a word of the guest after which the run "
                   "ends, 60 by default")
      ->check(number_between(1.0, 86400.0))
      ->type_name("S");
  command
      ->add_option(
          "--check", arguments->check,
          "what to look for besides the results, and is in the verdict, with commas "
          "between: driver (the rules of docs/driver-rules.md), dma (the board reaches what "
          "its driver has mapped for it and nothing else), and by a kernel that takes "
          "minutes to build: kasan (accesses beyond memory or to what was freed), lockdep "
          "(locks and DMA)")
      ->type_name("WORDS");
  command->add_flag("--gdb", arguments->gdb,
                    "a kernel with types and lines, stopped before its first instruction until gdb "
                    "lets it go on, which may take any time");
  command
      ->add_option("--stop-at", arguments->stop_at,
                   "a point at which the run ends and is shown, or gdb gets the kernel: \"write to "
                   "CONTROL\", \"read of STATUS\", \"interrupt 3\", \"message 3\", \"job 7\"; as "
                   "often as wanted")
      ->allow_extra_args(false)
      ->type_name("POINT");
  command->add_flag(
      "--trace-registers", arguments->trace_registers,
      "also log every access to the board, in registers.log, and as a waveform with "
      "the interrupt, in registers.vcd; and what a board moves by itself, in dma.log");
  command->add_flag("--trace-dma", arguments->trace_dma,
                    "also log what a board moves by itself, in dma.log, with a lane of its own in "
                    "trace.json");
  command
      ->add_option("--record", arguments->record,
                   "also record all that passes between the kernel and the board, for hvp replay")
      ->type_name("FILE");
  command->callback([arguments, &status] { status = linux_command(*arguments); });
}

}  // namespace hvp::app
