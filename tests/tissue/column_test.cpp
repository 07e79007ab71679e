#include "models/tissue/column.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::column_test {
namespace {

constexpr double kArea = 1e-4;     // m²
constexpr double kHeight = 0.013;  // m

// E·A/h of 10 kPa.
TEST(Column, OfALinearLawIsASpring) {
  for (const LawKind kind : {LawKind::linear, LawKind::corotational}) {
    const Column column(Law(kind, reference_material()), kArea, kHeight);
    for (const double depth : {1e-6, 1e-3, 5e-3}) {
      const double expected = 1e4 * kArea / kHeight * depth;
      EXPECT_NEAR(*column.force(depth), expected, 1e-12 * expected + 1e-14);
    }
  }
}

// Where the volume cannot change, the side is λ^(−½) and P = μ·(λ − λ⁻²)·e^(b·(λ² + 2/λ − 3)). κ
// has to be far above the stiffened shear modulus for that, so that b is no larger.
TEST(Column, IncompressibleIsAsInClosedForm) {
  const fem::Material material{.young_modulus_pa = 1e4, .poisson_ratio = 0.4999};
  for (const double b : {0.0, 1.0, 3.0}) {
    const Column column(Law(LawKind::fung, material, {.exponent = b}), kArea, kHeight);
    for (const double stretch : {0.95, 0.8, 0.65}) {
      const double expected = kArea * material.lame_mu() * (1 / (stretch * stretch) - stretch) *
                              std::exp(b * (stretch * stretch + 2 / stretch - 3));
      EXPECT_NEAR(*column.force((1 - stretch) * kHeight), expected, 5e-3 * expected)
          << b << " " << stretch;
    }
  }
}

// The plate's work is what is stored, V·ψ: for each law, at the side stretch that costs least.
TEST(Column, WorkIsTheEnergyStored) {
  constexpr double kDepth = 0.3 * kHeight;
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    const Column column(law, kArea, kHeight);
    constexpr int kPieces = 200;  // Simpson's rule
    double work = 0;
    for (int i = 0; i <= kPieces; ++i) {
      const double weight = i == 0 || i == kPieces ? 1 : (i % 2 == 1 ? 4 : 2);
      work += weight * *column.force(kDepth * i / kPieces);
    }
    work *= kDepth / kPieces / 3;
    double least = HUGE_VAL;
    for (double side = 1; side < 1.3; side += 1e-4) {
      least = std::min(least, *law.energy(Eigen::Vector3d(0.7, side, side).asDiagonal()));
    }
    EXPECT_NEAR(work, kArea * kHeight * least, 1e-5 * work) << static_cast<int>(kind);
  }
}

TEST(Column, OffItsPlateAndWithoutHeight) {
  const Column column(Law(LawKind::fung, reference_material(), {.exponent = 100}), kArea, kHeight);
  EXPECT_EQ(column.force(0), 0);
  EXPECT_EQ(column.force(-1e-3), 0);
  EXPECT_FALSE(column.force(kHeight).has_value());
  EXPECT_FALSE(column.force(std::nan("")).has_value());
  // The exponent is beyond its limit.
  EXPECT_FALSE(column.force(0.9 * kHeight).has_value());
  EXPECT_FALSE(forces_over_time(column, PronySeries({}, 1), std::array{0.0, 0.012}).has_value());
}

// What has been there for ever holds g∞ of its force; the rest of a step is there at first.
TEST(Column, Relaxes) {
  constexpr std::array<PronyTerm, 1> kTerms = {{{.share = 0.6, .time_s = 0.5}}};
  const Column column(Law(LawKind::fung, reference_material()), kArea, kHeight);
  std::vector<double> depth(3000, 2e-3);
  depth.front() = 1e-3;
  const std::vector<double> force =
      forces_over_time(column, PronySeries(kTerms, 1e-3), depth).value();
  const double before = *column.force(1e-3);
  const double after = *column.force(2e-3);
  EXPECT_NEAR(force.front(), 0.4 * before, 1e-12);
  EXPECT_NEAR(force[1], 0.4 * before + (after - before), 2e-3 * after);
  EXPECT_NEAR(force[501], 0.4 * after + 0.6 * std::exp(-1.0) * (after - before), 2e-3 * after);
  EXPECT_NEAR(force.back(), 0.4 * after, 2e-3 * after);
}

TEST(Column, RefusesWhatIsNoColumn) {
  const Law law(LawKind::fung, reference_material());
  EXPECT_THROW(Column(law, 0, 1), InputError);
  EXPECT_THROW(Column(law, 1, -1), InputError);
  EXPECT_THROW(Column(law, HUGE_VAL, 1), InputError);
}

}  // namespace
}  // namespace hvp::tissue::column_test
