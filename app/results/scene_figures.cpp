#include "app/results/scene_figures.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "app/results/report.h"
#include "app/scene/scene.h"
#include "models/config/effects.h"
#include "vp/fpga/accelerator.h"

namespace hvp::results {

EngineClocks engine_clocks(const vp::EngineSolve& solve, const accel::SolveCycles& c) {
  using vp::engine::State;
  const auto spent = [&solve](std::initializer_list<State> states) {
    std::int64_t clocks = 0;
    for (const State state : states) clocks += solve.state[static_cast<std::size_t>(state)];
    return clocks;
  };
  const std::int64_t set_up =
      spent({State::guess, State::start_product, State::start_residual, State::first_direction});
  const std::int64_t product = spent({State::product});
  const std::int64_t update = spent({State::update});
  const std::int64_t direction = spent({State::direction});
  const std::int64_t divisions = spent({State::alpha, State::beta});
  const std::int64_t anew = spent({State::anew_product, State::anew_residual});
  const std::int64_t waited =
      solve.clocks - set_up - product - update - direction - divisions - anew;
  const std::int64_t n = c.iterations;
  EngineClocks clocks{solve.clocks, c.total(), n, {}};
  clocks.phases = {
      {{"wait", "waiting for the copy of U", waited, 0},
       {"set_up", "set-up", set_up, c.setup},
       {"product", "product and inner product", product, n * c.sparse_product + c.breakdown},
       {"update", "solution and residual", update, n * c.update},
       {"direction", "direction", direction, n * c.direction},
       {"divisions", "divisions", divisions, n * c.divisions},
       {"residual_anew", "residuals formed anew", anew, c.replacements * c.replacement}}};
  return clocks;
}

SceneFigures scene_figures(const app::Scene& scene) {
  const app::Scenario& s = scene.scenario();
  std::optional<BodyFigures> body;
  if (scene.has_body()) {
    body = {scene.quality(), scene.body().active_nodes(), scene.computation().matrix().blocks(),
            region_figures(scene)};
  }
  return {.title = s.title,
          .frames = s.frames,
          .timing_only = s.timing_only(),
          .solver = scene.has_body() ? host::name(s.host.solver) : "wall",
          .effects = effects(s),
          .fidelity = s.fidelity,
          .has_board = scene.has_board(),
          .resources = scene.usage().resources,
          .condition = scene.spectrum(),
          .body = body};
}

std::vector<std::string> effects(const app::Scenario& s) {
  std::vector<std::string> names;
  for (const config::Effect& effect : s.effects()) {
    if (effect.present) names.push_back(effect.path);
  }
  return names;
}

void SceneFigures::report_resources(config::Figures& f) const {
  f.list("resources", "Memory blocks and multipliers; empty without a board.", resources,
         [&](const accel::Resource& r) {
           f.text("type", r.type, "what it is");
           f.count("used", r.used, "how many the design takes");
           f.count("available", r.available, "how many the device has");
         });
}

void BodyFigures::report(config::Figures& f) const {
  f.count("nodes", mesh.nodes, "of the body");
  f.count("active_nodes", active_nodes, "of those, in the system");
  f.count("tetrahedra", mesh.tetrahedra, "of the body");
  f.quantity("min_dihedral_deg", mesh.min_dihedral, "°", "the smallest dihedral angle");
  f.quantity("max_dihedral_deg", mesh.max_dihedral, "°", "the largest");
  f.ratio("max_aspect_ratio", mesh.max_aspect_ratio, "longest edge over shortest, the largest");
  f.quantity("min_det_jacobian", mesh.min_det_jacobian, "m³",
             "six times the smallest signed volume");
  f.count("blocks", matrix_blocks, "of the matrix");
  f.when(!regions.empty(), [&] {
    f.list("regions",
           "With `[[object.region]]` only: what each has of the body, what no region has first.",
           regions);
  });
}

void SceneFigures::report_fidelity(config::Figures& f) const {
  const auto level = [&](std::string_view part, bool there, std::string_view name,
                         std::string_view help) {
    f.value(part, there ? config::FigureValue(std::string(name)) : config::FigureValue(), {}, help);
  };
  level("accelerator", has_board, vp::name(fidelity.accelerator), "null without a board");
  level("bus", true, vp::name(fidelity.bus), "of all buses");
  level("host", true, vp::name(fidelity.host), "of its processes");
  level("numbers", true, has_board ? vp::name(fidelity.numbers) : "double", "of the solver");
}

std::optional<AcceleratorFigures> accelerator_figures(const app::Scene& scene,
                                                      const vp::Accelerator* board) {
  if (!scene.has_board()) return std::nullopt;
  AcceleratorFigures a;
  a.device = scene.device().name;
  a.closed_form = scene.solve_cycles();
  a.clock_period_ps = scene.scenario().accelerator.clock_period_ps();
  if (board != nullptr) {
    a.illegal_accesses = board->illegal_accesses();
    a.compared = board->compared();
    if (const auto& longest = board->longest_solve()) {
      a.engine = engine_clocks(*longest, accel::solve_cycles(scene.scenario().accelerator,
                                                             scene.pattern(), longest->work));
    }
  }
  if (const std::optional<accel::SeveralDevices>& several = scene.board().several()) {
    const accel::SolveWork work = accel::longest_solve(scene.computation().board().settings());
    a.several = {several->shares().size(), several->solve(work).link_clocks()};
  }
  return a;
}

void AcceleratorFigures::report(config::Figures& f) const {
  f.text("device", device, "the FPGA's name");
  f.count(
      "solve_cycles", solve_cycles(),
      "the run's longest solve as the engine counted it, where `fidelity.accelerator` has one "
      "(`approximately-timed`, `cycle-accurate`); else the closed form of a solve that makes all "
      "its iterations");
  f.time("solve_us", solve_cycles() * clock_period_ps, "how long that takes");
  f.count("iteration_cycles", closed_form.iteration(), "an iteration by the closed form");
  f.count("illegal_accesses", illegal_accesses, "that the register map does not allow");
  f.if_present(engine, [&](const EngineClocks& e) {
    f.count("closed_form_cycles", e.closed_form,
            "with an engine only: the closed form of that same solve");
    f.ratio("closed_form_deviation_rel", e.deviation(), "how far it is from the engine");
    f.list(
        "phases",
        "they sum to the clocks. `wait` is a start that came before U was copied, `set_up` all "
        "until the first iteration, `product`, `update`, `direction` the groups a, b, c of thesis "
        "Fig. 4.4",
        e.phases, [&](const PhaseClocks& p) {
          f.text("phase", p.name, "its name");
          f.count("cycles", p.engine, "as the engine counted them");
          f.count("closed_form_cycles", p.closed_form, "by the closed form");
        });
  });
  f.if_present(several, [&](const Several& s) {
    f.count("devices", s.devices,
            "with `[accelerator.several]` only: how many share the rows "
            "([several-devices.md](several-devices.md))");
    f.count("link_cycles", s.link_cycles, "the clocks that their links add to a solve");
  });
}

std::string clocks_text(const app::Scene& scene) {
  const fixed::Settings& solver = scene.scenario().solver;
  const accel::SolveCycles c = scene.solve_cycles();
  std::string text = fmt::format("\nClocks of a solve: {}\n", display_name(solver.method));
  const auto row = [&text](std::string_view what, std::int64_t clocks) {
    fmt::format_to(std::back_inserter(text), "  {:<34} {:>10}\n", what, clocks);
  };
  row("set-up", c.setup);
  row("an iteration", c.iteration());
  row("  product and inner product", c.sparse_product);
  row("  solution and residual", c.update);
  row("  direction", c.direction);
  row(scene.board().several() ? "  divisions, and sums over links"
                              : "  divisions that are waited for",
      c.divisions);
  if (c.replacements > 0) row("a residual formed anew", c.replacement);
  row(fmt::format("{}{} iterations", solver.stop_residual > 0 ? "at most " : "", c.iterations),
      c.total());
  return text;
}

std::string resources_text(const app::Scene& scene) {
  std::string text = fmt::format("\nMemory and multipliers of the {}{}\n",
                                 scene.board().several() ? "fullest " : "", scene.device().name);
  for (const accel::Resource& r : scene.usage().resources) {
    std::string uses;
    for (const accel::Allocation& a : scene.usage().allocations) {
      if (a.type != r.type) continue;
      uses += fmt::format("{}{} {}", uses.empty() ? "  " : ", ", a.use, a.blocks);
    }
    fmt::format_to(std::back_inserter(text), "  {:<12} {:>4} of {}{}\n", r.type, r.used,
                   r.available, uses);
  }
  return text;
}

std::string several_text(const app::Scene& scene) {
  const std::optional<accel::SeveralDevices>& several = scene.board().several();
  if (!several) return {};
  const accel::Architecture& a = scene.scenario().accelerator;
  const accel::SolveWork work = accel::longest_solve(scene.computation().board().settings());
  const accel::SeveralCycles c = several->solve(work);
  std::string text = "\nSeveral devices\n";
  const auto out = std::back_inserter(text);
  const std::vector<accel::DeviceShare>& shares = several->shares();
  for (std::size_t d = 0; d < shares.size(); ++d) {
    fmt::format_to(out, "  device {:<27} {:>10} nodes' rows; vectors of {} nodes, {} of others'\n",
                   d + 1, shares[d].pattern.nodes(), shares[d].pattern.nodes_in_vectors(),
                   shares[d].halo);
  }
  const auto row = [&out](const char* what, std::int64_t clocks) {
    fmt::format_to(out, "  {:<34} {:>10}\n", what, clocks);
  };
  row("clocks of links an iteration", c.link_clocks_an_iteration());
  row("  before the product or behind it", c.solve.sparse_product - c.alone.sparse_product);
  row("  sums", c.solve.divisions - c.alone.divisions);
  row("clocks of links a solve", c.link_clocks());
  fmt::format_to(out, "  {:<34}", "speed-up over one device");
  for (const accel::Scaling& s : accel::scaling(a, scene.pattern(), work, 8)) {
    fmt::format_to(out, " {}: {:.2f}", s.devices, s.speed_up);
  }
  fmt::format_to(out, "\n  {:<34} {:>10.2f}\n", "  tends to, with free links",
                 accel::speed_up_limit(a, scene.pattern(), work));
  return text;
}

}  // namespace hvp::results
