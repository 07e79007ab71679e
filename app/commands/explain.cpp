#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/explain/effect_costs.h"
#include "app/explain/explanation.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/results/regions.h"
#include "app/results/scene_figures.h"
#include "app/scenario/message.h"

namespace hvp::app {

namespace {

struct ExplainArguments : ScenarioArguments {
  bool json = false;
  bool measure = false;  // each effect's wall-clock time, by runs
};

// True if the listed times contain constants in place of latencies that are drawn.
bool draws_bus_times(const Scenario& s) {
  return s.bus.read_latencies || (s.bus.pcie && s.bus.pcie->root_complex_latencies);
}

void workspace_lines(const Explanation& e) {
  if (e.workspace.empty()) return;
  print("\nThe device over its way\n");
  for (const WorkspacePoint& point : e.workspace) {
    const Eigen::Vector3d& tip = point.tip;
    print("  at ({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * tip.x(), 1e3 * tip.y(), 1e3 * tip.z());
    if (point.steps) {
      print(", read in steps of {} to {}", results::readable_length((*point.steps)[0]),
            results::readable_length((*point.steps)[1]));
    }
    if (point.limited) {
      print(", at most");
      for (const std::optional<double>& force : point.force_limit) {
        if (force) print(" {}", results::newtons(*force));
      }
      print(" along x, y, z");
    }
    if (point.mass) {
      print(", {:.3g}, {:.3g} and {:.3g} g along x, y and z", 1e3 * point.mass->x(),
            1e3 * point.mass->y(), 1e3 * point.mass->z());
    }
    print("\n");
  }
}

void load_lines(const Explanation& e) {
  if (!e.loads.empty()) print("\nPoint loads\n");
  for (const PlacedLoad& load : e.loads) {
    print("  loads.point[{}] at ({:.4g}, {:.4g}, {:.4g}) mm, a node {:.3g} mm from its position\n",
          load.index, 1e3 * load.node.x(), 1e3 * load.node.y(), 1e3 * load.node.z(),
          1e3 * load.off);
  }
}

void platform_lines(const PlatformParts& platform) {
  const std::size_t processes = platform.processes();
  print("\nThe platform: {} modules, {} process{}\n", platform.modules.size(), processes,
        processes == 1 ? "" : "es");
  std::size_t width = 0;
  for (const PlatformModule& module : platform.modules) {
    width = std::max(width, module.name.size());
  }
  for (const PlatformModule& module : platform.modules) {
    std::string own;
    for (const PlatformProcess& process : module.processes) {
      // The name within the module.
      own += fmt::format("{} {} {}", own.empty() ? "" : ",", process.kind,
                         process.name.substr(process.name.rfind('.') + 1));
    }
    if (own.empty()) {
      print("  {:<{}} {}\n", module.name, width, module.kind);
    } else {
      print("  {:<{}} {:<16}{}\n", module.name, width, module.kind, own);
    }
  }
}

// The other settings and effects of a line in the table.
std::string beside(const EffectCost& cost) {
  std::string text;
  if (!cost.setting.starts_with(cost.path + '=')) text += "; by " + cost.setting;
  if (!cost.along.empty()) text += fmt::format("; beside {}", fmt::join(cost.along, ", "));
  if (!cost.also.empty()) text += fmt::format("; with {}", fmt::join(cost.also, ", "));
  return text;
}

void cost_lines(const EffectCosts& costs) {
  print(
      "\nWall-clock time on this machine (runs of {} frames, medians of {}; an effect's own is the "
      "median of {} pairs of runs)\n",
      costs.frames, costs.runs, costs.runs);
  print("  {:<31} {:>12} {:>12} {:>20}\n", "", "s/simulated s", "to build", "the effect's own");
  print("  {:<31} {:>12.4g} {:>10.3f} s\n", "the scenario", costs.scenario.run_s,
        costs.scenario.build_s);
  for (const EffectCost& c : costs.effects) {
    if (!c.refused.empty()) continue;
    print("  {:<31} {:>12.4g} {:>10.3f} s {:>+10.3g} ± {:.2g} s{}\n",
          (c.present ? "without " : "with ") + c.path, c.cost.run_s, c.cost.build_s, c.difference_s,
          c.spread_s, beside(c));
  }
  std::string refused;
  for (const EffectCost& c : costs.effects) {
    if (c.refused.empty()) continue;
    refused += fmt::format("  {:<31} {}\n", c.path, scenario::one_line(c.refused, 300));
  }
  if (!refused.empty()) print("\nNot tried\n{}", refused);
}

nlohmann::ordered_json costs_json(const EffectCosts& costs) {
  using nlohmann::ordered_json;
  ordered_json effects = ordered_json::array();
  for (const EffectCost& c : costs.effects) {
    ordered_json one = {
        {"path", c.path}, {"built", c.present}, {"setting", c.setting}, {"along", c.along}};
    if (c.refused.empty()) {
      one.update({{"wall_s_per_s", c.cost.run_s},
                  {"build_s", c.cost.build_s},
                  {"difference_s_per_s", c.difference_s},
                  {"spread_s_per_s", c.spread_s},
                  {"also", c.also}});
    } else {
      one["refused"] = c.refused;
    }
    effects.push_back(std::move(one));
  }
  return {{"frames", costs.frames},
          {"runs", costs.runs},
          {"wall_s_per_s", costs.scenario.run_s},
          {"build_s", costs.scenario.build_s},
          {"effects", effects}};
}

void print_explanation(const Scene& scene, const Explanation& e) {
  const Scenario& s = scene.scenario();
  if (!s.title.empty()) print("{}\n", scenario::one_line(s.title, 1000));
  print("\nParts and their fidelity\n");
  for (const ExplainedPart& part : e.parts) {
    print("  {:<12} {:<14} {}\n", part.part, part.level, part.what);
  }
  print("\nEffects\n");
  for (const config::Effect& effect : e.effects) {
    print("  {:<31} {:<8} {}\n", effect.path, effect.present ? "built" : "absent", effect.cost);
  }
  platform_lines(e.platform);
  workspace_lines(e);
  if (!scene.has_body()) return;
  if (const std::string regions = results::regions_text(scene); !regions.empty()) {
    print("\nThe body\n{}", regions);
  }
  load_lines(e);
  if (scene.spectrum()) {
    print("\nSpectrum of the system without contact\n{}",
          results::spectrum_text(*scene.spectrum()));
  }
  print("\nWhat a frame's large steps cost (the bus without waits{}{})\n",
        s.bus.posted_writes ? ", and as if nothing were posted" : "",
        draws_bus_times(s) ? ", latencies that are drawn at their constants" : "");
  for (const FrameStep& step : e.steps) {
    print("  {:<34} {:>10}\n", step.what, results::readable_time(step.ps));
  }
  if (!e.renewal.empty()) {
    print("\nOn top, in a frame that renews the matrix, one of {} that are solved\n",
          e.renew_every);
    for (const FrameStep& step : e.renewal) {
      print("  {:<34} {:>10}\n", step.what, results::readable_time(step.ps));
    }
    if (e.renewal_behind_ps > 0) {
      print(
          "  that frame's work ends {} after the next tick: the next frame begins so late, or is "
          "skipped\n",
          results::readable_time(e.renewal_behind_ps));
    }
  }
  if (!scene.has_board()) return;
  print("{}{}{}", results::clocks_text(scene), results::several_text(scene),
        results::resources_text(scene));
}

std::optional<EffectCosts> measure(const ExplainArguments& arguments, const Progress& progress) {
  return measure_effects(
      [&arguments](const std::vector<std::string>& overrides) {
        ExplainArguments changed = arguments;
        changed.overrides.insert(changed.overrides.end(), overrides.begin(), overrides.end());
        return std::make_unique<Scene>(build_scene(load(changed), {}));
      },
      progress);
}

int explain_command(const ExplainArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Progress progress = make_progress(arguments.quiet);
  Scene scene = build_scene(loaded, progress);
  Explanation explanation;
  try {
    explanation = explain(scene);
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
  std::optional<EffectCosts> costs;
  if (arguments.measure) costs = measure(arguments, progress);
  end_progress(arguments.quiet);
  if (arguments.measure && !costs) results::end_as_interrupted();
  if (arguments.json) {
    nlohmann::ordered_json told = explanation_json(scene, explanation);
    if (costs) told["measured"] = costs_json(*costs);
    print("{}\n", told.dump(2));
    return kHeld;
  }
  print_explanation(scene, explanation);
  if (costs) cost_lines(*costs);
  return kHeld;
}

}  // namespace

void add_explain(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ExplainArguments>();
  CLI::App* command =
      app.add_subcommand("explain", "what a scenario builds, how finely, and what it costs");
  add_scenario_arguments(*command, *arguments);
  command->add_flag("--json", arguments->json, "as one JSON object");
  command->add_flag("--measure", arguments->measure,
                    "also what each effect costs in wall-clock time here, by some runs each; "
                    "half a minute or more");
  command->callback([arguments, &status] { status = explain_command(*arguments); });
}

}  // namespace hvp::app
