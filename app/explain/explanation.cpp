#include "app/explain/explanation.h"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include <fmt/format.h>

#include "app/results/figures.h"
#include "app/results/scene_figures.h"
#include "app/scenario/quantity.h"
#include "models/plant/kinematics.h"
#include "models/time/picoseconds.h"

namespace hvp::app {

namespace {

// What a core of the host does in a second, so that a price can be formed by hand.
std::string price_text(const host::Processor& p) {
  using config::Dimension;
  const auto rate = [](double value) {
    return scenario::format_quantity(value, Dimension::throughput);
  };
  std::string text =
      fmt::format("{} a call; {} dense, {} in single precision, {} sparse, {} triangular",
                  scenario::format_quantity(p.call_s, Dimension::time), rate(p.dense_flops),
                  rate(p.single_flops), rate(p.sparse_flops), rate(p.triangular_flops));
  for (const host::Processor::Tier& tier : p.caches) {
    text +=
        fmt::format("; {} at {}", scenario::format_quantity(tier.size_bytes, Dimension::data_size),
                    scenario::format_quantity(tier.bandwidth, Dimension::bandwidth));
  }
  return text + "; memory at " +
         scenario::format_quantity(p.memory_bandwidth, Dimension::bandwidth);
}

ExplainedPart accelerator(const Scene& scene) {
  const Scenario& s = scene.scenario();
  if (!scene.has_board()) {
    return {"accelerator", "absent",
            scene.has_body() ? fmt::format("the host solves: {}", host::name(s.host.solver))
                             : "the host renders a wall"};
  }
  return {"accelerator", vp::name(s.fidelity.accelerator),
          fmt::format("{}, {}{} clocks a solve{}", scene.board_name(),
                      s.solver.stop_residual > 0 && !s.timing_only() ? "at most " : "",
                      scene.solve_cycles().total(),
                      vp::has_engine(s.fidelity.accelerator)
                          ? " by the closed form; a run prints the engine's"
                          : "")};
}

// Describes who computes the forces, and with which model.
ExplainedPart numbers(const Scene& scene) {
  const Scenario& s = scene.scenario();
  if (s.timing_only()) {
    return {"numbers", vp::name(s.fidelity.numbers),
            fmt::format("timing only: all {} iterations a solve, the probe against the "
                        "undeformed body; no words, forces or deformation",
                        s.solver.iterations)};
  }
  if (!scene.has_board()) return {"numbers", host::name(s.host.precision), "of the host"};
  return {"numbers", vp::name(s.fidelity.numbers),
          fmt::format("{}-bit matrix, {}-bit vectors", s.solver.matrix_bits, s.solver.vector_bits)};
}

std::vector<ExplainedPart> explained_parts(const Scene& scene) {
  const Scenario& s = scene.scenario();
  std::vector<ExplainedPart> parts = {
      accelerator(scene),
      {"bus", vp::name(s.fidelity.bus),
       fmt::format("{} bytes a data phase, {:g} ns a clock", s.bus.pci.width_bytes(),
                   static_cast<double>(s.bus.pci.clock_period_ps()) * 1e-3)}};
  if (s.bus.pcie) {
    const link::Pcie& link = *s.bus.pcie;
    parts.push_back(
        {"link", vp::name(s.fidelity.bus),
         fmt::format("PCIe Gen{} x{}, {:.3g} GB/s raw, {:.3g} GB/s for packets; the solver "
                     "board's alone",
                     static_cast<int>(link.generation) + 1, link.lanes, link.raw_rate() * 1e-9,
                     link.tlp_rate() * 1e-9)});
  }
  if (scene.has_board()) {
    parts.push_back({"transfer", vp::name(s.transfer.method),
                     fmt::format("b and U, {}; the end by {}",
                                 s.transfer.packed ? "packed" : "one element a word",
                                 link::name(s.transfer.notification))});
  }
  parts.push_back({"host", vp::name(s.fidelity.host),
                   scene.has_body()
                       ? fmt::format("servo at {:g} Hz, collision and graphics at {:g} Hz, {}",
                                     1 / s.budget.period_s, s.host.graphics.rate_hz,
                                     s.host.cores == 1 ? "on one core" : "a core each")
                       : fmt::format("servo at {:g} Hz", 1 / s.budget.period_s)});
  if (const host::Processor* prices = s.host.prices()) {
    parts.push_back({"prices", host::name(s.host.model), price_text(*prices)});
  }
  parts.push_back(numbers(scene));
  return parts;
}

WorkspacePoint workspace_point(const plant::DeviceSettings& d, const plant::Kinematics& kinematics,
                               const Eigen::Vector3d& tip) {
  WorkspacePoint point;
  point.tip = tip;
  if (d.encoder && d.encoder->at == plant::Encoder::At::joints) {
    const auto step = plant::resolution(kinematics, d.encoder->joints.step(), tip);
    if (step) point.steps = {(*step)[2], (*step)[0]};
  }
  if (d.dynamics && d.dynamics->at == plant::DeviceDynamics::At::joints) {
    point.mass = d.dynamics->joints.apparent_mass(kinematics, tip);
  }
  point.limited = d.motor && d.amplifier;
  if (!point.limited) return point;
  const Eigen::Vector3d torque =
      d.amplifier->current_limit_A * d.motor->torque_constant_N_m_A * d.motor->transmission;
  for (int i = 0; i < 3; ++i) {
    const auto force = plant::force_limit(kinematics, torque, tip, Eigen::Vector3d::Unit(i));
    if (force) point.force_limit[static_cast<std::size_t>(i)] = *force;
  }
  return point;
}

// Describes the device at places along the probes' way.
std::vector<WorkspacePoint> workspace(const Scene& scene) {
  std::vector<WorkspacePoint> points;
  const Scenario& s = scene.scenario();
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    const plant::DeviceSettings& d = s.device_of(i);
    if (!d.kinematics) continue;
    const std::unique_ptr<plant::Kinematics> kinematics = plant::make_kinematics(*d.kinematics);
    const plant::Trajectory& probe = s.probes[i];
    points.push_back(workspace_point(d, *kinematics, probe.start));
    for (const plant::Segment& stroke : probe.motion) {
      points.push_back(workspace_point(d, *kinematics, stroke.to));
    }
  }
  return points;
}

std::vector<PlacedLoad> placed_loads(const Scene& scene) {
  const mesh::TetMesh& mesh = scene.body().mesh();
  const std::vector<fem::PointLoad>& points = scene.scenario().loads.points;
  std::vector<PlacedLoad> placed;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& node =
        mesh.nodes[static_cast<std::size_t>(fem::nearest_node(mesh, points[i].position))];
    placed.push_back({i, node, (node - points[i].position).norm()});
  }
  return placed;
}

}  // namespace

