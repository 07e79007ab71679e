#pragma once

#include <array>

namespace hvp::plant {

// A quantity as a polynomial of time since some instant: coefficients of t⁰ to t⁵. A stroke of
// minimum jerk has that degree.
using Polynomial = std::array<double, 6>;

double value(const Polynomial& p, double t);
double slope(const Polynomial& p, double t);

// p about another origin of time: q(t) = p(t + seconds).
Polynomial shifted(const Polynomial& p, double seconds);

}  // namespace hvp::plant
