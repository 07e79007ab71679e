#include "models/tissue/element_loop.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

#include "models/fem/assembly.h"
#include "models/index.h"
#include "models/tissue/element_terms.h"

namespace hvp::tissue {

using points::at_points;
using points::damping_operations;
using points::gather_nodes;
using points::gradients_operations;
using points::kAddPressure;
using points::kForcesOfElement;
using points::note;
using points::Seen;
using points::velocity_gradient;

namespace {

// The same law where λ is zero.
fem::Material without_lambda(const fem::Material& material) {
  material.check();
  return {.young_modulus_pa = 2 * material.lame_mu(),
          .poisson_ratio = 0,
          .density_kg_m3 = material.density_kg_m3};
}

template <class Kind>
std::vector<Law> laws_of_elements(const fem::Materials& materials, LawKind kind,
                                  const Parameters& parameters) {
  std::vector<Law> laws;
  for (const fem::Material& material : materials.table()) {
    laws.emplace_back(kind, Kind::kMeanDilatation ? without_lambda(material) : material,
                      parameters);
  }
  return laws;
}

template <class Kind>
std::array<int, Kind::kNodes> nodes_of(const mesh::TetMesh& mesh, std::size_t e) {
  if constexpr (Kind::kNodes == 4) {
    return mesh.tetrahedra[e];
  } else {
    return mesh.ten_nodes(e);
  }
}

}  // namespace

template <class Kind>
ElementLoop<Kind>::ElementLoop(const fem::Body& body, LawKind kind, const Parameters& parameters)
    : body_(body),
      laws_(laws_of_elements<Kind>(body.materials(), kind, parameters)),
      lame_(fem::lame_constants(body.materials().table())),
      elements_(body.mesh().tetrahedra.size()) {
  const sparse::BlockMatrix& k = body.stiffness();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const fem::ElementGeometry geometry = fem::element_geometry(body.mesh(), static_cast<int>(e));
    Element& element = elements_[e];
    element.node = nodes_of<Kind>(body.mesh(), e);
    element.material = static_cast<int>(body.materials().index_of(e));
    element.volume = geometry.volume() / static_cast<double>(kPoints);
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        element.gradient[a][i] = geometry.gradient[a][static_cast<int>(i)];
        element.weighted[a][i] = element.volume * element.gradient[a][i];
      }
    }
    for (std::size_t a = 0; a < kNodes; ++a) {
      for (std::size_t b = 0; b < kNodes; ++b) {
        const int row = element.node[a];
        const int column = element.node[b];
        element.block[kNodes * a + b] =
            body.held(row) || body.held(column)
                ? -1
                : static_cast<int>(k.find(body.active_index(row), body.active_index(column)));
      }
    }
  }
  first_at_node_.assign(body.mesh().nodes.size() + 1, 0);
  for (const Element& element : elements_) {
    for (const int node : element.node) ++first_at_node_[at(node) + 1];
  }
  std::partial_sum(first_at_node_.begin(), first_at_node_.end(), first_at_node_.begin());
  at_node_.resize(kNodes * elements_.size());
  std::vector<int> next(first_at_node_.begin(), first_at_node_.end() - 1);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    for (const int node : elements_[e].node) at_node_[at(next[at(node)]++)] = static_cast<int>(e);
  }
}

template <class Kind>
std::span<const int> ElementLoop<Kind>::elements_at(int node) const {
  const auto first = at(first_at_node_[at(node)]);
  return std::span(at_node_).subspan(first, at(first_at_node_[at(node) + 1]) - first);
}

