#include <CLI/CLI.hpp>
#include <array>
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
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

struct MissesArguments : ScenarioArguments {
  bool json = false;
  MissSettings search;
};

// Nothing of a run but its times is looked at.
constexpr std::array kTimesAlone = {"reference=false",       "spectrum=false",
                                    "output.pictures=false", "output.remedies=false",
                                    "output.trace_frames=0", "output.deformation_every_frames=0"};

// Without numbers where the scenario can do without them, which is faster.
LoadedScenario load_for_times(const MissesArguments& arguments) {
  load(arguments);  // whose errors are the user's own
  MissesArguments changed = arguments;
  changed.overrides.insert(changed.overrides.end(), kTimesAlone.begin(), kTimesAlone.end());
  MissesArguments counted = changed;
  counted.overrides.emplace_back("fidelity.numbers=none");
  try {
    return load_untitled(counted);
  } catch (const InputError&) {
    return load_untitled(changed);
  }
}

std::string convolution_text(const MissFigures& f) {
  // The transforms tell no smaller share from none.
  constexpr double kLeast = 1e-13;
  if (f.by_convolution) {
    return fmt::format("{} a frame (hvp run: late by chance), of one run's frames",
                       *f.by_convolution < kLeast ? fmt::format("less than {:.0e}", kLeast)
                                                  : fmt::format("{:.3g}", *f.by_convolution));
  }
  switch (f.convolution) {
    case MissFigures::Convolution::dependent:
      return "not known: a frame's rest depends on the times that are drawn";
    case MissFigures::Convolution::untested:
      return "not known: too few frames of one run tell whether their rest depends on what is "
             "drawn";
    case MissFigures::Convolution::known:
    case MissFigures::Convolution::of_other_times:
      break;
  }
  return "not known: it is of the operating system's times alone";
}

void print_figures(const Scenario& s, const MissFigures& f) {
  if (!s.title.empty()) print("{}\n", scenario::one_line(s.title, 1000));
  print("\nLate forces, by importance sampling\n");
  if (f.seen == 0) {
    print("  probability     none of {} frames was late\n", f.frames);
  } else if (f.uncertain) {
    print("  probability     about {:.2g} a frame: too few runs had a late one for an interval\n",
          f.share);
  } else {
    print("  probability     {:.3g} a frame, {:.2g} to {:.2g} with 95 %\n", f.share, f.low, f.high);
  }
  if (f.pareto) {
    print("  tail            as stated; hvp run says how much its samples leave open\n");
  }
  print("  by convolution  {}\n", convolution_text(f));
  print("  seen            {} late of {} frames, in {} runs with other seeds\n", f.seen, f.frames,
        f.runs);
  if (f.plain) {
    print("  times           as they come, since more than one frame in twenty is late\n");
  }
  for (const MissFigures::Effect& effect : f.effects) {
    print("  drawn           {}, up to {} times a frame\n", effect.name, effect.draws);
  }
  if (f.left_out > 0) print("  left out        {} frames whose solve failed\n", f.left_out);
}

int misses_command(const MissesArguments& arguments) {
  const LoadedScenario loaded = load_for_times(arguments);
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
