#pragma once

#include <Eigen/Core>

#include "models/config/declaration.h"

namespace hvp::fem {

// The order of strain and stress everywhere in this room is the thesis' vector order (§3.1):
//   xx yy zz xy xz yz
// with engineering shear strains, γ_xy = ∂u/∂y + ∂v/∂x. (L's shear rows stand in the order
// yz xz xy there; B below follows the vectors.)
using StrainVector = Eigen::Matrix<double, 6, 1>;
using StressVector = Eigen::Matrix<double, 6, 1>;
using StressStrainMatrix = Eigen::Matrix<double, 6, 6>;

// A homogeneous, isotropic, linear elastic solid: the scenario's table [object.material]. A body
// of several has fem::Materials.
struct Material {
  double young_modulus_pa = 10e3;
  double poisson_ratio = 0.45;
  double density_kg_m3 = 1000;

  void declare(config::Visitor& v);
  // The same of a region that has what the body has where nothing is stated.
  void declare_of_region(config::Visitor& v);
  // Throws InputError naming the parameter that is not finite or out of range.
  void check() const;

  // Lamé's constants (Pa), thesis below (3.4).
  double lame_lambda() const;
  double lame_mu() const;

  // D of σ = D·ε (Pa), thesis (3.4).
  StressStrainMatrix stress_strain() const;
};

}  // namespace hvp::fem
