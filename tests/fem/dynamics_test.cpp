#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/newmark.h"
#include "tests/algebra.h"

namespace hvp::fem::dynamics_test {
namespace {

// The spectral radius of one step of (3.24) for ü = −Ω²·u with Δt = 1, built from (3.24) itself:
// the state is (u, u̇, ü), the third row closes the equation of motion.
double spectral_radius(double beta, double gamma, double omega) {
  const double w2 = omega * omega;
  Eigen::Matrix3d left;
  left << 1, 0, -beta / 2, 0, 1, -gamma, w2, 0, 1;
  Eigen::Matrix3d right;
  right << 1, 1, (1 - beta) / 2, 0, 1, 1 - gamma, 0, 0, 0;
  return test::spectral_radius(left.inverse() * right);
}

// Thesis (3.29): β ≥ ½(½ + γ)², γ ≥ ½. Every mode keeps oscillating as it decays.
bool meets_sufficient_condition(const Dynamics& dynamics) {
  const double gamma = dynamics.newmark_gamma;
  return gamma >= 0.5 && dynamics.newmark_beta >= 0.5 * (0.5 + gamma) * (0.5 + gamma);
}

TEST(Dynamics, CriticalFrequencySeparatesBoundedFromGrowing) {
  for (const auto& [beta, gamma] : {std::pair{0.25, 0.5}, {0.3, 0.6}, {0.45, 0.5}}) {
    const double critical =
        Dynamics{.newmark_beta = beta, .newmark_gamma = gamma}.critical_frequency();
    EXPECT_LT(spectral_radius(beta, gamma, 0.99 * critical), 1 + 1e-9);
    EXPECT_GT(spectral_radius(beta, gamma, 1.01 * critical), 1.001);
  }
  // Hughes 1987, §9.1: linear acceleration's neighbour β = 1/8, γ = 1/2 there.
  EXPECT_NEAR((Dynamics{.newmark_beta = 0.25, .newmark_gamma = 0.5}.critical_frequency()),
              2 * std::sqrt(2.0), 1e-15);
}

TEST(Dynamics, ExactConditionIsStableAtEveryStep) {
  for (const auto& [beta, gamma] : {std::pair{0.5, 0.5}, {0.7, 0.7}, {0.9, 0.6}, {1.0, 1.0}}) {
    const Dynamics dynamics{.newmark_beta = beta, .newmark_gamma = gamma};
    EXPECT_NO_THROW(dynamics.check());
    for (double omega = 0.01; omega < 1e4; omega *= 1.3) {
      EXPECT_LT(spectral_radius(beta, gamma, omega), 1 + 1e-9) << beta << " " << gamma;
    }
  }
}

// β = γ = 0.7 is stable although (3.29) asks for 0.72: it is accepted.
TEST(Dynamics, SufficientConditionIsNotNecessary) {
  EXPECT_FALSE(meets_sufficient_condition({.newmark_beta = 0.7, .newmark_gamma = 0.7}));
  EXPECT_TRUE(meets_sufficient_condition({.newmark_beta = 0.72, .newmark_gamma = 0.7}));
  EXPECT_TRUE(meets_sufficient_condition({}));
}

TEST(Dynamics, UnstableParametersAreRefused) {
  try {
    Dynamics{.newmark_beta = 0.25, .newmark_gamma = 0.5}.check();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "newmark_beta");
    EXPECT_NE(std::string(error.what()).find("2.828"), std::string::npos) << error.what();
  }
  try {
    Dynamics{.newmark_beta = 0.5, .newmark_gamma = 0.4}.check();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "newmark_gamma");
  }
  EXPECT_GT(spectral_radius(0.5, 0.4, 1), 1.01);
  EXPECT_THROW((Dynamics{.newmark_beta = std::nan("")}.check()), InputError);
  EXPECT_THROW((Dynamics{.rayleigh_mass = -1}.check()), InputError);
  EXPECT_THROW((Dynamics{.rayleigh_stiffness = -1}.check()), InputError);
}

// ρ∞, the spectral radius as ω·Δt → ∞: 1 keeps the highest modes, 0 removes them at once. From
// λ² − 2·A₁·λ + A₂ of the undamped amplification matrix (Hughes 1987, §9.1; his β is half of ours).
double rho_infinity(double beta, double gamma) {
  const double a1 = 1 - (gamma + 0.5) / beta;
  const double a2 = 1 - 2 * (gamma - 0.5) / beta;
  const double discriminant = a1 * a1 - a2;
  // At equality in (3.29) the roots meet: their rounding must not split them.
  if (discriminant <= 1e-14) return std::sqrt(std::max(0.0, a2));
  const double root = std::sqrt(discriminant);
  return std::max(std::abs(a1 + root), std::abs(a1 - root));
}

TEST(Dynamics, RhoInfinityIsTheLimitOfTheSpectralRadius) {
  for (const auto& [beta, gamma] :
       {std::pair{0.5, 0.5}, {0.605, 0.6}, {0.7, 0.7}, {0.9, 0.6}, {2.0, 1.5}}) {
    // A double root splits by the square root of the rounding.
    EXPECT_NEAR(rho_infinity(beta, gamma), spectral_radius(beta, gamma, 1e4), 2e-3)
        << beta << " " << gamma;
  }
  for (const double gamma : {0.5, 0.6, 0.8, 1.0, 1.5}) {
    const double beta = 0.5 * (0.5 + gamma) * (0.5 + gamma);
    EXPECT_NEAR(rho_infinity(beta, gamma), std::abs((gamma - 1.5) / (gamma + 0.5)), 1e-7);
  }
}

}  // namespace
}  // namespace hvp::fem::dynamics_test
