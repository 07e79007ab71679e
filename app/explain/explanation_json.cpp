#include "app/explain/explanation_json.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "app/results/figures_json.h"
#include "app/results/scene_figures.h"

namespace hvp::app {

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
    list.push_back(std::move(one));
  }
  return list;
}

ordered_json frame_json(const Explanation& e) {
  if (e.steps.empty()) return nullptr;
  ordered_json steps = ordered_json::array();
  for (const FrameStep& step : e.steps) {
    steps.push_back({{"what", step.what},
                     {"ps", step.ps},
                     {"us", static_cast<double>(step.ps) / 1e6},
                     {"times", step.times},
                     {"after_force", step.after_force}});
  }
  return {{"steps", steps},
          {"latency_us", static_cast<double>(latency_ps(e.steps)) / 1e6},
          {"frame_us", static_cast<double>(frame_ps(e.steps)) / 1e6}};
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
  // By the declarations of a run's figures.
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
