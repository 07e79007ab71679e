#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "models/index.h"
#include "models/tissue/element_loop.h"
#include "models/tissue/element_points.h"

// What forces (element_loop.cpp) and tangents (element_tangents.cpp) take of an element alike.
namespace hvp::tissue {

template <class Kind>
Viscous ElementLoop<Kind>::viscous(const Element& element, double damping_s) const {
  const fem::Lame& lame = lame_[at(element.material)];
  return {Kind::kMeanDilatation ? 0 : damping_s * lame.lambda, damping_s * lame.mu};
}

template <class Kind>
template <class Law>
const Law& ElementLoop<Kind>::law_of(const Element& element) const {
  return *std::get_if<Law>(&laws_[at(element.material)].form());
}

template <class Kind>
auto ElementLoop<Kind>::deformation_gradients(const Element& element, std::span<const double> u)
    -> AtPoints<Tensor<double>> {
  const typename Kind::template Displaced<double> displaced(points::gather_nodes(element.node, u));
  return points::at_points<kPoints>(
      [&](std::size_t p) { return deformation_gradient(element.gradient, displaced.at(p)); });
}

template <class Kind>
template <class Law>
auto ElementLoop<Kind>::mean_of(const Element& element,
                                const AtPoints<Tensor<double>>& gradient) const -> Mean {
  using Measure = MeanDilatation<Law>;
  Mean mean{.at = points::at_points<kPoints>(
                [&](std::size_t p) { return Measure::template measure<double>(gradient[p]); }),
            .energy = {},
            .operations = points::kMeanOfPoints + Measure::kEnergy};
  double sum = 0;
  for (const Dilatation<double>& one : mean.at) {
    sum += one.s;
    mean.operations += one.operations;
  }
  mean.energy =
      Measure::energy(lame_[at(element.material)].lambda, sum / static_cast<double>(kPoints));
  return mean;
}

}  // namespace hvp::tissue
