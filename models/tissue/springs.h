#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "models/tissue/potential_body.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// What a linear spring does with d, the vector between its ends, of length l: the force (k −
// k·l₀/l)·d on its second end, and the opposite on its first.
template <class T>
struct SpringForce {
  Vector<T> force{};  // N, ∂Ψ/∂u of the second end
  T length{};         // m
  bool defined = true;
};
template <class T>
SpringForce<T> spring_force(const Vector<T>& d, const T& stiffness, const T& pull_at_rest) {
  using std::sqrt;
  const T length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  // Between ends in one place it has no direction.
  if (!(length > T(0))) return {.length = length, .defined = false};
  const T factor = stiffness - pull_at_rest / length;
  return {.force = {factor * d[0], factor * d[1], factor * d[2]}, .length = length};
}
inline constexpr Operations kSpringForce = {.add_multiply = 9, .divisions = 1, .functions = 1};

// An edge of the mesh, and what the tetrahedra that have it add up to.
struct Edge {
  std::array<int, 2> node{};  // ascending
  double modulus_volume = 0;  // Σ E·V, N·m
};
// All edges, ascending.
std::vector<Edge> edges_of(const mesh::TetMesh& mesh, const fem::Materials& materials);

// A mass-spring body: a linear spring along each edge of the mesh, of stiffness
//   k = Σ E·V/l²
// over the tetrahedra round it, E·ΣV/l² in a body of one material (Van Gelder: Approximate
// simulation of elastic membranes by triangulated spring meshes, 1998, §4, for tetrahedra). Of the
// body's material it takes E alone: under an affine strain the mean over all directions is that E,
// and ν is ¼ whatever the material says, as for every network of central forces (Cauchy). The
// mesh's preferred directions remain: docs/tissue.md has how much. Springs turn with the body. They
// do not see that an element is turned inside out: a mirrored one is at rest.
//
// Of a `Deformation` it has no determinants; `undefined` counts springs whose length is zero or not
// finite, which have no direction and add nothing.
class SpringBody final : public PotentialBody {
 public:
  // Keeps a reference to the body. Throws InputError for an inverted or degenerate element.
  explicit SpringBody(const fem::Body& body);

  struct Spring {
    std::array<int, 2> node{};
    Vector<double> rest{};       // from the first to the second, m
    double length = 0;           // m, at rest
    double stiffness = 0;        // N/m
    double pull_at_rest = 0;     // stiffness times length, N
    std::array<int, 4> block{};  // of K: (0, 0), (0, 1), (1, 0), (1, 1); −1 if one is held
  };
  std::span<const Spring> springs() const { return springs_; }

  const fem::Body& body() const override { return body_; }
  [[nodiscard]] Deformation internal_forces(std::span<const double> u,
                                            std::span<double> f) const override;
  // Ψ = Σ k/2·(l − l₀)²
  [[nodiscard]] Deformation energy(std::span<const double> u, double& energy_j) const override;
  // With n = d/l each spring has ± (k·n nᵀ + k·(1 − l₀/l)·(I − n nᵀ)). The second part is negative
  // for a shortened one, which gives way to the side: that tangent may be indefinite. `warped`
  // leaves it out, and is semidefinite.
  [[nodiscard]] Deformation tangent(std::span<const double> u, Linearisation linearisation,
                                    sparse::BlockMatrix& k) const override;

 private:
  const fem::Body& body_;
  std::vector<Spring> springs_;
};

}  // namespace hvp::tissue
