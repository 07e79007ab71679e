#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/number_check.h"
#include "app/results/figures.h"
#include "app/results/number_text.h"
#include "app/results/part_files.h"
#include "app/results/pictures.h"
#include "app/scenario/message.h"
#include "app/stability/stability_search.h"

namespace hvp::app {

namespace {

struct StabilityArguments : ScenarioArguments {
  bool json = false;
  std::filesystem::path map;  // a picture; empty: none
  double push_N = 0;          // 0: a ladder of them
  int frames = 2000;          // of each run
};

constexpr int kDampings = 12;

std::string time_text(double seconds) {
  return results::readable_time(std::llround(seconds * 1e12));
}

// What the headline is the least of, where there are several.
void print_edges(const StabilityFigures& f) {
  if (f.edges.size() < 2) return;
  const auto beyond = [&] {
    if (f.beyond_device_N > 0) {
      print("  {:<26} {:>10}  {}\n", fmt::format("  pushed with {:.3g} N", f.beyond_device_N), "-",
            "and harder: the device's force is clamped");
    }
  };
  for (const StabilityEdge& e : f.edges) {
    if (!e.push_N) beyond();
    const std::string who = e.push_N ? fmt::format("  pushed with {:.3g} N", *e.push_N)
                                     : std::string("  as the scenario moves");
    const std::string value = e.stuck               ? "-"
                              : e.stiffness_max > 0 ? fmt::format("{:.4g} N/m", e.stiffness_max)
                                                    : "none";
    std::string note = e.unstable_from > 0
                           ? fmt::format("unstable from {:.5g} N/m", e.unstable_from)
                           : "none was unstable";
    if (e.stuck) note = "friction holds the device";
    if (e.undecided_N_m > 0) {
      note = fmt::format("not found: at {:.4g} N/m the device swings too slowly", e.undecided_N_m);
    }
    print("  {:<26} {:>10}  {}\n", who, value, note);
  }
  if (f.edges.back().push_N) beyond();
  if (f.falling) {
    print("  {:<26} {:>10}  {}\n", "", "",
          "still falling at the last push: lean harder, with --push");
  }
}

void print_figures(const Scene& scene, const StabilityFigures& f) {
  const Scenario& s = scene.scenario();
  if (!s.title.empty()) print("{}\n", scenario::one_line(s.title, 1000));
  print("\nLargest stable stiffness of the {}\n", s.wall ? "wall" : "body at its contact");
  const auto line = [](std::string_view what, double value, std::string_view note) {
    print("  {:<26} {:>10}  {}\n", what, value > 0 ? fmt::format("{:.4g} N/m", value) : "none",
          note);
  };
  line("runs of the platform", f.least.stiffness_max,
       f.least.undecided_N_m > 0
           ? fmt::format("{} runs; not found: at {:.4g} N/m the device swings too slowly for a run",
                         f.runs(), f.least.undecided_N_m)
       : f.least.stuck
           ? fmt::format("{} runs; friction holds the device: lean harder, with --push", f.runs())
       : f.edges.size() == 1 && f.edges.front().clamped
           ? fmt::format("{} runs; the device's force is clamped: lean less, with --push", f.runs())
       : f.least.unstable_from > 0
           ? fmt::format("{} runs; unstable from {:.5g} N/m", f.runs(), f.least.unstable_from)
           : fmt::format("{} runs; none was unstable", f.runs()));
  print_edges(f);
  line("exact eigenvalues", f.stiffness_linear,
       f.linear_computed ? "without steps, friction and limits"
                         : "not computed: coupled axes, or a delay of more than 64 periods");
  if (const auto& limits = s.device_of(0).limits; limits && limits->stiffness_N_m > 0) {
    line("the maker's own limit", limits->stiffness_N_m, "device.limits.stiffness");
  }
  line("passive, whoever holds it", f.stiffness_passive, "(b - |B|)/(T/2 + L)");
  if (f.encoder_bound > 0) {
    line("between encoder steps", f.encoder_bound, "2 f/D of friction and encoder");
  }
  print("\n  the force is {} late, and held for {}", time_text(f.delay_s), time_text(f.period_s));
  if (s.wall) {
    print("; the wall is damped by {:g} N s/m\n", f.damping_N_s_m);
  } else {
    print("; Young's modulus is {:.4g} kPa then\n", 1e-3 * f.young_modulus_Pa);
  }
}

// What the edge hangs on and nobody has stated.
void print_defaults(const scenario::Document& document, const Scenario& s) {
  const std::string key = s.device_key(0);
  const auto say = [&](const std::string& name, double value, std::string_view unit) {
    if (document.find(key + name) != nullptr) return;
    print("  {}{}, {:g} {}, is hvp's default: the edge hangs on it\n", key, name, value, unit);
  };
  const plant::DeviceSettings& device = s.device_of(0);
  if (device.dynamics) say(".dynamics.damping", device.dynamics->damping_N_s_m, "N s/m");
  if (device.friction) say(".friction.force", device.friction->force_N, "N");
}

std::string map_csv(const Scene& scene, const std::vector<StabilityFigures>& map) {
  std::string text = fmt::format("# {}\n", scenario::one_line(scene.scenario().title, 200));
  text += "damping_N_s_m,stiffness_max_N_m,stiffness_linear_N_m,stiffness_passive_N_m\n";
  for (const StabilityFigures& f : map) {
    text +=
        fmt::format("{},{},{},{}\n", results::shortest(f.damping_N_s_m),
                    results::shortest(f.least.stiffness_max), results::shortest(f.stiffness_linear),
                    results::shortest(f.stiffness_passive));
  }
  return text;
}

// Checks the picture's name before the runs, so that no result is lost.
void require_picture_name(const std::filesystem::path& file) {
  const std::string shown = scenario::one_line(file.string());
  if (file.extension() != ".png") {
    throw InputError(fmt::format("--map {}: expected a file name that ends in .png", shown));
  }
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(
        fmt::format("--map {}: there is no folder {}", shown, scenario::one_line(folder.string())));
  }
}

int stability_command(const StabilityArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  if (!arguments.map.empty()) require_picture_name(arguments.map);
  const Progress progress = make_progress(arguments.quiet);
  const Scene scene = build_scene(loaded, progress);
  const bool all = arguments.push_N == 0;
  const SearchSettings settings{.trial = {all ? 1 : arguments.push_N, arguments.frames},
                                .all_amplitudes = all};
  try {
    const StabilityFigures figures = find_stability(scene, settings, progress);
    std::vector<StabilityFigures> map;
    if (!arguments.map.empty()) map = stability_map(scene, settings, kDampings, progress);
    end_progress(arguments.quiet);
    if (arguments.json) {
      print("{}\n", results::figures_json(figures).dump(2));
    } else {
      print_figures(scene, figures);
      print_defaults(loaded.document, scene.scenario());
    }
    if (arguments.map.empty()) return kHeld;
    std::filesystem::path csv = arguments.map;
    csv.replace_extension(".csv");
    results::write_through_part_file(csv, map_csv(scene, map));
    const results::PictureOutcome drawn = results::draw_stability_map(csv, arguments.map);
    if (!drawn.drawn) complain(fmt::format("hvp: {}", drawn.reason));
    return drawn.drawn ? kHeld : kFailed;
  } catch (const InputError& e) {
    throw loaded.document.complete(e);
  }
}

}  // namespace

void add_stability(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<StabilityArguments>();
  CLI::App* command = app.add_subcommand(
      "stability", "the stiffest wall that a scenario's loop holds, by runs and by eigenvalues");
  add_scenario_arguments(*command, *arguments);
  command->add_flag("--json", arguments->json, "as one JSON object");
  command
      ->add_option("--map", arguments->map,
                   "also draw the stiffest wall over its damping, and write its figures beside it")
      ->type_name("FILE.png");
  command
      ->add_option("--push", arguments->push_N,
                   "with how many newtons the device leans on the wall; without it 1, and all "
                   "from 0.1 N to the device's limit where an edge depends on it")
      ->check(number_between(1e-3, 1e3))
      ->type_name("N");
  command
      ->add_option("--frames", arguments->frames,
                   "of each run at least, 2000 by default; more where the device swings slowly")
      ->check(CLI::Range(40, 10'000'000))
      ->type_name("N");
  command->callback([arguments, &status] { status = stability_command(*arguments); });
}

}  // namespace hvp::app
