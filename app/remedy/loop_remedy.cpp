#include "app/remedy/loop_remedy.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace hvp::app {

namespace {

using stability::Flag;
using stability::Flags;

// Rounds down to two digits.
double rounded_down(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::floor(value / unit) * unit;
}

bool of_the_loop(Flags flags) {
  return flags.has(Flag::active_port) || flags.has(Flag::limit_cycle) ||
         flags.has(Flag::low_gain_margin);
}

// The contact's stiffness that is aimed at first: passive whoever grips the device or, where
// damping makes none passive, half of what is stable, and within the margin that is asked for.
double stiffness_aimed_at(const Scenario& s, const results::StiffnessBudget& budget) {
  const double calm =
      budget.worst_passive_N_m > 0 ? 0.99 * budget.worst_passive_N_m : 0.5 * budget.edge_N_m;
  return std::min(calm, 0.99 * budget.edge_N_m / s.budget.gain_margin);
}

std::vector<std::vector<std::string>> candidates(const Scenario& s,
                                                 const results::StiffnessBudget& budget) {
  std::vector<std::vector<std::string>> found;
  const double aim = stiffness_aimed_at(s, budget);
  for (const double share : {1.0, 0.5, 0.1}) {
    const double stiffness = share * aim;
    if (!budget.contact_N_m || !(stiffness > 0) || !(stiffness < *budget.contact_N_m)) continue;
    if (s.wall) {
      found.push_back({fmt::format("wall.stiffness = \"{:g} N/m\"", rounded_down(stiffness))});
    } else {
      const double times = stiffness / *budget.contact_N_m;
      const auto softer = [&](const std::string& table, const fem::Material& material) {
        return fmt::format("{}.young_modulus = \"{:g} Pa\"", table,
                           rounded_down(material.young_modulus_pa * times));
      };
      std::vector<std::string> settings = {softer("object.material", s.object.material)};
      for (std::size_t i = 0; i < s.object.regions.size(); ++i) {
        settings.push_back(softer(fmt::format("object.region[{}]", i),
                                  s.object.regions[i].material.value_or(s.object.material)));
      }
      found.push_back(std::move(settings));
    }
  }
  for (const double times : {2.0, 4.0}) {
    const std::size_t probe = budget.probe.value_or(0);
    found.push_back({fmt::format("{}.dynamics.damping = \"{:g} N s/m\"", s.device_key(probe),
                                 times * s.device_of(probe).dynamics->damping_N_s_m)});
  }
  if (s.host.delay) found.push_back({"host.delay = false"});
  if (budget.worst_delay_s < 0.45 * s.budget.period_s) {
    found.push_back({fmt::format("budget.period = \"{:g} ms\"", 0.5e3 * s.budget.period_s),
                     fmt::format("frames = {}", 2 * s.frames)});
  }
  return found;
}

}  // namespace

std::optional<results::TriedRemedy> try_loop_remedy(const Scenario& s, Flags flags,
                                                    const results::StiffnessBudget& budget,
                                                    const std::vector<std::string>& before,
                                                    const Rerun& rerun) {
  if (!of_the_loop(flags)) return std::nullopt;
  std::vector<std::vector<std::string>> all;
  for (const std::vector<std::string>& settings : candidates(s, budget)) {
    all.push_back(before);
    all.back().insert(all.back().end(), settings.begin(), settings.end());
  }
  return try_whole_runs({.flags = flags, .held = true, .frames = s.frames}, all, rerun);
}

}  // namespace hvp::app
