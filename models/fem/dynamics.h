#pragma once

#include "models/config/declaration.h"
#include "models/fem/element.h"

namespace hvp::fem {

// Inertia and damping: the scenario's effect [dynamics]. Without it the body is static.
//
// β and γ are in Zienkiewicz's convention, that of thesis (3.24)–(3.29): β here is twice the β of
// Newmark's and Hughes' books. The average-acceleration rule is β = γ = ½; the textbook's β = ¼
// is only conditionally stable here.
struct Dynamics {
  double newmark_beta = 0.5;
  double newmark_gamma = 0.5;
  MassKind mass = MassKind::lumped;
  double rayleigh_mass = 0.1;        // 1/s, α of C = α·M + β·K, thesis (3.22)
  double rayleigh_stiffness = 1e-3;  // s, β of (3.22)

  void declare(config::Visitor& v);

  // Throws InputError for parameters that are not stable at every time step: the exact condition
  // without damping is β ≥ γ ≥ ½. Parameters between that and the sufficient condition (3.29)
  // are accepted: the highest modes then decay without oscillating, at two different rates.
  void check() const;

  // Thesis (3.29): β ≥ ½(½ + γ)², γ ≥ ½. Every mode keeps oscillating as it decays.
  bool meets_sufficient_condition() const;

  // The largest ω·Δt at which an undamped mode of angular frequency ω stays bounded:
  // √(2/(γ − β)) for β < γ, infinity for β ≥ γ. Zero for γ < ½, where energy grows at any step.
  double critical_frequency() const;

  // Spectral radius of one undamped step as ω·Δt → ∞: 1 keeps the highest modes, 0 removes them
  // at once. At equality in (3.29) it is |(γ − 3/2)/(γ + 1/2)|.
  double rho_infinity() const;
};

}  // namespace hvp::fem
