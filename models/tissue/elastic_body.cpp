#include "models/tissue/elastic_body.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <type_traits>

#include "models/fem/assembly.h"
#include "models/index.h"
#include "models/tissue/semidefinite.h"

namespace hvp::tissue {
namespace {

constexpr Operations kAddBlock = {.add_multiply = 9};
constexpr Operations kVelocityGradient = {.add_multiply = 54};

void note(Deformation& found, double determinant, bool defined, const Operations& operations) {
  found.operations += operations;
  if (determinant < found.smallest_determinant || std::isnan(determinant)) {
    found.smallest_determinant = determinant;
  }
  if (!(determinant > 0)) ++found.inverted;
  if (!defined || !std::isfinite(determinant)) ++found.undefined;
}

// What the four nodes of an element have in a vector over mesh nodes.
std::array<Vector<double>, 4> gather(const std::array<int, 4>& nodes, std::span<const double> of) {
  std::array<Vector<double>, 4> values{};
  for (std::size_t a = 0; a < 4; ++a) std::copy_n(&of[3 * at(nodes[a])], 3, values[a].begin());
  return values;
}

// ∇v = Ḟ.
Tensor<double> velocity_gradient(const Gradients<double>& g,
                                 const std::array<Vector<double>, 4>& v) {
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

std::vector<Law> laws_of(const fem::Materials& materials, LawKind kind,
                         const Parameters& parameters) {
  std::vector<Law> laws;
  for (const fem::Material& material : materials.table()) {
    laws.emplace_back(kind, material, parameters);
  }
  return laws;
}

}  // namespace

ElasticBody::ElasticBody(const fem::Body& body, LawKind kind, const Parameters& parameters)
    : body_(body),
      laws_(laws_of(body.materials(), kind, parameters)),
      lame_(fem::lame_constants(body.materials().table())),
      elements_(body.mesh().tetrahedra.size()) {
  const sparse::BlockMatrix& k = body.stiffness();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const fem::ElementGeometry geometry = fem::element_geometry(body.mesh(), static_cast<int>(e));
    Element& element = elements_[e];
    element.node = body.mesh().tetrahedra[e];
    element.material = static_cast<int>(body.materials().index_of(e));
    element.volume = geometry.volume();
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        element.gradient[a][i] = geometry.gradient[a][static_cast<int>(i)];
        element.weighted[a][i] = element.volume * element.gradient[a][i];
      }
      for (std::size_t b = 0; b < 4; ++b) {
        const int row = element.node[a];
        const int column = element.node[b];
        element.block[4 * a + b] =
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
  at_node_.resize(4 * elements_.size());
  std::vector<int> next(first_at_node_.begin(), first_at_node_.end() - 1);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    for (const int node : elements_[e].node) at_node_[at(next[at(node)]++)] = static_cast<int>(e);
  }
}

std::span<const int> ElasticBody::elements_at(int node) const {
  const auto first = at(first_at_node_[at(node)]);
  return std::span(at_node_).subspan(first, at(first_at_node_[at(node) + 1]) - first);
}

Viscous ElasticBody::viscous(const Element& element, double damping_s) const {
  const fem::Lame& lame = lame_[at(element.material)];
  return {damping_s * lame.lambda, damping_s * lame.mu};
}

template <class Law>
const Law& ElasticBody::law_of(const Element& element) const {
  return *std::get_if<Law>(&laws_[at(element.material)].form());
}

// Calls visit(element, F) for each element and notes what the law says of it; visit returns the
// law's answer.
template <class Visit>
Deformation ElasticBody::each_element(std::span<const double> u, const Visit& visit) const {
  assert(u.size() == 3 * body_.mesh().nodes.size());
  Deformation found;
  for (const Element& element : elements_) {
    const auto answer =
        visit(element, deformation_gradient(element.gradient, gather(element.node, u)));
    note(found, answer.determinant, answer.defined, answer.operations);
  }
  found.operations += static_cast<double>(elements_.size()) * kDeformationGradient;
  return found;
}

Deformation ElasticBody::internal_forces(std::span<const double> u, std::span<double> f) const {
  return forces({.u = u, .v = {}}, f, {});
}

template <class Law>
void ElasticBody::visit_forces(const Element& element, const Motion& motion, double times,
                               std::span<double> f, Tensor<double>* frame,
                               Deformation& found) const {
  Framed framed = framed_stress(
      law_of<Law>(element), deformation_gradient(element.gradient, gather(element.node, motion.u)));
  Stress<double>& stress = framed.stress;
  note(found, stress.determinant, stress.defined, stress.operations);
  found.operations += kDeformationGradient;
  if (!stress.defined) return;
  if (!motion.v.empty()) {
    const Tensor<double> viscous_stress =
        viscous(element, motion.damping_s)
            .stress(framed.frame,
                    velocity_gradient(element.gradient, gather(element.node, motion.v)));
    for (std::size_t i = 0; i < 9; ++i) stress.p[i] += viscous_stress[i];
    found.operations += kVelocityGradient + Viscous::kStress;
    if (frame != nullptr) *frame = framed.frame;
  }
  if (times != 1) {
    for (double& p : stress.p) p *= times;
  }
  add_forces_of(element, stress.p, f);
  found.operations += kAddForces;
}

void ElasticBody::add_forces_of(const Element& element, const Tensor<double>& stress,
                                std::span<double> f) {
  std::array<double*, 4> force{};
  for (std::size_t a = 0; a < 4; ++a) force[a] = &f[3 * at(element.node[a])];
  tissue::add_forces(stress, element.weighted, force);
}

Deformation ElasticBody::forces(const Motion& motion, std::span<double> f,
                                std::span<Tensor<double>> frames) const {
  assert(f.size() == motion.u.size());
  std::fill(f.begin(), f.end(), 0.0);
  Deformation found;
  std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        for (std::size_t e = 0; e < elements_.size(); ++e) {
          Tensor<double>* frame = frames.empty() ? nullptr : &frames[e];
          visit_forces<Form>(elements_[e], motion, 1, f, frame, found);
        }
      },
      laws_.front().form());
  return found;
}

