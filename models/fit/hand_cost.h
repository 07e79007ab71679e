#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <ceres/cost_function.h>

namespace hvp::fit {

// The force on a hand, where it was, and, where it is known, where it meant to be; evenly sampled.
struct HandLog {
  double period = 0;             // s
  std::vector<double> force;     // N, on the hand; linear between samples
  std::vector<double> position;  // m
  std::vector<double> intended;  // m, linear between samples; empty: unknown and slow
};

// The Legendre polynomials of degree 0 to `degree` at s in [−1, 1].
std::vector<double> legendre(std::size_t degree, double s);

// Residuals (m) of the samples [first, last): where the hand was, minus where it would be with the
// mass, stiffness and damping that are the parameters, had it begun at the position and with the
// velocity, and followed the intended motion, that explain it best. The intended motion is the
// log's, or else any polynomial up to `degree`. All these are linear, so they are eliminated here
// (variable projection, Golub & Pereyra 1973), with the derivatives of that; there are no own
// unknowns. `log` must outlive it.
std::unique_ptr<ceres::CostFunction> hand_cost(const HandLog& log, std::size_t degree,
                                               std::size_t first, std::size_t last);

}  // namespace hvp::fit
