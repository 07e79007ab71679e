#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/newmark.h"

namespace hvp::fem {

namespace {

// Unconditionally stable from 1/2 on; what damps high frequencies best is 3/2 (the spectral
// radius of a step is 0 at the highest).
constexpr config::Range kNewmark{0, 10, true};
// A body whose motion dies within a microsecond, and one that creeps for a quarter of an hour.
constexpr config::Range kRayleighMass = config::between(0, 1e6);
constexpr config::Range kRayleighStiffness = config::between(0, 1e3);

}  // namespace

const std::vector<std::pair<std::string_view, Scheme>>& scheme_names() {
  static const std::vector<std::pair<std::string_view, Scheme>> names = {
      {"newmark", Scheme::newmark}, {"generalised-alpha", Scheme::generalised_alpha}};
  return names;
}

void Dynamics::declare(config::Visitor& v) {
  const auto of_scheme = v.variant(
      "scheme", scheme, scheme_names(),
      {.help = "the rule of the time integration: newmark; or generalised-alpha, of order 2, which "
               "damps the frequencies that the time step does not resolve and hardly others",
       .source = "thesis (3.24)"});
  of_scheme.only({Scheme::newmark}, [&] {
    v.quantity(
        "newmark_beta", newmark_beta, config::Dimension::dimensionless, kNewmark,
        {.help = "Newmark's β in Zienkiewicz's convention: twice the β of most textbooks; "
                 "stable for β ≥ γ ≥ 1/2",
         .source = "thesis (3.24); average acceleration, which keeps energy and is of order 2"});
    v.quantity("newmark_gamma", newmark_gamma, config::Dimension::dimensionless, kNewmark,
               {.help = "Newmark's γ; above 1/2 high frequencies decay and the order falls to 1",
                .source = "thesis (3.24); average acceleration"});
  });
  of_scheme.only({Scheme::generalised_alpha}, [&] {
    v.quantity("spectral_radius", spectral_radius, config::Dimension::dimensionless,
               config::between(0, 1),
               {.help = "ρ∞: what a time step leaves of the highest frequencies, all (1) to "
                        "nothing (0)",
                .source = "Chung, Hulbert 1993, for any from 0 to 1; about the 0.82 that Newmark's "
                          "rule has with the γ = 0.6 and β = 0.605 of scenarios/thesis.toml"});
  });
  v.choice("mass", mass, mass_kind_names(),
           {.help = "mass at the nodes (lumped) or by the interpolation functions (consistent)",
            .source = "thesis §3.6: lumping is the usual simplification"});
  v.quantity(
      "rayleigh_mass", rayleigh_mass, config::Dimension::rate, kRayleighMass,
      {.help = "α of Rayleigh's damping C = α·M + β·K: damps slow motion",
       .source =
           "thesis (3.22) gives no value; light damping of soft tissue, docs/finite-elements.md"});
  v.quantity("rayleigh_stiffness", rayleigh_stiffness, config::Dimension::time, kRayleighStiffness,
             {.help = "β of Rayleigh's damping C = α·M + β·K: damps fast vibration",
              .source = "thesis (3.22) gives no value; 3 % of critical at 9 Hz, "
                        "docs/finite-elements.md"});
}

void Dynamics::check() const {
  if (scheme == Scheme::generalised_alpha) {
    if (!(spectral_radius >= 0 && spectral_radius <= 1)) {
      throw InputError("spectral_radius",
                       fmt::format("ρ∞ is {}; expected 0 to 1", spectral_radius));
    }
  } else {
    check_newmark();
  }
  if (!std::isfinite(rayleigh_mass) || !(rayleigh_mass >= 0)) {
    throw InputError("rayleigh_mass",
                     fmt::format("Rayleigh's α is {} 1/s; expected 0 or more", rayleigh_mass));
  }
  if (!std::isfinite(rayleigh_stiffness) || !(rayleigh_stiffness >= 0)) {
    throw InputError("rayleigh_stiffness",
                     fmt::format("Rayleigh's β is {} s; expected 0 or more", rayleigh_stiffness));
  }
}

void Dynamics::check_newmark() const {
  if (!std::isfinite(newmark_beta) || !(newmark_beta > 0)) {
    throw InputError(
        "newmark_beta",
        fmt::format("β is {}; expected a finite value above 0: an implicit rule", newmark_beta));
  }
  if (!std::isfinite(newmark_gamma) || newmark_gamma < 0.5) {
    throw InputError("newmark_gamma",
                     fmt::format("γ is {}: below 1/2 energy grows at every time step; expected "
                                 "β ≥ γ ≥ 1/2, for example β = γ = 0.5",
                                 newmark_gamma));
  }
  if (newmark_beta < newmark_gamma) {
    throw InputError(
        "newmark_beta",
        fmt::format("β is {} and γ is {}: unstable for modes with ω·Δt above {:.4g}; expected "
                    "β ≥ γ ≥ 1/2 (Zienkiewicz's β is twice the textbooks': 1/4 there is 0.5 here)",
                    newmark_beta, newmark_gamma, critical_frequency()));
  }
}

Dynamics::Parameters Dynamics::parameters() const {
  if (scheme == Scheme::newmark) return {newmark_beta, newmark_gamma, 0, 0};
  const double rho = spectral_radius;
  const double alpha_m = (2 * rho - 1) / (rho + 1);
  const double alpha_f = rho / (rho + 1);
  const double between = 1 - alpha_m + alpha_f;
  return {between * between / 2, 0.5 - alpha_m + alpha_f, alpha_m, alpha_f};
}

double Dynamics::critical_frequency() const {
  if (scheme == Scheme::generalised_alpha) return config::kInfinity;
  if (newmark_gamma < 0.5) return 0;
  if (newmark_beta >= newmark_gamma) return config::kInfinity;
  return std::sqrt(2 / (newmark_gamma - newmark_beta));
}

}  // namespace hvp::fem
