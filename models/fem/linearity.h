#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// Green's strain is ε and a quadratic term that linear elasticity drops, ½·∇uᵀ∇u: at a principal
// strain of a tenth it is a twentieth of ε.
inline constexpr double kLinearStrain = 0.1;
// A small part of a body may be strained further: beneath a node that is pressed alone the strain
// of linear elasticity grows without bound as the mesh gets finer. Chosen.
inline constexpr double kLinearShare = 0.25;  // of the volume
// At a principal strain of −1 an element has no thickness left.
inline constexpr double kCollapse = 1.0;

// How far a body is from where linear elasticity holds.
struct Strains {
  double largest = 0;       // principal strain of ε = ½(∇u + ∇uᵀ), magnitude
  int element = -1;         // that has it
  int inverted = 0;         // elements with det(I + ∇u) <= 0: turned inside out
  double beyond_share = 0;  // of the volume, where a principal strain exceeds the limit
};

// Whether a body is so far: an element is turned inside out or has collapsed, or more than
// kLinearShare of the volume is strained by more than kLinearStrain.
bool beyond_linearity(const Strains& strains);

// Linear elasticity (thesis §3.2) takes ∇u for small: strain without its quadratic terms, and
// equilibrium in the place where the body was at rest. An element whose corner has passed through
// its opposite face is not a body any more.
class StrainMeter {
 public:
  // `limit`: principal strain, for Strains::beyond_share. Throws InputError for an element that is
  // inverted at rest.
  StrainMeter(const mesh::TetMesh& mesh, double limit);

  // Displacements of all mesh nodes, m. Does not allocate. About 120 operations an element.
  Strains measure(std::span<const double> u_full) const;

 private:
  struct Element {
    std::array<int, 4> node{};
    std::array<Eigen::Vector3d, 4> gradient;  // 1/m
    double volume = 0;                        // m³
  };

  double limit_;
  double volume_ = 0;
  std::vector<Element> elements_;
};

}  // namespace hvp::fem