// The damping stress at each point, in the frame that `frame` gives for it. With mean dilatation λ
// acts on the mean of tr(AᵀḞ) alone, as elastic forces do.
template <class Kind>
template <class FrameAt>
auto ElementLoop<Kind>::damping_stresses(const Element& element, const Motion& motion,
                                         const FrameAt& frame) const -> AtPoints<Tensor<double>> {
  const typename Kind::template Displaced<double> moving(gather_nodes(element.node, motion.v));
  const Viscous damping = viscous(element, motion.damping_s);
  if constexpr (!Kind::kMeanDilatation) {
    return at_points<kPoints>([&](std::size_t p) {
      return damping.stress(frame(p), velocity_gradient(element.gradient, moving.at(p)));
    });
  } else {
    const auto rate = at_points<kPoints>(
        [&](std::size_t p) { return velocity_gradient(element.gradient, moving.at(p)); });
    double sum = 0;
    for (std::size_t p = 0; p < kPoints; ++p) sum += contract(frame(p), rate[p]);
    const double pressure =
        motion.damping_s * lame_[at(element.material)].lambda * sum / static_cast<double>(kPoints);
    return at_points<kPoints>([&](std::size_t p) {
      return combine(1.0, damping.stress(frame(p), rate[p]), pressure, frame(p));
    });
  }
}

template <class Kind>
void ElementLoop<Kind>::add_forces_of(const Element& element,
                                      const AtPoints<Tensor<double>>& stress, std::span<double> f) {
  if constexpr (kPoints == 1) {
    std::array<double*, 4> force{};
    for (std::size_t a = 0; a < 4; ++a) force[a] = &f[3 * at(element.node[a])];
    tissue::add_forces(stress[0], element.weighted, force);
  } else {
    TenNodes::Forces<double> sum;
    for (std::size_t p = 0; p < kPoints; ++p) sum.add(p, stress[p], element.weighted);
    const OfNodes<double, kNodes> forces = sum.of_nodes();
    for (std::size_t a = 0; a < kNodes; ++a) {
      double* force = &f[3 * at(element.node[a])];
      for (std::size_t i = 0; i < 3; ++i) force[i] += forces[a][i];
    }
  }
}

template <class Kind>
template <class Law>
void ElementLoop<Kind>::visit_forces(const Element& element, const Motion& motion, double times,
                                     std::span<double> f, Tensor<double>* frames,
                                     Deformation& found) const {
  const Law& law = law_of<Law>(element);
  // One point needs no arrays, and a frame's loop over linear elements is as fast without.
  if constexpr (kPoints == 1) {
    Framed framed = framed_stress(
        law, deformation_gradient(element.gradient, gather_nodes(element.node, motion.u)));
    Stress<double>& stress = framed.stress;
    note(found, stress);
    found.operations += kDeformationGradient;
    if (!stress.defined) return;
    if (!motion.v.empty()) {
      const Tensor<double> damping =
          viscous(element, motion.damping_s)
              .stress(framed.frame,
                      velocity_gradient(element.gradient, gather_nodes(element.node, motion.v)));
      for (std::size_t i = 0; i < 9; ++i) stress.p[i] += damping[i];
      found.operations += damping_operations<Kind>();
      if (frames != nullptr) *frames = framed.frame;
    }
    if (times != 1) {
      for (double& p : stress.p) p *= times;
    }
    std::array<double*, 4> force{};
    for (std::size_t a = 0; a < 4; ++a) force[a] = &f[3 * at(element.node[a])];
    tissue::add_forces(stress.p, element.weighted, force);
    found.operations += kForcesOfElement<Kind>;
  } else {
    const AtPoints<Tensor<double>> gradient = deformation_gradients(element, motion.u);
    AtPoints<Framed> framed =
        at_points<kPoints>([&](std::size_t p) { return framed_stress(law, gradient[p]); });
    Seen seen;
    for (const Framed& one : framed) seen.add(one.stress);
    if constexpr (Kind::kMeanDilatation) {
      if (seen.defined) {
        const Mean mean = mean_of<Law>(element, gradient);
        for (std::size_t p = 0; p < kPoints; ++p) {
          for (std::size_t i = 0; i < 9; ++i) {
            framed[p].stress.p[i] += mean.energy.pressure * mean.at[p].gradient[i];
          }
        }
        seen.operations += mean.operations + static_cast<double>(kPoints) * kAddPressure;
      }
    }
    note(found, seen);
    found.operations += gradients_operations<Kind>(kDeformationGradient);
    if (!seen.defined) return;
    AtPoints<Tensor<double>> stress =
        at_points<kPoints>([&](std::size_t p) { return framed[p].stress.p; });
    if (!motion.v.empty()) {
      const AtPoints<Tensor<double>> damping =
          damping_stresses(element, motion, [&](std::size_t p) { return framed[p].frame; });
      for (std::size_t p = 0; p < kPoints; ++p) {
        for (std::size_t i = 0; i < 9; ++i) stress[p][i] += damping[p][i];
        if (frames != nullptr) frames[p] = framed[p].frame;
      }
      found.operations += damping_operations<Kind>();
    }
    if (times != 1) {
      for (Tensor<double>& one : stress) {
        for (double& p : one) p *= times;
      }
    }
    add_forces_of(element, stress, f);
    found.operations += kForcesOfElement<Kind>;
  }
}

