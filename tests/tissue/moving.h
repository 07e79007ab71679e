#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "models/fem/newmark.h"

// What tests of bodies in the servo loop share.
namespace hvp::tissue::moving {

// The thesis' Newmark constants, with both of Rayleigh's dampings.
inline fem::Dynamics damped() {
  return {.newmark_beta = 0.605,
          .newmark_gamma = 0.6,
          .mass = fem::MassKind::lumped,
          .rayleigh_mass = 0.1,
          .rayleigh_stiffness = 1e-3};
}

inline double largest(std::span<const double> v) {
  double most = 0;
  for (const double x : v) most = std::max(most, std::abs(x));
  return most;
}

inline double largest_difference(std::span<const double> a, std::span<const double> b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace hvp::tissue::moving
