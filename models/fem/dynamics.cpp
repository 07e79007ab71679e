#include "models/fem/dynamics.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fem {
namespace {

// Unconditionally stable from 1/2 on; what damps high frequencies best is 3/2 (rho_infinity is 0).
constexpr config::Range kNewmark{0, 10, true};
// A body whose motion dies within a microsecond, and one that creeps for a quarter of an hour.
constexpr config::Range kRayleighMass = config::between(0, 1e6);
constexpr config::Range kRayleighStiffness = config::between(0, 1e3);

}  // namespace

void Dynamics::declare(config::Visitor& v) {
  v.quantity(
      "newmark_beta", newmark_beta, config::Dimension::dimensionless, kNewmark,
      {.help = "Newmark's β in Zienkiewicz's convention: twice the β of most textbooks; "
               "stable for β ≥ γ ≥ 1/2",
       .source = "thesis (3.24); average acceleration, which keeps energy and is of order 2"});
  v.quantity("newmark_gamma", newmark_gamma, config::Dimension::dimensionless, kNewmark,
             {.help = "Newmark's γ; above 1/2 high frequencies decay and the order falls to 1",
              .source = "thesis (3.24); average acceleration"});
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
  if (!std::isfinite(rayleigh_mass) || !(rayleigh_mass >= 0)) {
    throw InputError("rayleigh_mass",
                     fmt::format("Rayleigh's α is {} 1/s; expected 0 or more", rayleigh_mass));
  }
  if (!std::isfinite(rayleigh_stiffness) || !(rayleigh_stiffness >= 0)) {
    throw InputError("rayleigh_stiffness",
                     fmt::format("Rayleigh's β is {} s; expected 0 or more", rayleigh_stiffness));
  }
}

bool Dynamics::meets_sufficient_condition() const {
  return newmark_gamma >= 0.5 &&
         newmark_beta >= 0.5 * (0.5 + newmark_gamma) * (0.5 + newmark_gamma);
}

double Dynamics::critical_frequency() const {
  if (newmark_gamma < 0.5) return 0;
  if (newmark_beta >= newmark_gamma) return config::kInfinity;
  return std::sqrt(2 / (newmark_gamma - newmark_beta));
}

double Dynamics::rho_infinity() const {
  // λ² − 2·A₁·λ + A₂ of the undamped amplification matrix (Hughes 1987, §9.1) as ω·Δt → ∞, with
  // Hughes' β = newmark_beta/2.
  const double a1 = 1 - (newmark_gamma + 0.5) / newmark_beta;
  const double a2 = 1 - 2 * (newmark_gamma - 0.5) / newmark_beta;
  const double discriminant = a1 * a1 - a2;
  // At equality in (3.29) the roots meet: their rounding must not split them.
  if (discriminant <= 1e-14) return std::sqrt(std::max(0.0, a2));
  const double root = std::sqrt(discriminant);
  return std::max(std::abs(a1 + root), std::abs(a1 - root));
}

}  // namespace hvp::fem
