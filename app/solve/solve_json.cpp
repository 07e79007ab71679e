#include "app/solve/solve_json.h"

#include <nlohmann/json.hpp>

#include "app/results/figures.h"
#include "app/results/flags.h"
#include "app/results/settings_json.h"
#include "models/accel/memory.h"

namespace hvp::app {

namespace {

using nlohmann::ordered_json;

ordered_json resources(const accel::Usage& usage) {
  ordered_json list = ordered_json::array();
  for (const accel::Resource& r : usage.resources) {
    list.push_back({{"type", r.type}, {"used", r.used}, {"available", r.available}});
  }
  return list;
}

// The remedy of a single system: error_rel replaces the figures that only a run has.
ordered_json remedy_json(const results::TriedRemedy& r) {
  ordered_json j = results::figures_json(r);
  for (const char* of_a_run :
       {"frames", "displacement_p95_rel", "latency_us", "load_us", "in_time"}) {
    j.erase(of_a_run);
  }
  j["error_rel"] = r.left.empty() ? ordered_json(r.median) : nullptr;
  if (!r.left.empty()) j["fits"] = nullptr;
  j.erase("displacement_median_rel");
  return j;
}

}  // namespace

std::string solve_json(const LinearSystem& system, const SolveTask& task, const SystemSolution& s) {
  ordered_json j;
  j["dimension"] = system.rows;
  j["nonzeros"] = s.nonzeros;
  j["solves"] = s.board.solves;
  j["iterations"] = s.board.iterations;
  j["error_rel"] = s.error;
  j["error_rel_quantised"] = s.error_rounded ? ordered_json(*s.error_rounded) : nullptr;
  j["residual_rel"] = s.residual;
  j["residual_rel_quantised"] = s.residual_rounded;
  j["residual_recursive_rel"] = s.board.residual_recursive;
  j["saturations"] = s.board.saturations;
  j["wraps"] = s.board.wraps;
  j["breakdowns"] = s.board.breakdowns;
  j["clamped_words"] = s.clamped;
  j["flags"] = results::flag_names(s.flags);
  j["remedies"] = results::remedies_json(s.flags);
  j["remedy"] = s.remedy ? remedy_json(*s.remedy) : ordered_json(nullptr);
  j["tolerance"] = task.tolerance;
  j["cycles"] = s.board.cycles;
  j["time_us"] = static_cast<double>(s.board.time_ps) / 1e6;
  j["device"] = task.device.name;
  j["fits"] = s.usage.fits();
  j["resources"] = resources(s.usage);
  j["x_unit"] = s.unit;
  j["x_range_from"] = s.range_from;
  j["nonpositive_eigenvalues_quantised"] =
      s.rounded_nonpositive < 0 ? ordered_json(nullptr) : ordered_json(s.rounded_nonpositive);
  j["condition"] = s.spectrum ? results::figures_json(*s.spectrum) : ordered_json(nullptr);
  SolveSettings in_force = task.settings;
  in_force.solver = s.solver;
  j["settings"] = results::settings_json(in_force);
  return j.dump(2) + "\n";
}

}  // namespace hvp::app
