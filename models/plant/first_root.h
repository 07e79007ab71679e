#pragma once

#include <optional>
#include <span>

namespace hvp::plant {

// The first s in (0, 1] at which the polynomial with these coefficients of s⁰, s¹ … (at most 36)
// has left the sign that it has just after 0, to the last bit; none where it keeps it, or is zero
// everywhere. Roots are isolated by the polynomial's Bernstein coefficients, so that none is missed
// because the next one follows closely. A root that it touches without leaving may be found or not.
std::optional<double> first_root(std::span<const double> coefficients);

}  // namespace hvp::plant
