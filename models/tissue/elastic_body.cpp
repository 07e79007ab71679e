#include "models/tissue/elastic_body.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "models/fem/assembly.h"
#include "models/index.h"

namespace hvp::tissue {
namespace {

constexpr Operations kAddBlock = {.add_multiply = 9};

void note(Deformation& found, double determinant, bool defined, const Operations& operations) {
  found.operations += operations;
  if (determinant < found.smallest_determinant || std::isnan(determinant)) {
    found.smallest_determinant = determinant;
  }
  if (!(determinant > 0)) ++found.inverted;
  if (!defined || !std::isfinite(determinant)) ++found.undefined;
}

}  // namespace

ElasticBody::ElasticBody(const fem::Body& body, LawKind kind)
    : body_(body), law_(kind, body.material()), elements_(body.mesh().tetrahedra.size()) {
  const sparse::BlockMatrix& k = body.stiffness();
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const fem::ElementGeometry geometry = fem::element_geometry(body.mesh(), static_cast<int>(e));
    Element& element = elements_[e];
    element.node = body.mesh().tetrahedra[e];
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
}

// Calls visit(element, F) for each element and notes what the law says of it; visit returns the
// law's answer.
template <class Visit>
Deformation ElasticBody::each_element(std::span<const double> u, const Visit& visit) const {
  assert(u.size() == 3 * body_.mesh().nodes.size());
  Deformation found;
  std::array<Vector<double>, 4> moved{};
  for (const Element& element : elements_) {
    for (std::size_t a = 0; a < 4; ++a) {
      std::copy_n(&u[3 * at(element.node[a])], 3, moved[a].begin());
    }
    const auto answer = visit(element, deformation_gradient(element.gradient, moved));
    note(found, answer.determinant, answer.defined, answer.operations);
  }
  found.operations += static_cast<double>(elements_.size()) * kDeformationGradient;
  return found;
}

Deformation ElasticBody::internal_forces(std::span<const double> u, std::span<double> f) const {
  assert(f.size() == u.size());
  std::fill(f.begin(), f.end(), 0.0);
  int added = 0;
  Deformation found = std::visit(
      [&](const auto& law) {
        return each_element(u, [&](const Element& element, const Tensor<double>& gradient) {
          const Stress<double> stress = law.stress(gradient);
          if (stress.defined) {
            std::array<double*, 4> force{};
            for (std::size_t a = 0; a < 4; ++a) force[a] = &f[3 * at(element.node[a])];
            add_forces(stress.p, element.weighted, force);
            ++added;
          }
          return stress;
        });
      },
      law_.form());
  found.operations += static_cast<double>(added) * kAddForces;
  return found;
}

Deformation ElasticBody::energy(std::span<const double> u, double& energy_j) const {
  energy_j = 0;
  Deformation found = std::visit(
      [&](const auto& law) {
        return each_element(u, [&](const Element& element, const Tensor<double>& gradient) {
          const Energy<double> energy = law.energy(gradient);
          energy_j += element.volume * energy.density;
          return energy;
        });
      },
      law_.form());
  found.operations += {.add_multiply = 2.0 * static_cast<double>(elements_.size())};
  return found;
}

Deformation ElasticBody::tangent(std::span<const double> u, Linearisation linearisation,
                                 sparse::BlockMatrix& k) const {
  assert(k.blocks() == body_.stiffness().blocks());
  std::fill(k.value.begin(), k.value.end(), 0.0);
  Operations added;
  Deformation found = std::visit(
      [&](const auto& law) {
        return each_element(u, [&](const Element& element, const Tensor<double>& gradient) {
          const Tangent<double> tangent =
              law.tangent(gradient, element.gradient, element.volume, linearisation);
          if (tangent.defined) added += add_blocks(element, tangent.blocks, k);
          return tangent;
        });
      },
      law_.form());
  found.operations += added;
  for (int a = 0; a < body_.active_nodes(); ++a) {
    if (!body_.held(body_.node_of_active()[at(a)])) continue;
    const auto own = static_cast<std::size_t>(k.find(a, a));
    std::copy_n(body_.stiffness().block(own), 9, k.block(own));
  }
  return found;
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
