#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "models/index.h"
#include "models/tissue/element.h"
#include "models/tissue/operations.h"
#include "models/tissue/potential_body.h"
#include "models/tissue/ten_nodes.h"
#include "models/tissue/viscous.h"

// What the loops of element_loop.cpp sum over the points of an element.
namespace hvp::tissue::points {

inline constexpr Operations kAddBlock = {.add_multiply = 9};
inline constexpr Operations kVelocityGradient = {.add_multiply = 54};
// A mean over four points, λ's energy or pressure apart.
inline constexpr Operations kMeanOfPoints = {.add_multiply = 4};
// Adds p·∂s/∂F at a point.
inline constexpr Operations kAddPressure = {.add_multiply = 18};
// A:Ḟ and its pressure at a point.
inline constexpr Operations kMeanDamping = {.add_multiply = 17 + 18};

// What is found at an element's points.
struct Seen {
  double determinant = std::numeric_limits<double>::infinity();  // the smallest; NaN if one is
  bool defined = true;
  Operations operations = {};

  template <class Answer>
  void add(const Answer& answer) {
    if (answer.determinant < determinant || std::isnan(answer.determinant)) {
      determinant = answer.determinant;
    }
    defined = defined && answer.defined;
    operations += answer.operations;
  }
};

// Of a law's answer, or of what is seen at several points.
template <class Answer>
void note(Deformation& found, const Answer& seen) {
  found.operations += seen.operations;
  if (seen.determinant < found.smallest_determinant || std::isnan(seen.determinant)) {
    found.smallest_determinant = seen.determinant;
  }
  if (!(seen.determinant > 0)) ++found.inverted;
  if (!seen.defined || !std::isfinite(seen.determinant)) ++found.undefined;
  if (!seen.defined && seen.determinant > 0 && std::isfinite(seen.determinant)) ++found.overflown;
}

// Of each point what `of` gives for it.
template <std::size_t... Points, class Of>
auto at_points(std::index_sequence<Points...> /*all*/, const Of& of) {
  return std::array<decltype(of(std::size_t{})), sizeof...(Points)>{of(Points)...};
}
template <std::size_t Points, class Of>
auto at_points(const Of& of) {
  return at_points(std::make_index_sequence<Points>{}, of);
}

// What the nodes of an element have in a vector over mesh nodes.
template <std::size_t N>
OfNodes<double, N> gather_nodes(const std::array<int, N>& nodes, std::span<const double> of) {
  OfNodes<double, N> values{};
  for (std::size_t a = 0; a < N; ++a) std::copy_n(&of[3 * at(nodes[a])], 3, values[a].begin());
  return values;
}

// ∇v = Ḟ.
inline Tensor<double> velocity_gradient(const Gradients<double>& g, const OfNodes<double, 4>& v) {
  Tensor<double> rate;
  for (std::size_t i = 0; i < 3; ++i) {
    const double d1 = v[1][i] - v[0][i];
    const double d2 = v[2][i] - v[0][i];
    const double d3 = v[3][i] - v[0][i];
    for (std::size_t j = 0; j < 3; ++j) {
      rate[3 * i + j] = d1 * g[1][j] + d2 * g[2][j] + d3 * g[3][j];
    }
  }
  return rate;
}

// What the forces of all points add to the nodes of an element.
template <class Kind>
inline constexpr Operations kForcesOfElement =
    Kind::kForces + static_cast<double>(Kind::kPoints) * Kind::kForcesAt
    + Operations{.add_multiply = Kind::kPoints == 1 ? 0 : 3.0 * Kind::kNodes};
// From displacements, or velocities, to a gradient at each point.
template <class Kind>
constexpr Operations gradients_operations(const Operations& gradient) {
  return Kind::kDisplaced + static_cast<double>(Kind::kPoints) * (Kind::kDisplacedAt + gradient);
}

// ∂(V·s̄)/∂u of the ten nodes, from ∂s/∂F at each point.
template <class GradientAt>
OfNodes<double, 10> gradient_of_mean(const Gradients<double>& weighted, const GradientAt& at) {
  TenNodes::Forces<double> sum;
  for (std::size_t p = 0; p < TenNodes::kPoints; ++p) sum.add(p, at(p), weighted);
  return sum.of_nodes();
}
inline constexpr Operations kGradientOfMean =
    TenNodes::kForces + static_cast<double>(TenNodes::kPoints) * TenNodes::kForcesAt;

template <class Kind>
constexpr Operations damping_operations() {
  const Operations mean = Kind::kMeanDilatation
                              ? kMeanOfPoints + static_cast<double>(Kind::kPoints) * kMeanDamping
                              : Operations{};
  return gradients_operations<Kind>(kVelocityGradient) +
         static_cast<double>(Kind::kPoints) * Viscous::kStress + mean;
}

}  // namespace hvp::tissue::points
