#pragma once

#include <span>

#include "models/sparse/block_matrix.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/potential_body.h"

namespace hvp::tissue {

// The longest substep of central differences (central_differences.h): below 2/ω for the largest
// angular frequency ω of M⁻¹K, M lumped. Mass damping does not change it. Where K is the tangent of
// a deformed body, it is the present limit, and holds for as long as the tangent does.

// The largest angular frequency lies between these, rad/s.
struct FrequencyBounds {
  double at_least = 0;
  double at_most = 0;

  double stable_step_s() const { return 2 / at_most; }  // not above the exact one
};

// The exact one, to about ten digits. The lower bound is Rayleigh's quotient, found by Lanczos'
// iteration with full reorthogonalisation (Golub, Van Loan: Matrix computations, 2013, §10.1). The
// upper one is proved by a factorisation: σM − K is positive definite, which is to say that no
// eigenvalue reaches σ (Sylvester). K may be indefinite; a negative eigenvalue is an instability of
// the body itself, which no substep cures. `mass` has one entry for each block row, kg. Throws
// InputError for an entry that is not finite or if no eigenvalue is above zero.
FrequencyBounds largest_frequency(const sparse::BlockMatrix& k, std::span<const double> mass);
// Of a body with the displacements `u` over active nodes, m, in which the nodes that the body
// holds and those in `contact` (active ones, ascending) do not move. Throws InputError if the
// tangent is not defined there.
FrequencyBounds largest_frequency(const PotentialBody& body, std::span<const double> u,
                                  std::span<const int> contact = {});

// The shortest step 2/ω of a single free element with a quarter of its mass at each node, s, which
// is never above the exact one: an assembled eigenvalue is a mean of elements' (Irons, Treharne
// 1971). Of linear elements; throws std::invalid_argument of others. `u` is over all mesh nodes.
// Throws InputError if the law is not defined there.
double element_step(const ElasticBody& body, std::span<const double> u);
// The same at rest without an eigenvalue, from ω² ≤ 4(λ + 2μ)/ρ·Σ|∇Λ_a|².
double closed_form_step(const mesh::TetMesh& mesh, const fem::Materials& materials);

// The limit if a damping force β·K·v is computed with the velocity of the substep before, as an
// explicit scheme has to: 2/ω·(√(1 + ξ²) − ξ), ξ = βω/2. β in s.
double lagged_damping_step(double largest_frequency_rad_s, double rayleigh_stiffness_s);

}  // namespace hvp::tissue
