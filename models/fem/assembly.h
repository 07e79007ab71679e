#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fem/materials.h"
#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The four-node tetrahedron with linear interpolation (thesis §3.4, §3.5). Its twelve unknowns
// are numbered node by node: u₀ v₀ w₀ u₁ … w₃.
using ElementMatrix = Eigen::Matrix<double, 12, 12>;
using StrainDisplacementMatrix = Eigen::Matrix<double, 6, 12>;

// The kind of mass matrix: a quarter of the element's mass at each node, on the diagonal, or by the
// interpolation functions, thesis (3.21).
enum class MassKind { lumped, consistent };
const std::vector<std::pair<std::string_view, MassKind>>& mass_kind_names();

struct ElementGeometry {
  double det_jacobian = 0;                  // m³, six times the volume
  std::array<Eigen::Vector3d, 4> gradient;  // 1/m, ∇Λ of the four interpolation functions

  double volume() const { return det_jacobian / 6; }
};

// Throws InputError naming the element if it is inverted, or so flat that rounding decides the sign
// of det J: det J ≤ 1e-12 times the cube of its longest edge.
ElementGeometry element_geometry(const mesh::TetMesh& mesh, int element);

// B of ε = B·û, thesis (3.13), in the strain order of material.h.
StrainDisplacementMatrix strain_displacement(const ElementGeometry& geometry);

// The 3 × 3 block of Kᵉ = ∫ BᵀDB dV that couples nodes a and b, row by row. (The thesis prints L
// for D in (3.15) and (3.17).) Written out for an isotropic D it is
//   V·(λ·g_a g_bᵀ + μ·g_b g_aᵀ + μ·(g_a·g_b)·I),
// which is symmetric to the last bit: block (b, a) has the same products in the same order.
// λ and μ in Pa.
std::array<double, 9> stiffness_block(const ElementGeometry& geometry, double lambda, double mu,
                                      int a, int b);

ElementMatrix element_stiffness(const ElementGeometry& geometry, const Material& material);

// The factor of the identity in the mass block of nodes a and b: ρV/20·(1 + δ_ab) for the
// consistent mass, ρV/4·δ_ab for the lumped one.
double mass_factor(const ElementGeometry& geometry, const Material& material, MassKind kind, int a,
                   int b);

ElementMatrix element_mass(const ElementGeometry& geometry, const Material& material,
                           MassKind kind);

// Assembly, thesis (3.19): element blocks are added up node pair by node pair, in the order of the
// elements. Time and memory grow linearly with the mesh. Each function throws InputError naming an
// element that is inverted or degenerate, or a node without elements.

// K over all nodes of the mesh with zeros for entries: one block for each pair of nodes that share
// an element.
sparse::BlockMatrix stiffness_pattern(const mesh::TetMesh& mesh);

// K in N/m over all nodes, without supports, so that it has six rigid-body modes. Symmetric to the
// last bit.
sparse::BlockMatrix assemble_stiffness(const mesh::TetMesh& mesh, const Materials& materials);

// M in kg over all nodes: the lumped one has diagonal blocks only, the consistent one K's pattern.
sparse::BlockMatrix assemble_mass(const mesh::TetMesh& mesh, const Materials& materials,
                                  MassKind kind);

}  // namespace hvp::fem
