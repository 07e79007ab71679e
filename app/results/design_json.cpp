#include <nlohmann/json.hpp>

#include "app/results/design_report.h"

namespace hvp::results {

namespace {

using nlohmann::ordered_json;

double us(std::int64_t ps) { return static_cast<double>(ps) / 1e6; }

ordered_json cycles(const accel::SolveCycles& c) {
  return {{"setup", c.setup},
          {"iteration", c.iteration()},
          {"sparse_product", c.sparse_product},
          {"update", c.update},
          {"direction", c.direction},
          {"divisions", c.divisions},
          {"iterations", c.iterations},
          {"replacement", c.replacement},
          {"replacements", c.replacements},
          {"solve", c.total()}};
}

ordered_json path(const accel::Path& p) {
  ordered_json elements = ordered_json::array();
  for (const accel::Element& e : p.elements) {
    elements.push_back({{"element", accel::text(e)}, {"ns", e.delay_s * 1e9}});
  }
  return {{"name", p.name}, {"period_ns", p.period_s() * 1e9}, {"elements", elements}};
}

ordered_json clock(const accel::Architecture& a, const app::DesignFigures& f) {
  ordered_json j = {
      {"hz", a.clock_hz}, {"highest_hz", nullptr}, {"reached", f.clock_is_reached(a)}};
  j["paths"] = ordered_json::array();
  if (!f.clock) return j;
  j["highest_hz"] = f.clock->highest_clock_hz;
  for (const accel::Path& p : f.clock->paths) j["paths"].push_back(path(p));
  return j;
}

ordered_json resources(const accel::Usage& usage) {
  ordered_json list = ordered_json::array();
  for (const accel::Resource& r : usage.resources) {
    ordered_json uses = ordered_json::array();
    for (const accel::Allocation& a : usage.allocations) {
      if (a.type == r.type) uses.push_back({{"use", a.use}, {"blocks", a.blocks}});
    }
    list.push_back(
        {{"type", r.type}, {"used", r.used}, {"available", r.available}, {"uses", uses}});
  }
  return list;
}

ordered_json obstacles(const accel::Usage& usage) {
  ordered_json list = ordered_json::array();
  for (const accel::Obstacle& o : usage.obstacles) {
    list.push_back({{"key", "accelerator." + o.key}, {"reason", o.reason}});
  }
  return list;
}

ordered_json reach(const app::Reach& r) {
  if (r.solve_ps == 0) {
    return {{"nodes", r.nodes},         {"mesh_nodes", r.mesh_nodes}, {"solve_us", nullptr},
            {"solve_rate_hz", nullptr}, {"frame_us", nullptr},        {"frame_rate_hz", nullptr}};
  }
  return {{"nodes", r.nodes},           {"mesh_nodes", r.mesh_nodes},
          {"solve_us", us(r.solve_ps)}, {"solve_rate_hz", r.solve_rate_hz()},
          {"frame_us", us(r.frame_ps)}, {"frame_rate_hz", r.frame_rate_hz()}};
}

ordered_json what_if(const std::vector<app::WhatIf>& list) {
  ordered_json j = ordered_json::array();
  for (const app::WhatIf& w : list) {
    ordered_json one = {{"key", w.variation.key},
                        {"from", w.variation.from},
                        {"to", w.variation.to},
                        {"changes_words", w.variation.numbers}};
    if (w.refused.empty()) {
      one["solve_cycles"] = w.solve_clocks;
      one["highest_hz"] =
          w.highest_clock_hz ? ordered_json(*w.highest_clock_hz) : ordered_json(nullptr);
      one["solve_us"] = w.solve_s * 1e6;
      one["fits"] = w.short_of.empty();
      one["short_of"] = w.short_of;
    } else {
      one["refused"] = w.refused;
    }
    j.push_back(std::move(one));
  }
  return j;
}

}  // namespace

std::string design_json(const app::Scene& scene, const app::DesignFigures& f) {
  const app::Scenario& s = scene.scenario();
  ordered_json j;
  j["title"] = s.title;
  j["device"] = {{"name", scene.device().name}, {"family", scene.device().family}};
  j["fits"] = f.usage.fits();
  j["cycles"] = cycles(f.cycles);
  j["clock"] = clock(s.accelerator, f);
  j["resources"] = resources(f.usage);
  j["obstacles"] = obstacles(f.usage);
  j["devices"] = s.accelerator.several ? s.accelerator.several->devices : 1;
  if (const std::optional<accel::SeveralDevices>& several = scene.board().several()) {
    const accel::SeveralCycles c =
        several->solve(accel::longest_solve(scene.computation().board_settings()));
    j["links"] = {{"clocks_an_iteration", c.link_clocks_an_iteration()},
                  {"clocks_a_solve", c.link_clocks()}};
  }
  j["packing"] = {{"nonzeros", f.packing.nonzeros},
                  {"stored", f.packing.stored},
                  {"padding_rel", f.packing.loss()},
                  {"imbalance_rel", f.packing.balance.loss()}};
  j["operations_per_s"] = {{"thesis", f.operations.thesis},
                           {"peak", f.operations.peak},
                           {"product", f.operations.product},
                           {"solve", f.operations.solve}};
  j["mesh"] = reach(f.scene);
  j["largest_mesh"] = f.largest ? reach(*f.largest) : ordered_json(nullptr);
  j["what_if"] = what_if(f.what_if);
  return j.dump(2) + "\n";
}

}  // namespace hvp::results
