#include "models/tissue/ten_nodes.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace hvp::tissue {
namespace {

using Square = Eigen::Matrix<double, 10, 10>;

// Σ_p W_pᵀ·(I − 1·1ᵀ/4)·W_p
Square corners_of_points() {
  Square sum = Square::Zero();
  for (std::size_t node = 0; node < 10; ++node) {
    OfNodes<double, 10> one{};
    one[node][0] = 1;
    const TenNodes::Displaced<double> of_one(one);
    for (std::size_t other = 0; other < 10; ++other) {
      OfNodes<double, 10> two{};
      two[other][0] = 1;
      const TenNodes::Displaced<double> of_other(two);
      for (std::size_t p = 0; p < TenNodes::kPoints; ++p) {
        const OfNodes<double, 4> w = of_one.at(p);
        const OfNodes<double, 4> v = of_other.at(p);
        double product = 0;
        double of_w = 0;
        double of_v = 0;
        for (std::size_t c = 0; c < 4; ++c) {
          product += w[c][0] * v[c][0];
          of_w += w[c][0];
          of_v += v[c][0];
        }
        sum(static_cast<int>(node), static_cast<int>(other)) += product - of_w * of_v / 4;
      }
    }
  }
  return sum;
}

}  // namespace

double least_inertia_share(fem::Elements elements, fem::MassKind kind) {
  const bool lumped = kind == fem::MassKind::lumped;
  // A fourth of a lumped mass, and the least eigenvalue of a consistent one.
  if (elements == fem::Elements::linear) return lumped ? 1.0 / 4 : 1.0 / 20;
  Square mass;  // over that of a point
  for (std::size_t a = 0; a < 10; ++a) {
    for (std::size_t b = 0; b < 10; ++b) {
      mass(static_cast<int>(a), static_cast<int>(b)) =
          TenNodes::kPoints * fem::quadratic_mass_share(kind, a, b);
    }
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Square> modes(
      corners_of_points(), mass, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
  return 1 / modes.eigenvalues()[9];
}

}  // namespace hvp::tissue
