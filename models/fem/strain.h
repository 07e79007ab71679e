#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "models/fem/materials.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// Strain and stress of one element, in the order of material.h: constant over a linear one, the
// mean over a quadratic one.
struct ElementStress {
  StrainVector strain = StrainVector::Zero();
  StressVector stress = StressVector::Zero();  // Pa
  double von_mises_pa = 0;
};

// ε = B·û and σ = D·ε (thesis (3.13), (3.3)) of every tetrahedron from the displacements of all
// mesh nodes (m).
std::vector<ElementStress> element_stress(const mesh::TetMesh& mesh, const Materials& materials,
                                          std::span<const double> u_full);

// Von Mises' equivalent stress √(½·((σxx − σyy)² + (σyy − σzz)² + (σzz − σxx)²) + 3·(σxy² + σxz² +
// σyz²)), Pa.
double von_mises(const StressVector& stress);

// Green's strain is ε and a quadratic term that linear elasticity drops, ½·∇uᵀ∇u: at a principal
// strain of a tenth it is a twentieth of ε.
inline constexpr double kLinearStrain = 0.1;
// The share of the volume that may be strained further: beneath a single pressed node the strain of
// linear elasticity grows without bound as the mesh gets finer. Chosen.
inline constexpr double kLinearShare = 0.25;  // share of the volume
// At a principal strain of −1 an element has no thickness left.
inline constexpr double kCollapse = 1.0;

// A body's distance from the range of linear elasticity.
struct Strains {
  double largest = 0;       // principal strain of ε = ½(∇u + ∇uᵀ), magnitude
  int element = -1;         // the element with this strain
  int inverted = 0;         // elements turned inside out, det(I + ∇u) <= 0
  double beyond_share = 0;  // share of the volume with a principal strain beyond the limit
  // The part of that share that is stretched beyond the limit, |σ − 1| of a singular value of
  // I + ∇u: what is left where rotations, which ε takes for strain, are taken out.
  double stretched_share = 0;
  double largest_stretch = 0;  // the largest |σ − 1| where the strain is beyond the limit
};

// True if an element is turned inside out or has collapsed, or if more than kLinearShare of the
// volume is strained by more than kLinearStrain.
bool beyond_linearity(const Strains& strains);
// The same of a law that is linear in strain and turns with the body (corotational, St Venant and
// Kirchhoff's): an element is turned inside out, or stretched by kCollapse, or more than
// kLinearShare of the volume is stretched by more than kLinearStrain.
bool beyond_linear_stretch(const Strains& strains);
// The simplest material law, as object.model.kind names it, that is not beyond its assumptions:
// linear within beyond_linearity(), corotational within beyond_linear_stretch(), neo-Hookean
// elsewhere. Up to kLinearShare of the volume may be beyond, so that the force at a pressed node
// may still be off by more than the small strains elsewhere suggest.
std::string_view suitable_model(const Strains& strains);

// Measures strains against the assumptions of linear elasticity (thesis §3.2), which takes ∇u for
// small: strain without its quadratic terms, and equilibrium in the place of the body at rest. An
// element whose corner has passed through its opposite face is not a body any more.
class StrainMeter {
 public:
  // `limit` is the principal strain of Strains::beyond_share. Throws InputError for an element that
  // is inverted at rest.
  StrainMeter(const mesh::TetMesh& mesh, double limit);

  // `u_full` has the displacements of all mesh nodes, m. Does not allocate; takes about 120
  // operations an element.
  Strains measure(std::span<const double> u_full) const;

 private:
  Strains measure_quadratic(std::span<const double> u_full) const;

  struct Element {
    std::array<int, 4> node{};
    std::array<Eigen::Vector3d, 4> gradient;  // 1/m
    double volume = 0;                        // m³
  };

  double limit_;
  double volume_ = 0;
  std::vector<Element> elements_;
  std::vector<std::array<int, 10>> ten_nodes_;  // of quadratic elements
};

}  // namespace hvp::fem
