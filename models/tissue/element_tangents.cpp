// The stiffness of elements: of their laws, and of their damping.
#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "models/tissue/element_terms.h"
#include "models/tissue/semidefinite.h"

namespace hvp::tissue {

using points::at_points;
using points::gradient_of_mean;
using points::gradients_operations;
using points::kAddBlock;
using points::kGradientOfMean;
using points::note;
using points::Seen;

namespace {

// To the places of each pair of an element's nodes.
template <std::size_t kNodes>
Operations add_blocks(const std::array<int, kNodes * kNodes>& places,
                      const BlocksOf<double, kNodes>& blocks, sparse::BlockMatrix& k) {
  Operations operations;
  std::size_t pair = 0;
  for (std::size_t a = 0; a < kNodes; ++a) {
    for (std::size_t b = a; b < kNodes; ++b) {
      const Tensor<double>& block = blocks[pair++];
      if (places[kNodes * a + b] < 0) continue;
      double* upper = k.block(at(places[kNodes * a + b]));
      for (std::size_t i = 0; i < 9; ++i) upper[i] += block[i];
      operations += kAddBlock;
      if (a == b) continue;
      double* lower = k.block(at(places[kNodes * b + a]));
      for (std::size_t i = 0; i < 9; ++i) lower[i] += block[3 * (i % 3) + i / 3];
      operations += kAddBlock;
    }
  }
  return operations;
}

}  // namespace

template <class Kind>
template <class Law>
void ElementLoop<Kind>::visit_tangent(const Element& element, std::span<const double> u,
                                      Linearisation linearisation, double support,
                                      sparse::BlockMatrix& k, Deformation& found) const {
  constexpr bool kTurns = std::is_same_v<Law, Linear> || std::is_same_v<Law, Corotational>;
  const bool projects = linearisation == Linearisation::semidefinite && !kTurns;
  const AtPoints<Tensor<double>> gradient = deformation_gradients(element, u);
  const Law& law = law_of<Law>(element);
  AtPoints<Tangent<double>> tangent = at_points<kPoints>([&](std::size_t p) {
    return law.tangent(gradient[p], element.gradient, element.volume, linearisation);
  });
  Seen seen;
  for (const Tangent<double>& one : tangent) seen.add(one);
  seen.operations += gradients_operations<Kind>(kDeformationGradient);
  if (!seen.defined) return note(found, seen);

  [[maybe_unused]] Mean mean;
  if constexpr (Kind::kMeanDilatation) {
    mean = mean_of<Law>(element, gradient);
    seen.operations += mean.operations;
    for (std::size_t p = 0; p < kPoints; ++p) {
      seen.operations += MeanDilatation<Law>::add_hessian(gradient[p], mean.at[p], element.gradient,
                                                          element.volume * mean.energy.pressure,
                                                          linearisation, tangent[p].blocks);
    }
  }
  if (projects) {
    const double density = body_.materials().table()[at(element.material)].density_kg_m3;
    bool changed = false;
    for (Tangent<double>& one : tangent) {
      const Projection projection =
          make_semidefinite(one.blocks, support * density * element.volume);
      changed = changed || projection.changed;
      seen.operations += projection.operations;
    }
    found.projected += changed ? 1 : 0;
  }
  if constexpr (kPoints == 1) {
    seen.operations += add_blocks<kNodes>(element.block, tangent[0].blocks, k);
  } else {
    TenNodes::Tangents<double> sum;
    for (std::size_t p = 0; p < kPoints; ++p) sum.add(p, tangent[p].blocks);
    BlocksOf<double, kNodes> blocks = sum.of_nodes();
    seen.operations += Kind::kTangents + static_cast<double>(kPoints) * Kind::kTangentsAt;
    if constexpr (Kind::kMeanDilatation) {
      const double modulus = projects ? std::max(mean.energy.modulus, 0.0) : mean.energy.modulus;
      TenNodes::add_outer(
          modulus / (static_cast<double>(kPoints) * element.volume),
          gradient_of_mean(element.weighted, [&](std::size_t p) { return mean.at[p].gradient; }),
          blocks);
      seen.operations += kGradientOfMean + TenNodes::kOuter;
    }
    seen.operations += add_blocks<kNodes>(element.block, blocks, k);
  }
  note(found, seen);
}

template <class Kind>
Deformation ElementLoop<Kind>::add_tangent(std::span<const double> u, Linearisation linearisation,
                                           double support, sparse::BlockMatrix& k) const {
  Deformation found;
  std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        for (const Element& element : elements_) {
          visit_tangent<Form>(element, u, linearisation, support, k, found);
        }
      },
      laws_.front().form());
  return found;
}

template <class Kind>
Operations ElementLoop<Kind>::add_damping_tangent(std::span<const Tensor<double>> frames,
                                                  double damping_s, double weight,
                                                  sparse::BlockMatrix& k) const {
  Operations operations = static_cast<double>(points()) * Viscous::kTangent;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const auto at_point = at_points<kPoints>([&](std::size_t p) {
      Blocks<double> blocks{};
      viscous(element, damping_s)
          .add_tangent(frames[kPoints * e + p], element.gradient, element.volume, weight, blocks);
      return blocks;
    });
    if constexpr (kPoints == 1) {
      operations += add_blocks<kNodes>(element.block, at_point[0], k);
    } else {
      TenNodes::Tangents<double> sum;
      for (std::size_t p = 0; p < kPoints; ++p) sum.add(p, at_point[p]);
      BlocksOf<double, kNodes> blocks = sum.of_nodes();
      operations += Kind::kTangents + static_cast<double>(kPoints) * Kind::kTangentsAt;
      if constexpr (Kind::kMeanDilatation) {
        const double modulus = weight * damping_s * lame_[at(element.material)].lambda;
        TenNodes::add_outer(
            modulus / (static_cast<double>(kPoints) * element.volume),
            gradient_of_mean(element.weighted,
                             [&](std::size_t p) { return frames[kPoints * e + p]; }),
            blocks);
        operations += kGradientOfMean + TenNodes::kOuter;
      }
      operations += add_blocks<kNodes>(element.block, blocks, k);
    }
  }
  return operations;
}

template Deformation ElementLoop<FourNodes>::add_tangent(std::span<const double>, Linearisation,
                                                         double, sparse::BlockMatrix&) const;
template Operations ElementLoop<FourNodes>::add_damping_tangent(std::span<const Tensor<double>>,
                                                                double, double,
                                                                sparse::BlockMatrix&) const;
template Deformation ElementLoop<TenNodes>::add_tangent(std::span<const double>, Linearisation,
                                                        double, sparse::BlockMatrix&) const;
template Operations ElementLoop<TenNodes>::add_damping_tangent(std::span<const Tensor<double>>,
                                                               double, double,
                                                               sparse::BlockMatrix&) const;
template Deformation ElementLoop<TenNodesOfMeanDilatation>::add_tangent(std::span<const double>,
                                                                        Linearisation, double,
                                                                        sparse::BlockMatrix&) const;
template Operations ElementLoop<TenNodesOfMeanDilatation>::add_damping_tangent(
    std::span<const Tensor<double>>, double, double, sparse::BlockMatrix&) const;

}  // namespace hvp::tissue
