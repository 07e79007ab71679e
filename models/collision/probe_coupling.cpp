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
constexpr double kKernel = 0.766;  // compliance of the kernel (1 − q²)², times E* and its radius
constexpr double kFlat = 1.53;     // kernel radius of a flat end, over its radius
constexpr double kOfPoint = 0.3;   // of the mean compliance, where nodes have mass
constexpr double kOfMass = 0.1;    // of a patch, which has more mass
constexpr double kStiffer = 0.2;   // elements than the kernel that they stand for
constexpr double kOfPatch = 1.5;   // mean edges

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

// The footprint of the contact at a node.
Footprint footprint_at(const DeformedSurface& surface, int node, Footprints* shapes) {
  Footprint footprint{{node}, {1.0}};
  if (shapes == nullptr) return footprint;
  SurfaceSpot spot{.triangle = surface.ring(node).front()};
  const std::array<int, 3>& t = surface.triangles()[at(spot.triangle)];
  for (std::size_t i = 0; i < 3; ++i) {
    if (t[i] == node) spot.weight[static_cast<Eigen::Index>(i)] = 1;
  }
  shapes->find(spot, footprint);
  return footprint;
}

Eigen::Matrix3d block_of(SurfaceCompliance& statics, const Footprint& footprint) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
    for (std::size_t j = 0; j < footprint.nodes.size(); ++j) {
      sum += footprint.weight[i] * footprint.weight[j] *
             statics.block(footprint.nodes[i], footprint.nodes[j]);
    }
  }
  return sum;
}

}  // namespace

NodeCompliance::NodeCompliance(const fem::Body& body, const DeformedSurface& surface,
                               SurfaceCompliance& statics, Footprints* shapes)
    : local(body.mesh().nodes.size(), std::numeric_limits<double>::quiet_NaN()),
      own(local.size(), 0.0),
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
    const Footprint footprint = footprint_at(surface, node, shapes);
    const Eigen::Matrix3d block = block_of(statics, footprint);
    own[at(node)] = n.dot(block * n);
    least[at(node)] = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly)
                          .eigenvalues()[0];
    mean += own[at(node)];
    ++nodes;
    if (!is_smooth(surface, node) || footprint.at_rim) continue;
    const std::optional<double> far = far_part(surface, statics, node, edge, plane[at(node)]);
    if (!far) continue;
    local[at(node)] = own[at(node)] - *far;
    sum += local[at(node)];
    ++found;
  }
  free = nodes;
  if (nodes > 0) mean /= static_cast<double>(nodes);
  with_mass = (shapes == nullptr ? kOfPoint : kOfMass) * mean;
  const bool coarse = shapes == nullptr ? kFewestEven * found < free : found == 0;
  if (found == 0) {
    const double young = body.materials().table().front().young_modulus_pa;
    mean_local = shapes == nullptr ? 1 / (kLocal * young * edge)
                                   : kKernel / (plane.front() * shapes->radius());
  } else {
    mean_local = sum / static_cast<double>(found);
  }
  if (coarse) unknown = (shapes == nullptr ? 1 : kStiffer) * mean_local;
}

double patch_radius(const DeformedSurface& surface, double radius) {
  return std::max(kFlat * radius, kOfPatch * mean_edge(surface));
}

Answer answer_of(bool with_mass, bool linear) {
  if (with_mass) return Answer::with_mass;
  return linear ? Answer::tabulated : Answer::repeated;
}

double own_coupling(const std::array<int, 3>& corners, const Eigen::Vector3d& weight, double s0,
                    std::span<const double> of_node) {
  double own = s0;
  if (!of_node.empty()) {
    for (std::size_t i = 0; i < 3; ++i) {
      own += weight[static_cast<Eigen::Index>(i)] * of_node[at(corners[i])];
    }
  }
  return own;
}

Eigen::Matrix3d coupling_compliance(SurfaceCompliance& statics, const std::array<int, 3>& corners,
                                    const Eigen::Vector3d& weight, double s0,
                                    std::span<const double> of_node) {
  Eigen::Matrix3d sum = own_coupling(corners, weight, s0, of_node) * Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Eigen::Matrix3d cross = statics.block(corners[i], corners[j]);
    const double of_edge =
        weight[static_cast<Eigen::Index>(i)] * weight[static_cast<Eigen::Index>(j)];
    sum += of_edge * (statics.block(corners[i], corners[i]) +
                      statics.block(corners[j], corners[j]) - cross - cross.transpose());
  }
  return sum;
}

ProbeCoupling::ProbeCoupling(const NodeCompliance& nodes, double radius, Answer answer)
    : of_node(nodes.local.size()) {
  constexpr double kTaken = 0.8;
  const double of_mass = answer == Answer::with_mass ? nodes.with_mass : 0;
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
  if (short_of.empty()) short_of.push_back(nodes.mean_local + of_mass - of_size(0));
  const auto tenth = short_of.begin() + static_cast<std::ptrdiff_t>(
                                            kOneInTen * static_cast<double>(short_of.size() - 1));
  std::ranges::nth_element(short_of, tenth);
  const double more = std::max(0.0, *tenth);
  if (radius > 0) excess = nodes.unknown > 0 ? nodes.unknown : more;
  s0 = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < of_node.size(); ++i) {
    const double local = std::isnan(nodes.local[i]) ? nodes.mean_local : nodes.local[i];
    of_node[i] = std::max(floor(i), of_size(i) + more - local);
    s0 = std::min(s0, of_node[i]);
  }
  for (double& own : of_node) own -= s0;
}

}  // namespace hvp::collision
