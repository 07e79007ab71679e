#include "models/tissue/springs.h"

#include <algorithm>
#include <cassert>

#include "models/fem/assembly.h"
#include "models/index.h"

namespace hvp::tissue {
namespace {

// The vector between the ends, and their forces.
constexpr Operations kAroundSpring = {.add_multiply = 6 + 6};
constexpr Operations kSpringEnergy = {.add_multiply = 6 + 5 + 5, .functions = 1};
// d, l, n and both parts of the block.
constexpr Operations kSpringTangent = {
    .add_multiply = 6 + 5 + 3 + 2 + 6 * 2 + 3, .divisions = 2, .functions = 1};
constexpr Operations kAddSpringBlock = {.add_multiply = 9};

Vector<double> between(const SpringBody::Spring& spring, std::span<const double> u) {
  const double* first = &u[3 * at(spring.node[0])];
  const double* second = &u[3 * at(spring.node[1])];
  Vector<double> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = spring.rest[i] + (second[i] - first[i]);
  return d;
}

bool has_direction(double length) { return length > 0 && std::isfinite(length); }

}  // namespace

std::vector<Edge> edges_of(const mesh::TetMesh& mesh, const fem::Materials& materials) {
  struct Part {
    std::array<int, 2> node{};
    double volume = 0;   // m³
    double modulus = 0;  // Pa
  };
  std::vector<Part> all;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const double volume = fem::element_geometry(mesh, static_cast<int>(e)).volume();
    const double modulus = materials.of(e).young_modulus_pa;
    const std::array<int, 4>& node = mesh.tetrahedra[e];
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a + 1; b < 4; ++b) {
        all.push_back({{std::min(node[a], node[b]), std::max(node[a], node[b])}, volume, modulus});
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Part& x, const Part& y) { return x.node < y.node; });
  std::vector<Edge> edges;
  for (std::size_t first = 0, next = 0; first < all.size(); first = next) {
    // E of the first tetrahedron is taken out of the sum, so that equal ones round as E·ΣV does.
    double volume = 0;
    double beyond = 0;
    for (next = first; next < all.size() && all[next].node == all[first].node; ++next) {
      volume += all[next].volume;
      beyond += (all[next].modulus - all[first].modulus) * all[next].volume;
    }
    edges.push_back({all[first].node, all[first].modulus * volume + beyond});
  }
  return edges;
}

SpringBody::SpringBody(const fem::Body& body) : body_(body) {
  const mesh::TetMesh& mesh = body.mesh();
  for (const Edge& edge : edges_of(mesh, body.materials())) {
    Spring spring{.node = edge.node};
    const Eigen::Vector3d rest = mesh.nodes[at(edge.node[1])] - mesh.nodes[at(edge.node[0])];
    std::copy_n(rest.data(), 3, spring.rest.begin());
    spring.length = rest.norm();
    spring.stiffness = edge.modulus_volume / rest.squaredNorm();
    spring.pull_at_rest = spring.stiffness * spring.length;
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t b = 0; b < 2; ++b) {
        const int row = edge.node[a];
        const int column = edge.node[b];
        spring.block[2 * a + b] = body.held(row) || body.held(column)
                                      ? -1
                                      : static_cast<int>(body.stiffness().find(
                                            body.active_index(row), body.active_index(column)));
      }
    }
    springs_.push_back(spring);
  }
}

Deformation SpringBody::internal_forces(std::span<const double> u, std::span<double> f) const {
  assert(u.size() == 3 * body_.mesh().nodes.size() && f.size() == u.size());
  std::fill(f.begin(), f.end(), 0.0);
  Deformation found;
  for (const Spring& spring : springs_) {
    const SpringForce<double> pull =
        spring_force(between(spring, u), spring.stiffness, spring.pull_at_rest);
    if (!has_direction(pull.length)) {
      ++found.undefined;
      continue;
    }
    double* first = &f[3 * at(spring.node[0])];
    double* second = &f[3 * at(spring.node[1])];
    for (std::size_t i = 0; i < 3; ++i) {
      first[i] -= pull.force[i];
      second[i] += pull.force[i];
    }
  }
  found.operations = static_cast<double>(springs_.size()) * (kAroundSpring + kSpringForce);
  return found;
}

Deformation SpringBody::energy(std::span<const double> u, double& energy_j) const {
  energy_j = 0;
  Deformation found;
  for (const Spring& spring : springs_) {
    const Vector<double> d = between(spring, u);
    const double length = std::sqrt(dot(d, d));
    if (!has_direction(length)) {
      ++found.undefined;
      continue;
    }
    const double longer = length - spring.length;
    energy_j += 0.5 * spring.stiffness * (longer * longer);
  }
  found.operations = static_cast<double>(springs_.size()) * kSpringEnergy;
  return found;
}

Deformation SpringBody::tangent(std::span<const double> u, Linearisation linearisation,
                                sparse::BlockMatrix& k) const {
  assert(k.blocks() == body_.stiffness().blocks());
  std::fill(k.value.begin(), k.value.end(), 0.0);
  Deformation found;
  double added = 0;
  for (const Spring& spring : springs_) {
    const Vector<double> d = between(spring, u);
    const double length = std::sqrt(dot(d, d));
    if (!has_direction(length)) {
      ++found.undefined;
      continue;
    }
    const double across = linearisation == Linearisation::exact
                              ? spring.stiffness - spring.pull_at_rest / length
                              : 0.0;
    const double along = spring.stiffness - across;
    const double inverse = 1 / length;
    const Vector<double> n = {inverse * d[0], inverse * d[1], inverse * d[2]};
    const Tensor<double> block = symmetric<double>([&](std::size_t i, std::size_t j) {
      const double entry = along * (n[i] * n[j]);
      return i == j ? entry + across : entry;
    });
    for (std::size_t pair = 0; pair < 4; ++pair) {
      if (spring.block[pair] < 0) continue;
      double* sum = k.block(at(spring.block[pair]));
      const double sign = pair == 0 || pair == 3 ? 1 : -1;
      for (std::size_t i = 0; i < 9; ++i) sum[i] += sign * block[i];
      ++added;
    }
  }
  for (int a = 0; a < body_.active_nodes(); ++a) {
    if (!body_.held(body_.node_of_active()[at(a)])) continue;
    const auto own = static_cast<std::size_t>(k.find(a, a));
    std::copy_n(body_.stiffness().block(own), 9, k.block(own));
  }
  found.operations =
      static_cast<double>(springs_.size()) * kSpringTangent + added * kAddSpringBlock;
  return found;
}

}  // namespace hvp::tissue
