#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_check.h"
#include "app/misses/miss_search.h"
#include "app/results/figures.h"
#include "app/scenario/message.h"

namespace hvp::app {

namespace {

struct MissesArguments : ScenarioArguments {
  bool json = false;
  MissSettings search;
};

// Nothing of a run but its times is looked at.
std::vector<std::string> times_alone(const Scenario& s) {
  std::vector<std::string> overrides = {
      "reference=false",       "spectrum=false",        "output.pictures=false",
      "output.remedies=false", "output.trace_frames=0", "output.deformation_every_frames=0"};
  const bool counted = s.host.solver == host::SolvedBy::board && !s.wall &&
                       s.fidelity.accelerator != vp::Timing::cycle_accurate;
  if (counted) overrides.emplace_back("fidelity.numbers=none");
  return overrides;
}

void print_figures(const Scenario& s, const MissFigures& f) {
  if (!s.title.empty()) print("{}\n", scenario::one_line(s.title, 1000));
  print("\nLate forces, by importance sampling\n");
  if (f.seen == 0) {
    print("  probability     none of {} frames was late, however long its times\n", f.frames);
  } else if (f.uncertain) {
    print("  probability     about {:.2g} a frame: too few late ones for an interval\n", f.share);
  } else {
    print("  probability     {:.3g} a frame, {:.2g} to {:.2g} with 95 %\n", f.share, f.low, f.high);
  }
  if (f.by_convolution) {
    // The transforms tell no smaller share from none.
    constexpr double kLeast = 1e-13;
    print("  by convolution  {} a frame (hvp run: late by chance), of one run's frames\n",
          *f.by_convolution < kLeast ? fmt::format("less than {:.0e}", kLeast)
                                     : fmt::format("{:.3g}", *f.by_convolution));
  } else {
    print("  by convolution  not known: a frame's rest depends on the times that are drawn\n");
  }
  print("  seen            {} late of {} frames, in {} runs with other seeds\n", f.seen, f.frames,
        f.runs);
  for (const MissFigures::Effect& effect : f.effects) {
    print("  drawn           {}, up to {} times a frame\n", effect.name, effect.draws);
  }
  if (f.left_out > 0) print("  left out        {} frames whose solve failed\n", f.left_out);
}

int misses_command(const MissesArguments& arguments) {
  MissesArguments changed = arguments;
  for (std::string& text : times_alone(load(arguments).scenario)) {
    changed.overrides.push_back(std::move(text));
  }
  const LoadedScenario loaded = load_untitled(changed);
  const Progress progress = make_progress(arguments.quiet);
  Scene scene = build_scene(loaded, progress);
  try {
    const MissFigures figures = find_misses(scene, arguments.search, progress);
    end_progress(arguments.quiet);
    if (arguments.json) {
      print("{}\n", results::figures_json(figures).dump(2));
    } else {
      print_figures(loaded.scenario, figures);
    }
    return kHeld;
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
}

}  // namespace

void add_misses(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<MissesArguments>();
  CLI::App* command = app.add_subcommand(
      "misses", "how probable a late force is, by runs in which long times come more often");
  add_scenario_arguments(*command, *arguments);
  command->add_flag("--json", arguments->json, "as one JSON object");
  command->add_option("--runs", arguments->search.most_runs, "at most; 400 by default")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  command
      ->add_option("--precision", arguments->search.precision,
                   "no further run where half of the interval is smaller than this share of the "
                   "probability; 0.2 by default")
      ->check(number_between(1e-3, 1))
      ->type_name("SHARE");
  command->callback([arguments, &status] { status = misses_command(*arguments); });
}

}  // namespace hvp::app
