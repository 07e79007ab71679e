#include "app/run/run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include <fmt/format.h>
#include <sys/resource.h>

#include "app/commands/commands.h"
#include "app/process/temporary_folder.h"
#include "app/results/figures.h"
#include "app/results/flags.h"
#include "app/results/launched_program.h"
#include "app/results/outcome.h"
#include "app/results/part_files.h"
#include "app/results/pictures.h"
#include "app/results/report.h"
#include "app/results/results_folder.h"

namespace hvp::app {

namespace {

struct RunArguments : ScenarioArguments {
  std::filesystem::path out;  // empty: runs/<scenario>
  bool trace_registers = false;
  bool trace_dma = false;
  bool record_jobs = false;  // settings, matrix, b and U of each job, for another host
  bool details = false;      // the report has times by phase and by bus transaction
};

using Clock = std::chrono::steady_clock;

// Against one that hangs: what a search finds must not depend on the machine's speed.
constexpr std::chrono::hours kLongestRerun{24};

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

// ps of a figure in µs; zero where there is none.
std::int64_t picoseconds(const nlohmann::json& us) {
  return us.is_number() ? std::llround(1e6 * us.get<double>()) : 0;
}

// Runs the same command with further overrides in a process of its own, which looks for a remedy
// itself if it `searches`.
std::optional<WholeRun> whole_run(const RunArguments& arguments,
                                  const std::vector<std::string>& changes, bool searches) {
  using nlohmann::json;
  std::vector<std::string> words = {"run", std::filesystem::absolute(arguments.scenario).string(),
                                    "--quiet"};
  for (const std::filesystem::path& file : arguments.includes) {
    words.emplace_back("--include");
    words.push_back(std::filesystem::absolute(file).string());
  }
  std::vector<std::string> overrides = arguments.overrides;
  overrides.insert(overrides.end(), changes.begin(), changes.end());
  overrides.insert(overrides.end(), {"output.pictures=false", "output.trace_frames=0",
                                     searches ? "output.remedies=true" : "output.remedies=false"});
  for (const std::string& text : overrides) {
    words.emplace_back("--set");
    words.push_back(text);
  }
  std::optional<WholeRun> result;
  try {
    const TemporaryFolder folder;
    words.insert(words.end(), {"--out", folder.path().string()});
    results::LaunchedProgram program("/proc/self/exe", words, {});
    const int status = program.wait(kLongestRerun).exit_status;
    if (status == kHeld || status == kNotHeld) {
      std::ifstream file(folder.path() / "summary.json");
      const json summary = json::parse(file, nullptr, false);
      if (!summary.is_discarded()) {
        result = {results::flags_named(
                      summary.at("stability").at("flags").get<std::vector<std::string>>()),
                  summary.at("held").get<bool>(),
                  summary.at("verdict").get<std::string>(),
                  {picoseconds(summary.at("deadline").at("worst_us")),
                   picoseconds(summary.at("load").at("worst_us"))},
                  {}};
        const json& remedy = summary.at("remedy");
        if (remedy.is_object()) result->remedy = remedy.at("set").get<std::vector<std::string>>();
      }
    }
  } catch (const std::exception&) {
    // A remedy that could not be tried is not reported.
  }
  return result;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

int run_command(const RunArguments& arguments) {
  const Clock::time_point start = Clock::now();
  check_kernel("HVP_KERNEL");
  const LoadedScenario loaded = load(arguments);
  std::filesystem::path out = arguments.out;
  if (out.empty()) out = results_folder(arguments);
  const Progress progress = make_progress(arguments.quiet);

  if (arguments.record_jobs) require_board_with_words(loaded);
  Scene scene = build_scene(loaded, progress);
  const Clock::time_point built = Clock::now();
  results::create_folder(out, "--out");
  const results::FolderLock lock(out);
  const results::DeferredInterruption deferred;
  // The level rtl has the words and clocks of cycle-accurate, takes ten times as long, and refuses
  // some of what could help. Nobody looks at the engine's clocks of a run that is only tried.
  RunArguments retried = arguments;
  if (loaded.scenario.fidelity.accelerator == vp::Timing::rtl) {
    retried.overrides.emplace_back("fidelity.accelerator=cycle-accurate");
  }
  if (loaded.scenario.output.engine_port) {
    retried.overrides.emplace_back("output.engine_port=false");
  }
  if (loaded.scenario.output.waveform) retried.overrides.emplace_back("output.waveform=false");
  results::Outcome outcome;
  try {
    const Rebuild rebuild = [&retried](const std::vector<std::string>& overrides) {
      RunArguments changed = retried;
      changed.overrides.insert(changed.overrides.end(), overrides.begin(), overrides.end());
      return std::make_unique<Scene>(build_scene(load(changed), {}, Scene::Limits::reported));
    };
    const auto again = [&retried](bool searches) -> Rerun {
      return [&retried, searches](const std::vector<std::string>& changes) {
        return whole_run(retried, changes, searches);
      };
    };
    outcome = run(scene, {out,
                          loaded.device_file,
                          arguments.trace_registers,
                          arguments.trace_dma,
                          arguments.record_jobs,
                          progress,
                          {rebuild, again(false), again(true)}});
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  } catch (const Interrupted& e) {
    end_progress(arguments.quiet);
    complain(fmt::format("hvp: {}", e.what()));
    results::end_as_interrupted();
  }
  const double simulate_s = seconds(built, Clock::now()) - outcome.remedy_search_s;
  const Clock::time_point simulated = Clock::now();

  results::PictureOutcome pictures;
  if (loaded.scenario.output.pictures) {
    if (progress) progress("drawing");
    pictures = results::draw_pictures(out);
  }
  const Clock::time_point drawn = Clock::now();
  end_progress(arguments.quiet);

  const double simulated_s = to_seconds(outcome.simulated);
  const double frames_per_s =
      static_cast<double>(outcome.verdict.frames()) / std::max(simulate_s, 1e-9);
  const results::Performance performance{.build_scene_s = seconds(start, built),
                                         .simulate_s = simulate_s,
                                         .remedy_s = outcome.remedy_search_s,
                                         .frames_per_s = frames_per_s,
                                         .draw_s = seconds(simulated, drawn),
                                         .simulated_s = simulated_s,
                                         .peak_memory_mb = peak_memory_mb()};
  results::write_through_part_file(out / "performance.json",
                                   results::figures_json(performance).dump(2) + "\n");

  print("{}", results::report(scene, outcome));
  if (arguments.details) print("{}", results::details_text(outcome.latency));
  print("\nResults in {} ({:.3g} s simulated in {:.2f} s, {:.0f} frames a second", out.string(),
        simulated_s, simulate_s, frames_per_s);
  if (outcome.remedy) print(", remedies tried in {:.1f} s", outcome.remedy_search_s);
  if (!pictures.files.empty()) print(", drawn in {:.1f} s", seconds(simulated, drawn));
  print(")\n");
  if (outcome.trace_cut_at) {
    print("trace.json ends before frame {}: output.trace_size is {:g} MB\n", *outcome.trace_cut_at,
          loaded.scenario.output.trace_bytes * 1e-6);
  }
  if (loaded.scenario.output.pictures && !pictures.drawn) print("{}\n", pictures.reason);
  if (results::interrupted() != 0) {
    std::fflush(stdout);
    complain(
        outcome.partial()
            ? fmt::format("hvp: interrupted at frame {} of {}: the results are of those before",
                          outcome.ticks, outcome.scene.frames)
            : "hvp: interrupted after the last frame: the results are complete");
    results::end_as_interrupted();
  }
  return outcome.held() ? kHeld : kNotHeld;
}

}  // namespace

void add_run(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* command =
      app.add_subcommand("run", "simulate a scenario and say whether its budgets held");
  add_scenario_arguments(*command, *arguments);
  command
      ->add_option("--out", arguments->out,
                   "folder for the results in place of runs/<scenario>, with what --set changes")
      ->type_name("FOLDER");
  command->add_flag(
      "--trace-registers", arguments->trace_registers,
      "also log every access to the board, in registers.log, and as a waveform with the "
      "interrupt, in registers.vcd; and what a board moves by itself, in dma.log");
  command->add_flag("--trace-dma", arguments->trace_dma,
                    "also log what a board moves by itself, in dma.log, with a lane of its own in "
                    "trace.json");
  command->add_flag(
      "--record-jobs", arguments->record_jobs,
      "also write what the board was asked and what it answered, jobs.hvpf and jobs.hvpu, for "
      "hvp-servo in a guest (docs/linux.md)");
  command->add_flag("--details", arguments->details,
                    "also report every frame's time by phase, and the bus' transactions");
  command->callback([arguments, &status] { status = run_command(*arguments); });
}

}  // namespace hvp::app
