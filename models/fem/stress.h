#pragma once

#include <span>
#include <vector>

#include "models/fem/material.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// Strain and stress of one element, constant over it, in the order of material.h.
struct ElementStress {
  StrainVector strain = StrainVector::Zero();
  StressVector stress = StressVector::Zero();  // Pa
  double von_mises_pa = 0;
};

// ε = B·û and σ = D·ε (thesis (3.13), (3.3)) of every tetrahedron from the displacements of all
// mesh nodes (m).
std::vector<ElementStress> element_stress(const mesh::TetMesh& mesh, const Material& material,
                                          std::span<const double> u_full);

// √(½·((σxx − σyy)² + (σyy − σzz)² + (σzz − σxx)²) + 3·(σxy² + σxz² + σyz²)), Pa.
double von_mises(const StressVector& stress);

}  // namespace hvp::fem
