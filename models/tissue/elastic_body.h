#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/law.h"
#include "models/tissue/operations.h"
#include "models/tissue/viscous.h"

namespace hvp::tissue {

// What a call found on its way through the elements.
struct Deformation {
  double smallest_determinant = std::numeric_limits<double>::infinity();  // det F; NaN if one is
  int inverted = 0;                                                       // det F not above zero
  // Elements for which the law is not defined, which add nothing, or whose det F is not a finite
  // number. The call's numbers are then no forces and no energy of this body.
  int undefined = 0;
  Operations operations = {};  // of this call

  bool defined() const { return undefined == 0; }
};

// Displacements, and the velocities that stiffness damping brakes.
struct Motion {
  std::span<const double> u;  // m
  std::span<const double> v;  // m/s; empty without damping
  double damping_s = 0;       // β of Rayleigh's damping, models/tissue/viscous.h
};

// A body of a hyperelastic material: the energy of its displacements, their internal forces and
// their stiffness. It knows neither time nor loads nor who solves.
//
// Displacements (m) and forces (N) are over all mesh nodes, three each; fem::Body::expand() makes
// them from active ones. Elements are gone through in ascending order, so that every sum has one
// order. No call allocates.
class ElasticBody {
 public:
  // Keeps a reference to the body. Throws InputError for a material out of range or an element that
  // is inverted at rest.
  ElasticBody(const fem::Body& body, LawKind kind);

  const fem::Body& body() const { return body_; }
  const Law& law() const { return law_; }

  // f = ∂Ψ/∂u. At an anchored or prescribed node it is the force with which its support acts on it.
  [[nodiscard]] Deformation internal_forces(std::span<const double> u, std::span<double> f) const;
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

  // Ψ = Σ V·ψ, J.
  [[nodiscard]] Deformation energy(std::span<const double> u, double& energy_j) const;
  // ∂f/∂u over the active nodes, N/m, symmetric to the last bit; `k` has the pattern of
  // fem::Body::stiffness(), and for the linear law its values. Held nodes that the body keeps have
  // that matrix' diagonal and nothing else.
  [[nodiscard]] Deformation tangent(std::span<const double> u, Linearisation linearisation,
                                    sparse::BlockMatrix& k) const;
  // Adds the derivative of the damping forces by the velocities, times `weight`, without that of
  // the frames.
  void add_damping_tangent(std::span<const Tensor<double>> frames, double damping_s, double weight,
                           sparse::BlockMatrix& k) const;

 private:
  struct Element {
    std::array<int, 4> node{};
    double volume = 0;             // m³
    Gradients<double> gradient{};  // 1/m
    Gradients<double> weighted{};  // V times it, m²
    // The block of K of each pair of nodes, a row's after the other; −1 if one of them is held.
    std::array<int, 16> block{};
  };

  template <class Visit>
  Deformation each_element(std::span<const double> u, const Visit& visit) const;
  template <class Law>
  void visit_forces(const Law& law, const Element& element, const Motion& motion,
                    const Viscous& damping, double times, std::span<double> f,
                    Tensor<double>* frame, Deformation& found) const;
  static void add_forces_of(const Element& element, const Tensor<double>& stress,
                            std::span<double> f);
  Viscous viscous(double damping_s) const;
  Operations add_blocks(const Element& element, const Blocks<double>& blocks,
                        sparse::BlockMatrix& k) const;

  const fem::Body& body_;
  Law law_;
  std::vector<Element> elements_;
  std::vector<int> first_at_node_;  // of each mesh node, into:
  std::vector<int> at_node_;        // elements
};

}  // namespace hvp::tissue
