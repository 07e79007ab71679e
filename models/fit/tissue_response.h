#pragma once

#include <optional>
#include <span>
#include <vector>

#include "models/fem/newmark.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// The motion of the contact along its direction at each sample. It is the same for all parameters.
struct ContactMotion {
  std::vector<double> displacement;  // m
  std::vector<double> velocity;      // m/s; this and the next are empty for a static body
  std::vector<double> acceleration;  // m/s²
};

// The motion that Newmark's rule and fem::Newmark::hold give for a displacement that begins at zero
// with the body at rest. For a static body it is the displacement only.
ContactMotion contact_motion(const TissueBody& body, std::span<const double> displacement);

// The force on the body at the contact along its direction, N, at each sample, and its derivatives
// by the parameters.
struct TissueForce {
  std::vector<double> force;
  std::vector<double> by_young_modulus;      // N/Pa; this and the next are empty unless asked for
  std::vector<double> by_poisson_ratio;      // N
  std::vector<double> by_mass_damping;       // N s; empty for a static body
  std::vector<double> by_stiffness_damping;  // N/s; empty for a static body
};

// The force of a static body: F = k·x with k = k_c − k_fᵀ·K_ff⁻¹·k_f. With w = (−K_ff⁻¹·k_f, 1),
// the body's shape under a unit displacement, ∂k/∂θ = wᵀ·∂K/∂θ·w. It takes one factorisation and
// one solve. Empty where K is not positive definite to double precision.
std::optional<TissueForce> static_force(const TissueSystem& system, const TissueValues& values,
                                        const ContactMotion& motion, bool derivatives);

// The force of a body with inertia: M·ü + C·u̇ + K·u = 0 at the free nodes (thesis (3.20)), C = α·M
// + β·K, integrated from rest by fem::Newmark's rule, and the reaction at the contact (thesis
// §3.7). The derivative s = ∂u/∂θ is integrated by the same rule with the same factors of Â,
//   M·s̈ + C·ṡ + K·s = −(∂C/∂θ·u̇ + ∂K/∂θ·u),
// over all nodes, with s = 0 at the contact: it is the derivative of the discrete solution and not
// an approximation. All five systems are solved in one pass over the factors. Empty where Â is not
// positive definite to double precision.
std::optional<TissueForce> dynamic_force(const TissueSystem& system, const TissueBody& body,
                                         const TissueValues& values, const ContactMotion& motion,
                                         bool derivatives);

// The lowest natural angular frequency of the undamped body with its contact fixed, rad/s, by
// inverse iteration to 1 %. Zero for a static body.
double lowest_frequency(const TissueSystem& system, double young_modulus, double poisson_ratio);

}  // namespace hvp::fit
