#include "app/results/scene_figures.h"

#include "app/results/summary.h"

namespace hvp::results {

SceneFigures scene_figures(const app::Scene& scene) {
  const app::Scenario& s = scene.scenario();
  std::optional<BodyFigures> body;
  if (scene.has_body()) {
    body = {scene.quality(), scene.body().active_nodes(), scene.computation().matrix().blocks()};
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
    if (const auto& longest = board->longest_solve()) {
      a.engine = engine_clocks(*longest, accel::solve_cycles(scene.scenario().accelerator,
                                                             scene.pattern(), longest->work));
    }
  }
  if (const std::optional<accel::SeveralDevices>& several = scene.board().several()) {
    const accel::SolveWork work = accel::longest_solve(scene.computation().board_settings());
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

}  // namespace hvp::results