template <class Kind>
Deformation ElementLoop<Kind>::forces(const Motion& motion, std::span<double> f,
                                      std::span<Tensor<double>> frames) const {
  assert(f.size() == motion.u.size());
  std::fill(f.begin(), f.end(), 0.0);
  Deformation found;
  std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        for (std::size_t e = 0; e < elements_.size(); ++e) {
          Tensor<double>* frame = frames.empty() ? nullptr : &frames[kPoints * e];
          visit_forces<Form>(elements_[e], motion, 1, f, frame, found);
        }
      },
      laws_.front().form());
  return found;
}

template <class Kind>
Deformation ElementLoop<Kind>::add_forces(std::span<const int> elements, const Motion& motion,
                                          double times, std::span<double> f) const {
  Deformation found;
  std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        for (const int e : elements) {
          visit_forces<Form>(elements_[at(e)], motion, times, f, nullptr, found);
        }
      },
      laws_.front().form());
  return found;
}

template <class Kind>
Operations ElementLoop<Kind>::add_damping(std::span<const Tensor<double>> frames,
                                          const Motion& motion, std::span<double> f) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    add_forces_of(elements_[e],
                  damping_stresses(elements_[e], motion,
                                   [&](std::size_t p) { return frames[kPoints * e + p]; }),
                  f);
  }
  return static_cast<double>(elements_.size()) *
         (damping_operations<Kind>() + kForcesOfElement<Kind>);
}

template <class Kind>
Deformation ElementLoop<Kind>::energy(std::span<const double> u, double& energy_j) const {
  energy_j = 0;
  Deformation found;
  std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        for (const Element& element : elements_) {
          const AtPoints<Tensor<double>> gradient = deformation_gradients(element, u);
          Seen seen;
          double of_element = 0;
          for (const Tensor<double>& f : gradient) {
            const Energy<double> energy = law_of<Form>(element).energy(f);
            seen.add(energy);
            of_element += element.volume * energy.density;
          }
          if constexpr (Kind::kMeanDilatation) {
            if (seen.defined) {
              const Mean mean = mean_of<Form>(element, gradient);
              of_element += static_cast<double>(kPoints) * element.volume * mean.energy.density;
              seen.operations += mean.operations + Operations{.add_multiply = 3};
            }
          }
          note(found, seen);
          if (seen.defined) energy_j += of_element;
        }
      },
      laws_.front().form());
  found.operations += static_cast<double>(elements_.size()) *
                      (gradients_operations<Kind>(kDeformationGradient) +
                       Operations{.add_multiply = 2.0 * static_cast<double>(kPoints)});
  return found;
}

template class ElementLoop<FourNodes>;
template class ElementLoop<TenNodes>;
template class ElementLoop<TenNodesOfMeanDilatation>;

}  // namespace hvp::tissue
