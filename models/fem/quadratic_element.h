#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fem/assembly.h"
#include "models/fem/materials.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// The elements of the body. `quadratic`: ten-node tetrahedra (Zienkiewicz, Taylor and Zhu, The
// Finite Element Method, 7th ed., §6.3), integrated exactly. `mean_dilatation`: the same, in which
// λ acts on the mean of the dilatation over the element alone (Nagtegaal, Parks and Rice, Comput.
// Methods Appl. Mech. Eng. 4, 1974), so that they do not lock near ν = ½. The shear term 2με keeps
// the strain of each point: were the deviator's dilatation replaced too, one element would have
// three modes without energy more than rigid motion, the quadratic conformal fields.
enum class Elements { linear, quadratic, mean_dilatation };
const std::vector<std::pair<std::string_view, Elements>>& elements_names();

// The ten-node tetrahedron with straight sides. Nodes 0 to 3 are the corners, with N_a = L_a(2L_a −
// 1); node 4 + k is in the middle of edge k of mesh::kTetEdges, with N_ab = 4·L_a·L_b. L are the
// barycentric coordinates, whose gradients ElementGeometry has.
inline constexpr std::size_t kTenNodes = 10;
using Barycentric = std::array<double, 4>;
using TenNodeMatrix = Eigen::Matrix<double, 30, 30>;

std::array<double, kTenNodes> quadratic_shape(const Barycentric& l);
// ∇N at a point, 1/m.
std::array<Eigen::Vector3d, kTenNodes> quadratic_gradients(const ElementGeometry& geometry,
                                                           const Barycentric& l);
// The mean of ∇N over the element, 1/m: ∇N at the centroid.
std::array<Eigen::Vector3d, kTenNodes> mean_gradients(const ElementGeometry& geometry);

// The four points, each of weight ¼, that integrate polynomials of degree two exactly over a
// tetrahedron (Hammer and Stroud, 1956): barycentric coordinate `kFar` thrice and `kNear` once.
inline constexpr double kNear = 0.58541019662496845446;  // (5 + 3√5)/20
inline constexpr double kFar = 0.13819660112501051518;   // (5 − √5)/20
Barycentric integration_point(std::size_t point);

// Kᵉ in N/m, symmetric to the last bit: the sum of V·(λ·g_a g_bᵀ + μ·g_b g_aᵀ + μ·(g_a·g_b)·I) over
// the four points, each a quarter, with g = ∇N; of `mean_dilatation` the λ term once with the mean
// of g.
TenNodeMatrix quadratic_stiffness(const ElementGeometry& geometry, const Material& material,
                                  Elements elements);

// The factor of the identity in the mass block of nodes a and b, as a share of the element's mass:
// ∫N_a·N_b dV/V, or lumped on the diagonal in proportion to it (Hinton, Rock and Zienkiewicz,
// Earthq. Eng. Struct. Dyn. 4, 1976), which is positive where a row's sum, −1/20 for a corner, is
// not: 1/36 a corner and 4/27 a mid-edge node.
double quadratic_mass_share(MassKind kind, std::size_t a, std::size_t b);

// ∫N_a dV/V: the share of a body force, −1/20 for a corner and 1/5 for a mid-edge node.
double quadratic_volume_share(std::size_t a);

// ∫N dA over one of the four triangles of a face, over the area of that triangle. The face's nodes
// are its corners a, b, c and the middles of ab, bc and ca; the triangles have the order of
// mesh::TetMesh::boundary. All four together: zero for a corner, a third of the face for a middle.
std::array<double, 6> quadratic_face_shares(std::size_t triangle);
// The nodes of the face to which a boundary triangle of a quadratic mesh belongs, in that order.
std::array<int, 6> quadratic_face(const mesh::TetMesh& mesh, int triangle);

// As stiffness_pattern(), assemble_stiffness() and assemble_mass(), of a quadratic mesh.
sparse::BlockMatrix quadratic_pattern(const mesh::TetMesh& mesh);
sparse::BlockMatrix assemble_quadratic_stiffness(const mesh::TetMesh& mesh,
                                                 const Materials& materials, Elements elements);
sparse::BlockMatrix assemble_quadratic_mass(const mesh::TetMesh& mesh, const Materials& materials,
                                            MassKind kind);

// ∇u at the four corners of element `e` from the displacements of all mesh nodes: entry (i, j) is
// ∂u_i/∂x_j. It varies linearly in between. `g` are the gradients of the barycentric coordinates.
std::array<Eigen::Matrix3d, 4> corner_gradients(const std::array<int, 10>& nodes,
                                                const std::array<Eigen::Vector3d, 4>& g,
                                                std::span<const double> u_full);

}  // namespace hvp::fem
