#include "models/tissue/elastic_body.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "models/index.h"

namespace hvp::tissue {
namespace {

std::vector<Law> laws_of(const fem::Materials& materials, LawKind kind,
                         const Parameters& parameters) {
  std::vector<Law> laws;
  for (const fem::Material& material : materials.table()) {
    laws.emplace_back(kind, material, parameters);
  }
  return laws;
}

}  // namespace

double rounding_of_forces(const fem::Body& body) {
  double longest = 0;
  const mesh::TetMesh& mesh = body.mesh();
  for (const auto& tetrahedron : mesh.tetrahedra) {
    for (std::size_t a = 1; a < 4; ++a) {
      longest = std::max(longest,
                         (mesh.nodes[at(tetrahedron[a])] - mesh.nodes[at(tetrahedron[0])]).norm());
    }
  }
  double stiffest = 0;
  for (const double entry : body.stiffness().value) {
    stiffest = std::max(stiffest, std::abs(entry));
  }
  constexpr double kRoundings = 4;
  return kRoundings * std::numeric_limits<double>::epsilon() * stiffest * longest;
}

ElasticBody::ElasticBody(const fem::Body& body, LawKind kind, const Parameters& parameters)
    : body_(body),
      laws_(laws_of(body.materials(), kind, parameters)),
      loop_(loop_of(body, kind, parameters)) {}

ElasticBody::Loop ElasticBody::loop_of(const fem::Body& body, LawKind kind,
                                       const Parameters& parameters) {
  switch (body.elements()) {
    case fem::Elements::linear:
      break;
    case fem::Elements::quadratic:
      return Loop(std::in_place_type<ElementLoop<TenNodes>>, body, kind, parameters);
    case fem::Elements::mean_dilatation:
      return Loop(std::in_place_type<ElementLoop<TenNodesOfMeanDilatation>>, body, kind,
                  parameters);
  }
  return Loop(std::in_place_type<ElementLoop<FourNodes>>, body, kind, parameters);
}

std::size_t ElasticBody::points() const {
  return std::visit([](const auto& loop) { return loop.points(); }, loop_);
}

std::span<const int> ElasticBody::elements_at(int node) const {
  return std::visit([&](const auto& loop) { return loop.elements_at(node); }, loop_);
}

Deformation ElasticBody::internal_forces(std::span<const double> u, std::span<double> f) const {
  return forces({.u = u, .v = {}}, f, {});
}

Deformation ElasticBody::forces(const Motion& motion, std::span<double> f,
                                std::span<Tensor<double>> frames) const {
  return std::visit([&](const auto& loop) { return loop.forces(motion, f, frames); }, loop_);
}

Deformation ElasticBody::add_forces(std::span<const int> elements, const Motion& motion,
                                    double times, std::span<double> f) const {
  return std::visit([&](const auto& loop) { return loop.add_forces(elements, motion, times, f); },
                    loop_);
}

Operations ElasticBody::add_damping(std::span<const Tensor<double>> frames, const Motion& motion,
                                    std::span<double> f) const {
  return std::visit([&](const auto& loop) { return loop.add_damping(frames, motion, f); }, loop_);
}

Deformation ElasticBody::energy(std::span<const double> u, double& energy_j) const {
  assert(u.size() == 3 * body_.mesh().nodes.size());
  return std::visit([&](const auto& loop) { return loop.energy(u, energy_j); }, loop_);
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
  assert(u.size() == 3 * body_.mesh().nodes.size());
  assert(k.blocks() == body_.stiffness().blocks());
  std::fill(k.value.begin(), k.value.end(), 0.0);
  const Deformation found = std::visit(
      [&](const auto& loop) { return loop.add_tangent(u, linearisation, support, k); }, loop_);
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
  return std::visit(
      [&](const auto& loop) { return loop.add_damping_tangent(frames, damping_s, weight, k); },
      loop_);
}

}  // namespace hvp::tissue