Explanation explain(Scene& scene) {
  Explanation e;
  e.parts = explained_parts(scene);
  e.effects = scene.scenario().effects();
  // A matrix that is never renewed has its table, and nothing is built for it.
  const std::optional<tissue::Model>& model = scene.scenario().object.model;
  for (config::Effect& effect : e.effects) {
    if (effect.path != "object.model.matrix" || !model || !model->matrix) continue;
    effect.present = model->matrix->present();
  }
  e.platform = platform_parts(scene);
  e.workspace = workspace(scene);
  if (!scene.has_body()) return e;
  e.loads = placed_loads(scene);
  e.steps = frame_steps(scene);
  e.renew_every = scene.scenario().object.renewal().every;
  e.renewal = renewal_steps(scene);
  if (!e.renewal.empty()) {
    const std::int64_t whole = frame_ps(e.steps) + frame_ps(e.renewal);
    e.renewal_behind_ps =
        std::max<std::int64_t>(0, whole - to_picoseconds(scene.scenario().budget.period_s));
  }
  return e;
}

namespace {

using nlohmann::ordered_json;

ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json parts_json(const Explanation& e) {
  ordered_json list = ordered_json::array();
  for (const ExplainedPart& part : e.parts) {
    list.push_back({{"part", part.part}, {"fidelity", part.level}, {"what", part.what}});
  }
  return list;
}

ordered_json effects_json(const Explanation& e) {
  ordered_json list = ordered_json::array();
  for (const config::Effect& effect : e.effects) {
    list.push_back({{"path", effect.path}, {"built", effect.present}, {"adds", effect.cost}});
  }
  return list;
}

ordered_json platform_json(const PlatformParts& platform) {
  ordered_json modules = ordered_json::array();
  for (const PlatformModule& module : platform.modules) {
    ordered_json processes = ordered_json::array();
    for (const PlatformProcess& process : module.processes) {
      processes.push_back({{"name", process.name}, {"kind", process.kind}});
    }
    modules.push_back({{"name", module.name}, {"kind", module.kind}, {"processes", processes}});
  }
  return {{"modules", modules}, {"processes", platform.processes()}};
}

ordered_json workspace_json(const Explanation& e) {
  ordered_json list = ordered_json::array();
  for (const WorkspacePoint& point : e.workspace) {
    ordered_json one = {{"tip_m", vector_json(point.tip)}};
    if (point.steps) one["steps_m"] = {(*point.steps)[0], (*point.steps)[1]};
    if (point.limited) {
      one["force_limit_N"] = ordered_json::array();
      for (const std::optional<double>& force : point.force_limit) {
        one["force_limit_N"].push_back(force ? ordered_json(*force) : ordered_json(nullptr));
      }
    }
    if (point.mass) one["apparent_mass_kg"] = vector_json(*point.mass);
    list.push_back(std::move(one));
  }
  return list;
}

ordered_json steps_json(const std::vector<FrameStep>& steps) {
  ordered_json list = ordered_json::array();
  for (const FrameStep& step : steps) {
    list.push_back({{"what", step.what},
                    {"ps", step.ps},
                    {"us", static_cast<double>(step.ps) / 1e6},
                    {"times", step.times},
                    {"after_force", step.after_force}});
  }
  return list;
}

ordered_json frame_json(const Explanation& e) {
  if (e.steps.empty()) return nullptr;
  ordered_json frame = {{"steps", steps_json(e.steps)},
                        {"latency_us", static_cast<double>(latency_ps(e.steps)) / 1e6},
                        {"frame_us", static_cast<double>(frame_ps(e.steps)) / 1e6}};
  if (!e.renewal.empty()) {
    const std::int64_t whole = frame_ps(e.steps) + frame_ps(e.renewal);
    frame["renewal"] = {{"every", e.renew_every},
                        {"steps", steps_json(e.renewal)},
                        {"frame_us", static_cast<double>(whole) / 1e6},
                        {"behind_us", static_cast<double>(e.renewal_behind_ps) / 1e6}};
  }
  return frame;
}

}  // namespace

ordered_json explanation_json(const Scene& scene, const Explanation& e) {
  const results::SceneFigures figures = results::scene_figures(scene);
  ordered_json j;
  j["title"] = figures.title;
  j["solver"] = figures.solver;
  j["parts"] = parts_json(e);
  j["effects"] = effects_json(e);
  j["platform"] = platform_json(e.platform);
  j["workspace"] = workspace_json(e);
  j["point_loads"] = ordered_json::array();
  for (const PlacedLoad& load : e.loads) {
    j["point_loads"].push_back(
        {{"index", load.index}, {"node_m", vector_json(load.node)}, {"off_m", load.off}});
  }
  j["frame"] = frame_json(e);
  // The accelerator's figures are declared as in a run's results.
  results::FiguresJson declared;
  const std::optional<results::AcceleratorFigures> board =
      results::accelerator_figures(scene, nullptr);
  declared.table_or_null("accelerator", {}, board);
  figures.report_resources(declared);
  declared.table_or_null("mesh", {}, figures.body);
  declared.table_or_null("condition", {}, figures.condition);
  j.update(declared.root());
  return j;
}

}  // namespace hvp::app
