#include "app/results/summary.h"

#include <nlohmann/json.hpp>

#include "app/results/fault_json.h"
#include "app/results/flag_json.h"
#include "app/results/latency_json.h"
#include "app/results/number_text.h"
#include "app/results/quality_json.h"
#include "app/results/spectrum_json.h"
#include "app/results/tried_remedy.h"
#include "app/results/verdict_text.h"
#include "models/config/effects.h"

namespace hvp::results {

namespace {

using nlohmann::ordered_json;

// Null where nobody computed the words that are counted.
ordered_json stability(const Outcome& o, bool timing_only) {
  const auto count = [timing_only](std::int64_t words) {
    return timing_only ? ordered_json(nullptr) : ordered_json(words);
  };
  return {{"saturations", count(o.saturations)},
          {"wraps", count(o.wraps)},
          {"breakdowns", count(o.breakdowns)},
          {"clamped_words", count(o.clamped_words)},
          {"clamped_forces", count(o.clamped_forces)},
          {"driver_errors", o.driver_errors},
          {"flags", flag_names(o.flags)}};
}

// By how much forces were late; null where none was.
ordered_json lateness(const Outcome& o) {
  if (!o.lateness) return nullptr;
  ordered_json j = spread_json(*o.lateness);
  j["octaves"] = octaves_json(o.late_octaves, "frames");
  return j;
}

ordered_json attribution(const std::vector<vp::Attribution>& lines) {
  ordered_json list = ordered_json::array();
  for (const vp::Attribution& a : lines) {
    list.push_back({{"part", name(a.part)}, {"phase", name(a.phase)}, {"us", us(a.time)}});
  }
  return list;
}

ordered_json shares(const BusLoad& load) {
  return {{"share", load.share}, {"worst_frame_share", load.worst_share}};
}

ordered_json by_initiator(const BusLoad& load) {
  ordered_json j = ordered_json::array();
  for (const vp::BusUse& use : load.uses) {
    if (use.transactions == 0 && use.busy == 0) continue;
    j.push_back({{"initiator", use.name},
                 {"share", load.share_of(use)},
                 {"busy_us", us(use.busy)},
                 {"bytes", use.bytes},
                 {"transactions", use.transactions}});
  }
  return j;
}

ordered_json utilisation(const BusLoad& load) {
  ordered_json j = shares(load);
  j["by_initiator"] = by_initiator(load);
  return j;
}

ordered_json utilisation(const Outcome::LinkLoad& load) {
  return {{"to_board", shares(load.to_board)},
          {"to_host", shares(load.to_host)},
          {"by_initiator", by_initiator(load.to_board)}};
}

// The clocks of the longest solve: the engine's where there is one, beside the closed form of the
// same work; elsewhere the closed form of a solve that makes all its iterations.
ordered_json accelerator(const app::Scene& scene, const Outcome& o) {
  const accel::Architecture& architecture = scene.scenario().accelerator;
  const accel::SolveCycles cycles = scene.solve_cycles();
  const std::int64_t clocks = o.engine ? o.engine->engine : cycles.total();
  ordered_json j = {{"device", scene.device().name},
                    {"solve_cycles", clocks},
                    {"solve_us", us(clocks * architecture.clock_period_ps())},
                    {"iteration_cycles", cycles.iteration()},
                    {"illegal_accesses", o.illegal_accesses}};
  if (!o.engine) return j;
  j["closed_form_cycles"] = o.engine->closed_form;
  j["closed_form_deviation_rel"] = o.engine->deviation();
  ordered_json phases = ordered_json::array();
  for (const PhaseClocks& p : o.engine->phases) {
    phases.push_back(
        {{"phase", p.name}, {"cycles", p.engine}, {"closed_form_cycles", p.closed_form}});
  }
  j["phases"] = phases;
  return j;
}

}  // namespace

std::vector<std::string> effects(const app::Scenario& s) {
  std::vector<std::string> names;
  for (const config::Effect& effect : config::survey_effects(s).effects()) {
    if (effect.present) names.push_back(effect.path);
  }
  return names;
}

std::string summary_json(const app::Scene& scene, const Outcome& o) {
  const app::Scenario& s = scene.scenario();
  ordered_json j;
  j["title"] = s.title;
  j["partial"] = o.partial();
  j["frames_asked"] = o.frames_asked;
  j["held"] = o.held();
  j["verdict"] = o.held() ? verdict_word(o, s.timing_only()) : "not held";
  j["deadline"] = {{"period_us", us(o.period)},    {"budget_us", us(o.budget)},
                   {"worst_us", us(o.worst)},      {"p50_us", us(o.p50)},
                   {"p99_us", us(o.p99)},          {"misses", o.misses},
                   {"frames", o.frames},           {"skipped_ticks", o.skipped_ticks},
                   {"worst_frame", o.worst_frame}, {"held", o.force_in_time}};
  j["deadline"]["lateness"] = lateness(o);
  j["latency"] = latency_json(o.latency);
  j["jitter"]["frame_to_frame"] = spread_json(o.latency.change);
  if (o.release) j["jitter"]["release"] = spread_json(*o.release);
  if (o.wake_up) j["jitter"]["wake_up"] = spread_json(*o.wake_up);
  for (const Outcome::ErrorBudget& b : o.error_budgets) {
    j["error_budget"][std::string(b.of)] = {
        {"limit_rel", b.limit},
        {"p95_rel", b.measured ? ordered_json(b.p95) : nullptr},
        {"worst_rel", b.measured ? ordered_json(b.worst) : nullptr},
        {"held", b.held()}};
  }
  j["load"] = {{"worst_us", us(o.worst_load)}, {"misses", o.overloads}, {"held", o.load_held}};
  j["attribution"] = attribution(o.attribution);
  j["accuracy"] = accuracy_json(o);
  j["force"] = force_json(o);
  j["strain"] = strain_json(o);
  j["missed_contact"] = nullptr;
  if (o.missed_contact) {
    j["missed_contact"] = {{"m", o.missed_contact->distance}, {"frame", o.missed_contact->frame}};
  }
  j["stability"] = stability(o, s.timing_only());
  j["remedy"] = o.remedy ? remedy_json(*o.remedy) : ordered_json(nullptr);
  if (const host::RefinedSolve* refined = scene.computation().refined()) {
    j["refinement"] = {{"passes", refined->passes()},
                       {"worst_residual_rel", refined->worst_residual()},
                       {"widened", refined->widened()}};
  }
  j["driver"] = driver_json(o);
  j["faults"] = faults_json(o);
  j["condition"] = condition_json(scene.spectrum());
  ordered_json resources = ordered_json::array();
  for (const accel::Resource& r : scene.usage().resources) {
    resources.push_back({{"type", r.type}, {"used", r.used}, {"available", r.available}});
  }
  j["resources"] = resources;
  if (scene.has_board()) {
    j["accelerator"] = accelerator(scene, o);
    if (const std::optional<accel::SeveralDevices>& several = scene.board().several()) {
      const accel::SolveWork work = accel::longest_solve(scene.computation().board_settings());
      j["accelerator"]["devices"] = several->shares().size();
      j["accelerator"]["link_cycles"] = several->solve(work).link_clocks();
    }
  } else {
    j["accelerator"] = nullptr;
  }
  j["solver"] = host::name(s.host.solver);
  j["bus"] = {
      {"transactions", o.bus_transactions}, {"bytes", o.bus_bytes}, {"busy_us", us(o.bus_busy)}};
  j["bus"]["utilisation"] = utilisation(o.bus_load);
  if (o.link_load) j["bus"]["pcie"]["utilisation"] = utilisation(*o.link_load);
  const mesh::Quality& q = scene.quality();
  j["mesh"] = {{"nodes", q.nodes},
               {"active_nodes", scene.body().active_nodes()},
               {"tetrahedra", q.tetrahedra},
               {"min_dihedral_deg", q.min_dihedral},
               {"max_dihedral_deg", q.max_dihedral},
               {"max_aspect_ratio", q.max_aspect_ratio},
               {"min_det_jacobian", q.min_det_jacobian},
               {"blocks", scene.computation().matrix().blocks()}};
  j["contact"] = {{"changes", o.contact_changes},
                  {"collision_passes", o.collision_passes},
                  {"longest_pass_us", us(o.longest_pass)}};
  j["set_up_us"] = us(o.set_up);
  j["effects"] = effects(s);
  j["fidelity"] = {{"accelerator", vp::name(s.fidelity.accelerator)},
                   {"bus", vp::name(s.fidelity.bus)},
                   {"host", vp::name(s.fidelity.host)},
                   {"numbers", scene.has_board() ? vp::name(s.fidelity.numbers) : "double"}};
  if (!scene.has_board()) j["fidelity"]["accelerator"] = nullptr;
  return j.dump(2) + "\n";
}

}  // namespace hvp::results
