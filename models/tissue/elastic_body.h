#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/law.h"
#include "models/tissue/operations.h"
#include "models/tissue/potential_body.h"
#include "models/tissue/viscous.h"

namespace hvp::tissue {

// Displacements, and the velocities that stiffness damping brakes.
struct Motion {
  std::span<const double> u;  // m
  std::span<const double> v;  // m/s; empty without damping
  double damping_s = 0;       // β of Rayleigh's damping, models/tissue/viscous.h
};

// A body of hyperelastic materials, all of one kind of law: the energy of its displacements, their
// internal forces and their stiffness. It knows neither time nor loads nor who solves.
//
// Elements are gone through in ascending order, so that every sum has one order.
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
  // The same with the forces of damping. `frames` gets the frame in which each element is damped.
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
  // For the linear law the values of fem::Body::stiffness().
  [[nodiscard]] Deformation tangent(std::span<const double> u, Linearisation linearisation,
                                    sparse::BlockMatrix& k) const override;
  // The same with Linearisation::semidefinite, where inertia stands on the diagonal too: `support`
  // is that of an element at each of its nodes over its mass, N/(m·kg). Elements that it makes
  // definite keep their exact tangent.
  [[nodiscard]] Deformation supported_tangent(std::span<const double> u, double support,
                                              sparse::BlockMatrix& k) const;
  // Adds the derivative of the damping forces by the velocities, times `weight`, without that of
  // the frames. Gives its operations.
  Operations add_damping_tangent(std::span<const Tensor<double>> frames, double damping_s,
                                 double weight, sparse::BlockMatrix& k) const;

 private:
  struct Element {
    std::array<int, 4> node{};
    int material = 0;              // in the body's table
    double volume = 0;             // m³
    Gradients<double> gradient{};  // 1/m
    Gradients<double> weighted{};  // V times it, m²
    // The block of K of each pair of nodes, a row's after the other; −1 if one of them is held.
    std::array<int, 16> block{};
  };

  // The law of an element, whose kind is known.
  template <class Law>
  const Law& law_of(const Element& element) const;
  Deformation assemble(std::span<const double> u, Linearisation linearisation, double support,
                       sparse::BlockMatrix& k) const;
  template <class Visit>
  Deformation each_element(std::span<const double> u, const Visit& visit) const;
  template <class Law>
  void visit_forces(const Element& element, const Motion& motion, double times, std::span<double> f,
                    Tensor<double>* frame, Deformation& found) const;
  static void add_forces_of(const Element& element, const Tensor<double>& stress,
                            std::span<double> f);
  Viscous viscous(const Element& element, double damping_s) const;
  Operations add_blocks(const Element& element, const Blocks<double>& blocks,
                        sparse::BlockMatrix& k) const;

  const fem::Body& body_;
  std::vector<Law> laws_;        // of each material
  std::vector<fem::Lame> lame_;  // likewise
  std::vector<Element> elements_;
  std::vector<int> first_at_node_;  // of each mesh node, into:
  std::vector<int> at_node_;        // elements
};

}  // namespace hvp::tissue
