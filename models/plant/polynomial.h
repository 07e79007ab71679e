#pragma once

#include <array>
#include <optional>
#include <span>

namespace hvp::plant {

// A quantity as a polynomial of time since some instant: coefficients of t⁰ to t⁵. A stroke of
// minimum jerk has that degree.
using Polynomial = std::array<double, 6>;

double value(const Polynomial& p, double t);
double slope(const Polynomial& p, double t);

// p with another origin of time: q(t) = p(t + seconds).
Polynomial shifted(const Polynomial& p, double seconds);

// The first s in (0, 1] at which the polynomial with these coefficients of s⁰, s¹ … (at most 36) no
// longer has the sign that it has just after 0, to the last bit. Empty where it keeps that sign or
// is zero everywhere. Roots are isolated by the polynomial's Bernstein coefficients, so that none
// is missed because the next one follows closely. A root at which the sign does not change may be
// found or not.
std::optional<double> first_root(std::span<const double> coefficients);

}  // namespace hvp::plant
