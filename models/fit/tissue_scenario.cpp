#include "models/fit/tissue_scenario.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "models/fem/assembly.h"
#include "models/fem/locking.h"

namespace hvp::fit {
namespace {

constexpr std::array<TissueKey, 4> kKeys = {{
    {"young_modulus", "object.material.young_modulus"},
    {"poisson_ratio", "object.material.poisson_ratio"},
    {"mass_damping", "dynamics.rayleigh_mass"},
    {"stiffness_damping", "dynamics.rayleigh_stiffness"},
}};

const Estimate* find(std::span<const Estimate> estimates, std::string_view name) {
  const auto found = std::ranges::find(estimates, name, &Estimate::name);
  return found == estimates.end() ? nullptr : &*found;
}

bool known(const Estimate* estimate) {
  return estimate != nullptr && (estimate->identifiable || estimate->fixed);
}

std::string quantity(double value, std::string_view unit) {
  return unit.empty() ? toml_number(value) : fmt::format("\"{} {}\"", value, unit);
}

}  // namespace

// {} of fmt writes the shortest text that reads back as the same number.
std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::span<const TissueKey> tissue_keys() { return kKeys; }

std::vector<ScenarioWord> scenario_words(const TissueBody& body,
                                         std::span<const Estimate> estimates) {
  std::vector<ScenarioWord> words;
  for (const TissueKey& key : kKeys) {
    const Estimate* estimate = find(estimates, key.parameter);
    if (!known(estimate)) continue;
    words.push_back({std::string(key.key), quantity(estimate->value, estimate->unit)});
  }
  words.push_back({"object.material.density", quantity(body.density_kg_m3, "kg/m3")});
  if (!body.dynamics) return words;
  words.push_back({"dynamics.newmark_beta", toml_number(body.dynamics->newmark_beta)});
  words.push_back({"dynamics.newmark_gamma", toml_number(body.dynamics->newmark_gamma)});
  const auto& kinds = fem::mass_kind_names();
  const auto kind = std::ranges::find(kinds, body.dynamics->mass,
                                      &std::pair<std::string_view, fem::MassKind>::second);
  words.push_back({"dynamics.mass", fmt::format("\"{}\"", kind->first)});
  return words;
}

std::optional<std::string> locking_warning(const TissueBody& body,
                                           std::span<const Estimate> estimates) {
  const Estimate* ratio = find(estimates, "poisson_ratio");
  if (!known(ratio)) return std::nullopt;
  const std::optional<fem::Locking> locking =
      fem::measure_locking(body.mesh, fem::Material{.young_modulus_pa = 1,
                                                    .poisson_ratio = ratio->value,
                                                    .density_kg_m3 = body.density_kg_m3});
  if (!locking) return std::nullopt;
  return locking->sentence + ": E and ν hold for this mesh";
}

}  // namespace hvp::fit
