#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/materials.h"
#include "models/sparse/block_matrix.h"
#include "models/tissue/law.h"
#include "models/tissue/mean_dilatation.h"
#include "models/tissue/operations.h"
#include "models/tissue/potential_body.h"
#include "models/tissue/ten_nodes.h"
#include "models/tissue/viscous.h"

namespace hvp::tissue {

// Displacements, and the velocities that stiffness damping brakes.
struct Motion {
  std::span<const double> u;  // m
  std::span<const double> v;  // m/s; empty without damping
  double damping_s = 0;       // β of Rayleigh's damping, models/tissue/viscous.h
};

// The elements of a body, of one kind (ten_nodes.h), with the loops over them that ElasticBody
// has. At each point of integration an element is one of four nodes, for which the laws are
// written. Elements are gone through in ascending order, so that every sum has one order.
//
// An element is inverted, or not defined, if it is at one of its points; then it adds nothing.
template <class Kind>
class ElementLoop {
 public:
  // Keeps a reference to the body. Throws InputError for a material or a parameter out of range or
  // an element that is inverted at rest.
  ElementLoop(const fem::Body& body, LawKind kind, const Parameters& parameters);

  // Of all elements.
  std::size_t points() const { return Kind::kPoints * elements_.size(); }
  std::span<const int> elements_at(int node) const;

  Deformation forces(const Motion& motion, std::span<double> f,
                     std::span<Tensor<double>> frames) const;
  Deformation add_forces(std::span<const int> elements, const Motion& motion, double times,
                         std::span<double> f) const;
  Operations add_damping(std::span<const Tensor<double>> frames, const Motion& motion,
                         std::span<double> f) const;
  Deformation energy(std::span<const double> u, double& energy_j) const;
  Deformation add_tangent(std::span<const double> u, Linearisation linearisation, double support,
                          sparse::BlockMatrix& k) const;
  Operations add_damping_tangent(std::span<const Tensor<double>> frames, double damping_s,
                                 double weight, sparse::BlockMatrix& k) const;

 private:
  static constexpr std::size_t kNodes = Kind::kNodes;
  static constexpr std::size_t kPoints = Kind::kPoints;

  struct Element {
    std::array<int, kNodes> node{};
    int material = 0;              // in the body's table
    double volume = 0;             // m³, of each point
    Gradients<double> gradient{};  // 1/m, of the four corners
    Gradients<double> weighted{};  // a point's volume times it, m²
    // The block of K of each pair of nodes, a row's after the other; −1 if one of them is held.
    std::array<int, kNodes * kNodes> block{};
  };
  template <class Value>
  using AtPoints = std::array<Value, kPoints>;
  // The measure of volume at each point, and λ's energy of their mean.
  struct Mean {
    AtPoints<Dilatation<double>> at;
    VolumeEnergy<double> energy;
    Operations operations;
  };

  // The law of an element, whose kind is known.
  template <class Law>
  const Law& law_of(const Element& element) const;
  static AtPoints<Tensor<double>> deformation_gradients(const Element& element,
                                                        std::span<const double> u);
  template <class Law>
  Mean mean_of(const Element& element, const AtPoints<Tensor<double>>& gradient) const;
  template <class Law>
  void visit_forces(const Element& element, const Motion& motion, double times, std::span<double> f,
                    Tensor<double>* frames, Deformation& found) const;
  template <class Law>
  void visit_tangent(const Element& element, std::span<const double> u, Linearisation linearisation,
                     double support, sparse::BlockMatrix& k, Deformation& found) const;
  Viscous viscous(const Element& element, double damping_s) const;
  template <class FrameAt>
  AtPoints<Tensor<double>> damping_stresses(const Element& element, const Motion& motion,
                                            const FrameAt& frame) const;
  static void add_forces_of(const Element& element, const AtPoints<Tensor<double>>& stress,
                            std::span<double> f);

  const fem::Body& body_;
  std::vector<Law> laws_;        // of each material; with mean dilatation, where its λ is zero
  std::vector<fem::Lame> lame_;  // likewise, as the material says
  std::vector<Element> elements_;
  std::vector<int> first_at_node_;  // of each mesh node, into:
  std::vector<int> at_node_;        // elements
};

extern template class ElementLoop<FourNodes>;
extern template class ElementLoop<TenNodes>;
extern template class ElementLoop<TenNodesOfMeanDilatation>;

}  // namespace hvp::tissue
