#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/results/engine_text.h"
#include "app/results/number_text.h"
#include "app/results/several_text.h"
#include "app/results/spectrum_text.h"
#include "app/scenario/message.h"
#include "app/scene/frame_cost.h"
#include "models/config/effects.h"
#include "models/plant/kinematics_measures.h"

namespace hvp::app {

namespace {

void fidelity_line(const char* part, const char* level, const std::string& what) {
  print("  {:<12} {:<14} {}\n", part, level, what);
}

// What is listed below with the constants that these stand for.
bool draws_bus_times(const Scenario& s) {
  return s.bus.read_latencies || (s.bus.pcie && s.bus.pcie->root_complex_latencies);
}

// Who makes the forces, and of what.
void numbers_lines(const Scene& scene) {
  const Scenario& s = scene.scenario();
  if (s.timing_only()) {
    fidelity_line("numbers", vp::name(s.fidelity.numbers),
                  fmt::format("timing only: all {} iterations a solve, the probe against the "
                              "undeformed body; no words, forces or deformation",
                              s.solver.iterations));
  } else if (scene.has_board()) {
    fidelity_line(
        "numbers", vp::name(s.fidelity.numbers),
        fmt::format("{}-bit matrix, {}-bit vectors", s.solver.matrix_bits, s.solver.vector_bits));
  } else {
    fidelity_line("numbers", "double", "of the host");
  }
}

// What the joints are worth where the probes go.
void workspace_lines(const Scene& scene) {
  const plant::DeviceSettings& d = scene.scenario().device;
  if (!d.kinematics) return;
  print("\nThe device over its way\n");
  const std::unique_ptr<plant::Kinematics> kinematics = plant::make_kinematics(*d.kinematics);
  const auto line = [&](const Eigen::Vector3d& tip) {
    print("  at ({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * tip.x(), 1e3 * tip.y(), 1e3 * tip.z());
    if (d.encoder && d.encoder->at == plant::Encoder::At::joints) {
      const auto step = plant::resolution(*kinematics, d.encoder->joints.step(), tip);
      if (step)
        print(", read in steps of {} to {}", results::readable_length((*step)[2]),
              results::readable_length((*step)[0]));
    }
    if (d.motor && d.amplifier) {
      const Eigen::Vector3d torque =
          d.amplifier->current_limit_A * d.motor->torque_constant_N_m_A * d.motor->transmission;
      print(", at most");
      for (int i = 0; i < 3; ++i) {
        const auto force = plant::force_limit(*kinematics, torque, tip, Eigen::Vector3d::Unit(i));
        if (force) print(" {}", results::newtons(*force));
      }
      print(" along x, y, z");
    }
    print("\n");
  };
  for (const plant::Trajectory& probe : scene.scenario().probes) {
    line(probe.start);
    for (const plant::Segment& stroke : probe.motion) line(stroke.to);
  }
}

// A force acts at a node: how far that is from where the scenario wants it.
void point_loads(const Scene& scene) {
  const mesh::TetMesh& mesh = scene.body().mesh();
  const std::vector<fem::PointLoad>& points = scene.scenario().loads.points;
  if (!points.empty()) print("\nPoint loads\n");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& node =
        mesh.nodes[static_cast<std::size_t>(fem::nearest_node(mesh, points[i].position))];
    print("  loads.point[{}] at ({:.4g}, {:.4g}, {:.4g}) mm, a node {:.3g} mm from its position\n",
          i, 1e3 * node.x(), 1e3 * node.y(), 1e3 * node.z(),
          1e3 * (node - points[i].position).norm());
  }
}

void frame_cost(const Scene& scene) {
  for (const FrameStep& step : frame_steps(scene)) {
    print("  {:<34} {:>10}\n", step.what, results::readable_time(step.ps));
  }
}

}  // namespace

int explain_command(const ScenarioArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Progress progress = make_progress(arguments.quiet);
  const Scene scene = build_scene(loaded, progress);
  end_progress(arguments.quiet);
  const Scenario& s = scene.scenario();
  if (!s.title.empty()) print("{}\n", scenario::one_line(s.title, 1000));
  print("\nParts and their fidelity\n");
  if (scene.has_board()) {
    fidelity_line("accelerator", vp::name(s.fidelity.accelerator),
                  fmt::format("{}, {}{} clocks a solve{}", scene.board_name(),
                              s.solver.stop_residual > 0 && !s.timing_only() ? "at most " : "",
                              scene.solve_cycles().total(),
                              vp::has_engine(s.fidelity.accelerator)
                                  ? " by the closed form; a run prints the engine's"
                                  : ""));
  } else {
    fidelity_line("accelerator", "absent",
                  scene.has_body() ? fmt::format("the host solves: {}", host::name(s.host.solver))
                                   : "the host renders a wall");
  }
  fidelity_line("bus", vp::name(s.fidelity.bus),
                fmt::format("{} bytes a data phase, {:g} ns a clock", s.bus.pci.width_bytes(),
                            static_cast<double>(s.bus.pci.clock_period_ps()) * 1e-3));
  if (s.bus.pcie) {
    const link::Pcie& link = *s.bus.pcie;
    fidelity_line(
        "link", vp::name(s.fidelity.bus),
        fmt::format("PCIe Gen{} x{}, {:.3g} GB/s raw, {:.3g} GB/s for packets; the solver "
                    "board's alone",
                    static_cast<int>(link.generation) + 1, link.lanes, link.raw_rate() * 1e-9,
                    link.tlp_rate() * 1e-9));
  }
  if (scene.has_board()) {
    fidelity_line("transfer", vp::name(s.transfer.method),
                  fmt::format("b and U, {}; the end by {}",
                              s.transfer.packed ? "packed" : "one element a word",
                              link::name(s.transfer.notification)));
  }
  fidelity_line("host", vp::name(s.fidelity.host),
                scene.has_body()
                    ? fmt::format("servo at {:g} Hz, collision and graphics at {:g} Hz, {}",
                                  1 / s.budget.period_s, s.host.graphics.rate_hz,
                                  s.host.cores == 1 ? "on one core" : "a core each")
                    : fmt::format("servo at {:g} Hz", 1 / s.budget.period_s));
  numbers_lines(scene);
  print("\nEffects\n");
  for (const config::Effect& effect : config::survey_effects(s).effects()) {
    print("  {:<31} {:<8} {}\n", effect.path, effect.present ? "built" : "absent", effect.cost);
  }
  workspace_lines(scene);
  if (!scene.has_body()) return kHeld;
  point_loads(scene);
  if (scene.spectrum()) {
    print("\nSpectrum of the system without contact\n{}",
          results::spectrum_text(*scene.spectrum()));
  }
  print("\nWhat a frame's large steps cost (the bus without waits{}{})\n",
        s.bus.posted_writes ? ", and as if nothing were posted" : "",
        draws_bus_times(s) ? ", latencies that are drawn at their constants" : "");
  frame_cost(scene);
  if (!scene.has_board()) return kHeld;
  print("{}{}{}", results::clocks_text(scene), results::several_text(scene),
        results::resources_text(scene));
  return kHeld;
}

}  // namespace hvp::app
