#include "models/fem/material.h"

#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fem {
namespace {

// λ grows beyond all bounds as ν reaches one half; at 0.4999 it is 3333 times E already.
constexpr double kLargestPoissonRatio = 0.4999;

// From the softest gels to ten times diamond (1.05 TPa), and from an aerogel (0.16 kg/m³) to four
// times osmium (22590 kg/m³): beyond, a number is a slip of the pen and its products overflow.
constexpr config::Range kYoungModulus = config::between(1, 1e13);
constexpr config::Range kDensity = config::between(0.1, 1e5);

}  // namespace

void Material::declare(config::Visitor& v) {
  v.quantity("young_modulus", young_modulus_pa, config::Dimension::pressure, kYoungModulus,
             {.help = "Young's modulus E of the solid",
              .source = "soft tissue: 2 to 20 kPa; middle of the range on a log scale, rounded"});
  v.quantity(
      "poisson_ratio", poisson_ratio, config::Dimension::dimensionless,
      config::between(0, kLargestPoissonRatio),
      {.help = "Poisson's ratio; above 0.45 linear tetrahedra lock and the run says by "
               "how much",
       .source = "soft tissue: 0.45 to 0.49; the end at which linear tetrahedra still work"});
  v.quantity("density", density_kg_m3, config::Dimension::density, kDensity,
             {.help = "mass density ρ", .source = "water; soft tissue is near 1050 kg/m³"});
}

void Material::declare_of_region(config::Visitor& v) {
  constexpr std::string_view kOfBody = "that of [object.material]";
  v.quantity("young_modulus", young_modulus_pa, config::Dimension::pressure, kYoungModulus,
             {"Young's modulus E of the region", kOfBody});
  v.quantity("poisson_ratio", poisson_ratio, config::Dimension::dimensionless,
             config::between(0, kLargestPoissonRatio), {"Poisson's ratio of the region", kOfBody});
  v.quantity("density", density_kg_m3, config::Dimension::density, kDensity,
             {"mass density ρ of the region", kOfBody});
}

void Material::check() const {
  if (!(young_modulus_pa > 0) || !std::isfinite(young_modulus_pa)) {
    throw InputError("young_modulus", fmt::format("Young's modulus is {} Pa; expected a finite "
                                                  "value above 0",
                                                  young_modulus_pa));
  }
  if (!(poisson_ratio >= 0) || !(poisson_ratio <= kLargestPoissonRatio)) {
    throw InputError("poisson_ratio", fmt::format("Poisson's ratio is {}; expected 0 to {}",
                                                  poisson_ratio, kLargestPoissonRatio));
  }
  if (!(density_kg_m3 > 0) || !std::isfinite(density_kg_m3)) {
    throw InputError("density", fmt::format("the density is {} kg/m³; expected a finite value "
                                            "above 0",
                                            density_kg_m3));
  }
}

double Material::lame_lambda() const {
  return young_modulus_pa * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

double Material::lame_mu() const { return young_modulus_pa / (2 * (1 + poisson_ratio)); }

StressStrainMatrix Material::stress_strain() const {
  const double lambda = lame_lambda();
  const double mu = lame_mu();
  StressStrainMatrix d = StressStrainMatrix::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) d(i, j) = lambda;
    d(i, i) = lambda + 2 * mu;
    d(i + 3, i + 3) = mu;
  }
  return d;
}

}  // namespace hvp::fem