Deformation ElasticBody::add_forces(std::span<const int> elements, const Motion& motion,
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

Operations ElasticBody::add_damping(std::span<const Tensor<double>> frames, const Motion& motion,
                                    std::span<double> f) const {
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    const Viscous damping = viscous(element, motion.damping_s);
    add_forces_of(element,
                  damping.stress(frames[e], velocity_gradient(element.gradient,
                                                              gather(element.node, motion.v))),
                  f);
  }
  return static_cast<double>(elements_.size()) *
         (kVelocityGradient + Viscous::kStress + kAddForces);
}

Deformation ElasticBody::energy(std::span<const double> u, double& energy_j) const {
  energy_j = 0;
  Deformation found = std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        return each_element(u, [&](const Element& element, const Tensor<double>& gradient) {
          const Energy<double> energy = law_of<Form>(element).energy(gradient);
          energy_j += element.volume * energy.density;
          return energy;
        });
      },
      laws_.front().form());
  found.operations += {.add_multiply = 2.0 * static_cast<double>(elements_.size())};
  return found;
}

Deformation ElasticBody::tangent(std::span<const double> u, Linearisation linearisation,
                                 sparse::BlockMatrix& k) const {
  return assemble(u, linearisation, 0, k);
}

Deformation ElasticBody::supported_tangent(std::span<const double> u, double support,
                                           sparse::BlockMatrix& k) const {
  return assemble(u, Linearisation::semidefinite, support, k);
}

Deformation ElasticBody::assemble(std::span<const double> u, Linearisation linearisation,
                                  double support, sparse::BlockMatrix& k) const {
  assert(k.blocks() == body_.stiffness().blocks());
  std::fill(k.value.begin(), k.value.end(), 0.0);
  Operations added;
  int projected = 0;
  const bool projects = linearisation == Linearisation::semidefinite && kind() != LawKind::linear &&
                        kind() != LawKind::corotational;
  Deformation found = std::visit(
      [&](const auto& law) {
        using Form = std::decay_t<decltype(law)>;
        return each_element(u, [&](const Element& element, const Tensor<double>& gradient) {
          Tangent<double> tangent = law_of<Form>(element).tangent(gradient, element.gradient,
                                                                  element.volume, linearisation);
          if (projects && tangent.defined) {
            const double density = body_.materials().table()[at(element.material)].density_kg_m3;
            const Projection projection =
                make_semidefinite(tangent.blocks, support * density * element.volume);
            projected += projection.changed ? 1 : 0;
            added += projection.operations;
          }
          if (tangent.defined) added += add_blocks(element, tangent.blocks, k);
          return tangent;
        });
      },
      laws_.front().form());
  found.operations += added;
  found.projected = projected;
  for (int a = 0; a < body_.active_nodes(); ++a) {
    if (!body_.held(body_.node_of_active()[at(a)])) continue;
    const auto own = static_cast<std::size_t>(k.find(a, a));
    std::copy_n(body_.stiffness().block(own), 9, k.block(own));
  }
  return found;
}

Operations ElasticBody::add_damping_tangent(std::span<const Tensor<double>> frames,
                                            double damping_s, double weight,
                                            sparse::BlockMatrix& k) const {
  Operations operations = static_cast<double>(elements_.size()) * Viscous::kTangent;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    Blocks<double> blocks{};
    viscous(elements_[e], damping_s)
        .add_tangent(frames[e], elements_[e].gradient, elements_[e].volume, weight, blocks);
    operations += add_blocks(elements_[e], blocks, k);
  }
  return operations;
}

Operations ElasticBody::add_blocks(const Element& element, const Blocks<double>& blocks,
                                   sparse::BlockMatrix& k) const {
  Operations operations;
  std::size_t pair = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      const Tensor<double>& block = blocks[pair++];
      if (element.block[4 * a + b] < 0) continue;
      double* upper = k.block(at(element.block[4 * a + b]));
      for (std::size_t i = 0; i < 9; ++i) upper[i] += block[i];
      operations += kAddBlock;
      if (a == b) continue;
      double* lower = k.block(at(element.block[4 * b + a]));
      for (std::size_t i = 0; i < 9; ++i) lower[i] += block[3 * (i % 3) + i / 3];
      operations += kAddBlock;
    }
  }
  return operations;
}

}  // namespace hvp::tissue
