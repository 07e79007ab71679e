#include "models/collision/probe_coupling.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>

#include "models/index.h"

namespace hvp::collision {

namespace {

constexpr double kNearest = 1.2;  // of the mean edge
constexpr double kFarthest = 2.5;
constexpr std::size_t kFewest = 4;  // nodes around
constexpr double kSmooth = 0.9;     // the cosine between normals of one face
constexpr double kOneInTen = 0.9;
constexpr std::size_t kFewestEven = 8;  // one in so many

double plane_modulus(const fem::Material& material) {
  return material.young_modulus_pa / (1 - material.poisson_ratio * material.poisson_ratio);
}

// E* of each mesh node: the mean over the elements around it, Pa.
std::vector<double> plane_moduli(const fem::Body& body) {
  const fem::Materials& materials = body.materials();
  std::vector<double> modulus(body.mesh().nodes.size(), plane_modulus(materials.table().front()));
  if (materials.of_elements().empty()) return modulus;
  std::ranges::fill(modulus, 0);
  std::vector<int> elements(modulus.size(), 0);
  for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
    for (const int node : body.mesh().tetrahedra[e]) {
      modulus[at(node)] += plane_modulus(materials.of(e));
      ++elements[at(node)];
    }
  }
  for (std::size_t i = 0; i < modulus.size(); ++i) modulus[i] /= std::max(1, elements[i]);
  return modulus;
}

double mean_edge(const DeformedSurface& surface) {
  double edges = 0;
  for (const std::array<int, 3>& t : surface.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      edges += (surface.rest_position(t[(i + 1) % 3]) - surface.rest_position(t[i])).norm();
    }
  }
  return edges / (3 * static_cast<double>(surface.triangles().size()));
}

// True where all triangles of the node look about as its normal does.
bool is_smooth(const DeformedSurface& surface, int node) {
  const Eigen::Vector3d& n = surface.rest_normal(node);
  return std::ranges::all_of(surface.ring(node), [&](int triangle) {
    const std::array<int, 3>& t = surface.triangles()[at(triangle)];
    const Eigen::Vector3d& a = surface.rest_position(t[0]);
    const Eigen::Vector3d facet =
        (surface.rest_position(t[1]) - a).cross(surface.rest_position(t[2]) - a);
    return facet.dot(n) > kSmooth * facet.norm();
  });
}

// The part of a node's compliance that is left a few elements away; empty where too few are there.
std::optional<double> far_part(const DeformedSurface& surface, SurfaceCompliance& statics, int node,
                               double edge, double plane) {
  const Eigen::Vector3d& n = surface.rest_normal(node);
  double sum = 0;
  std::size_t count = 0;
  for (const int other : surface.surface_nodes()) {
    const double r = (surface.rest_position(other) - surface.rest_position(node)).norm();
    if (!(r > kNearest * edge && r < kFarthest * edge) || !statics.has(other)) continue;
    if (!(surface.rest_normal(other).dot(n) > kSmooth)) continue;
    sum += n.dot(statics.block(other, node) * n) - 1 / (std::numbers::pi * plane * r);
    ++count;
  }
  if (count < kFewest) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

NodeCompliance::NodeCompliance(const fem::Body& body, const DeformedSurface& surface,
                               SurfaceCompliance& statics)
    : local(body.mesh().nodes.size(), std::numeric_limits<double>::quiet_NaN()),
      least(local.size(), 0.0),
      plane(plane_moduli(body)) {
  constexpr double kLocal = 1.3;  // of nodes as docs/finite-elements.md has them
  const double edge = mean_edge(surface);
  std::size_t nodes = 0;
  std::size_t found = 0;
  double sum = 0;
  for (const int node : surface.surface_nodes()) {
    if (!statics.has(node)) continue;
    const Eigen::Vector3d& n = surface.rest_normal(node);
    const Eigen::Matrix3d block = statics.block(node, node);
    const double own = n.dot(block * n);
    least[at(node)] = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly)
                          .eigenvalues()[0];
    mean += own;
    ++nodes;
    if (!is_smooth(surface, node)) continue;
    const std::optional<double> far = far_part(surface, statics, node, edge, plane[at(node)]);
    if (!far) continue;
    local[at(node)] = own - *far;
    sum += own - *far;
    ++found;
  }
  free = nodes;
  if (nodes > 0) mean /= static_cast<double>(nodes);
  if (found == 0) {
    const double young = body.materials().table().front().young_modulus_pa;
    mean_local = 1 / (kLocal * young * edge);
    return;
  }
  mean_local = sum / static_cast<double>(found);
}

ProbeCoupling::ProbeCoupling(const NodeCompliance& nodes, double radius, Answer answer)
    : of_node(nodes.local.size()) {
  constexpr double kShare = 0.3;
  constexpr double kFlat = 1.53;  // kernel radius of a flat end, over its radius
  constexpr double kKernel = 0.766;
  constexpr double kTaken = 0.8;
  const double of_mass = answer == Answer::with_mass ? kShare * nodes.mean : 0;
  const auto floor = [&](std::size_t node) {
    return answer == Answer::tabulated && radius > 0 ? -kTaken * nodes.least[node] : of_mass;
  };
  const auto of_size = [&](std::size_t node) {
    return radius > 0 ? kKernel / (nodes.plane[node] * kFlat * radius) : 0;
  };
  std::vector<double> short_of;
  for (std::size_t i = 0; i < of_node.size(); ++i) {
    if (!std::isnan(nodes.local[i])) short_of.push_back(nodes.local[i] + floor(i) - of_size(i));
  }
  const bool coarse = kFewestEven * short_of.size() < nodes.free;
  if (short_of.empty()) short_of.push_back(nodes.mean_local + of_mass - of_size(0));
  const auto tenth = short_of.begin() + static_cast<std::ptrdiff_t>(
                                            kOneInTen * static_cast<double>(short_of.size() - 1));
  std::ranges::nth_element(short_of, tenth);
  const double more = std::max(0.0, *tenth);
  // Where hardly a node is away from edges, nobody knows what is the elements'.
  if (radius > 0) excess = coarse ? nodes.mean_local : more;
  s0 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < of_node.size(); ++i) {
    const double local = std::isnan(nodes.local[i]) ? nodes.mean_local : nodes.local[i];
    of_node[i] = std::max(floor(i), of_size(i) + more - local);
    s0 = std::min(s0, of_node[i]);
  }
  for (double& own : of_node) own -= s0;
}

}  // namespace hvp::collision
