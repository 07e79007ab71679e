#include "app/remedy/wall_remedy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace hvp::app {

namespace {

// Rounds down to two digits.
double rounded_down(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::floor(value / unit) * unit;
}

}  // namespace

std::optional<results::TriedRemedy> try_wall_remedy(const Scenario& s, stability::Flags flags,
                                                    const results::StiffnessBudget& budget,
                                                    const Rerun& rerun) {
  using stability::Flag;
  if (!s.wall || (!flags.has(Flag::active_port) && !flags.has(Flag::limit_cycle))) {
    return std::nullopt;
  }
  // Where damping makes no wall passive, half of the largest stable stiffness.
  const double most = budget.passive_N_m > 0 ? 0.99 * budget.passive_N_m : 0.5 * budget.stable_N_m;
  results::TriedRemedy tried;
  tried.of = flags;
  tried.frames = static_cast<std::size_t>(s.frames);
  for (const double share : {1.0, 0.5, 0.1}) {
    const double stiffness = share * most;
    if (!(stiffness > 0 && stiffness < s.wall->stiffness_N_m)) continue;
    const std::string setting =
        fmt::format("wall.stiffness = \"{:g} N/m\"", rounded_down(stiffness));
    ++tried.attempts;
    const std::optional<stability::Flags> left = rerun(results::override_text(setting));
    if (!left) return std::nullopt;
    tried.left = *left;
    if (!left->empty()) continue;
    tried.settings = {setting};
    return tried;
  }
  if (tried.attempts == 0) return std::nullopt;
  return tried;
}

}  // namespace hvp::app
