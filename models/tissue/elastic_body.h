#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/element_loop.h"
#include "models/tissue/law.h"
#include "models/tissue/operations.h"
#include "models/tissue/potential_body.h"

namespace hvp::tissue {

// What rounding alone makes of a component of the elements' forces at rest, N: a few roundings of a
// stress of λ on an element's face, as the stiffest entry of K times the longest edge.
double rounding_of_forces(const fem::Body& body);

// A body of hyperelastic materials, all of one kind of law: the energy of its displacements, their
// internal forces and their stiffness. It knows neither time nor loads nor who solves.
//
// The body's elements are linear, quadratic or of mean dilatation (fem::Body::elements()); the
// loops over them are in element_loop.h.
class ElasticBody final : public PotentialBody {
 public:
  // Keeps a reference to the body. Throws InputError for a material or a parameter out of range or
  // an element that is inverted at rest.
  ElasticBody(const fem::Body& body, LawKind kind, const Parameters& parameters = {});

  const fem::Body& body() const override { return body_; }
  LawKind kind() const { return laws_.front().kind(); }
  // As Law::needs_positive_determinant().
  bool needs_positive_determinant() const { return laws_.front().needs_positive_determinant(); }
  // Of an element, with its material's constants.
  const Law& law(std::size_t element) const { return laws_[body_.materials().index_of(element)]; }

  [[nodiscard]] Deformation internal_forces(std::span<const double> u,
                                            std::span<double> f) const override;
  // The points of integration of all elements, one element's after the other's.
  std::size_t points() const;
  // The same with the forces of damping. `frames` gets the frame in which each point is damped.
  [[nodiscard]] Deformation forces(const Motion& motion, std::span<double> f,
                                   std::span<Tensor<double>> frames) const;
  // Adds `times` the forces of some elements.
  [[nodiscard]] Deformation add_forces(std::span<const int> elements, const Motion& motion,
                                       double times, std::span<double> f) const;
  // Adds the forces of damping alone, in those frames; they are linear in the velocities. Gives its
  // operations.
  Operations add_damping(std::span<const Tensor<double>> frames, const Motion& motion,
                         std::span<double> f) const;
  // The elements at a mesh node, ascending.
  std::span<const int> elements_at(int node) const;

  // Ψ = Σ V·ψ.
  [[nodiscard]] Deformation energy(std::span<const double> u, double& energy_j) const override;
  // For the linear law the values of fem::Body::stiffness(), to rounding where elements are not
  // linear.
  [[nodiscard]] Deformation tangent(std::span<const double> u, Linearisation linearisation,
                                    sparse::BlockMatrix& k) const override;
  // The same with Linearisation::semidefinite, where inertia stands on the diagonal too: `support`
  // is that of an element's point at each of its four corners over the point's mass, N/(m·kg)
  // (least_inertia_share()). Elements that it makes definite keep their exact tangent.
  [[nodiscard]] Deformation supported_tangent(std::span<const double> u, double support,
                                              sparse::BlockMatrix& k) const;
  // Adds the derivative of the damping forces by the velocities, times `weight`, without that of
  // the frames. Gives its operations.
  Operations add_damping_tangent(std::span<const Tensor<double>> frames, double damping_s,
                                 double weight, sparse::BlockMatrix& k) const;

 private:
  using Loop = std::variant<ElementLoop<FourNodes>, ElementLoop<TenNodes>,
                            ElementLoop<TenNodesOfMeanDilatation>>;

  Deformation assemble(std::span<const double> u, Linearisation linearisation, double support,
                       sparse::BlockMatrix& k) const;
  static Loop loop_of(const fem::Body& body, LawKind kind, const Parameters& parameters);

  const fem::Body& body_;
  std::vector<Law> laws_;  // of each material
  Loop loop_;
};

}  // namespace hvp::tissue
