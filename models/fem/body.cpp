#include "models/fem/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/index.h"

namespace hvp::fem {
namespace {

// The connected parts of the mesh: a part's number for every node, by its lowest node.
std::vector<int> parts_of(const mesh::TetMesh& mesh) {
  std::vector<int> parent(mesh.nodes.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int i) {
    while (parent[at(i)] != i) {
      parent[at(i)] = parent[at(parent[at(i)])];
      i = parent[at(i)];
    }
    return i;
  };
  const auto join = [&](int one, int other) {
    const int x = root(one);
    const int y = root(other);
    parent[at(std::max(x, y))] = std::min(x, y);
  };
  for (const auto& tet : mesh.tetrahedra) {
    for (std::size_t a = 1; a < 4; ++a) join(tet[0], tet[a]);
  }
  for (std::size_t e = 0; e < mesh.mid_edge.size(); ++e) {
    for (const int node : mesh.mid_edge[e]) join(mesh.tetrahedra[e][0], node);
  }
  for (int i = 0; i < static_cast<int>(parent.size()); ++i) parent[at(i)] = root(i);
  return parent;
}

void expect_no_rigid_body_modes(const mesh::TetMesh& mesh, const std::vector<char>& held) {
  const std::vector<int> part = parts_of(mesh);
  std::vector<std::vector<int>> held_in_part(mesh.nodes.size());
  int parts = 0;
  for (int i = 0; i < static_cast<int>(part.size()); ++i) {
    if (part[at(i)] == i) ++parts;
    if (held[at(i)]) held_in_part[at(part[at(i)])].push_back(i);
  }
  for (int i = 0; i < static_cast<int>(part.size()); ++i) {
    if (part[at(i)] != i) continue;
    const std::vector<int>& nodes = held_in_part[at(i)];
    const int modes = remaining_rigid_body_modes(mesh, nodes);
    if (modes == 0) continue;
    const std::string where =
        parts == 1 ? "the body"
                   : fmt::format("the part of the body with node {} (one of {} parts)", i, parts);
    const std::string what = nodes.empty() ? "no anchored node"
                             : nodes.size() == 1
                                 ? "one anchored node"
                                 : fmt::format("{} anchored nodes on one line", nodes.size());
    throw InputError("anchor",
                     fmt::format("{} has {} and keeps {} rigid-body mode{}: nothing holds it; "
                                 "expected at least three anchored nodes that are not on one line",
                                 where, what, modes, modes == 1 ? "" : "s"));
  }
}

}  // namespace

const std::vector<std::pair<std::string_view, AnchorTreatment>>& anchor_treatment_names() {
  static const std::vector<std::pair<std::string_view, AnchorTreatment>> names = {
      {"removed", AnchorTreatment::removed}, {"kept", AnchorTreatment::kept}};
  return names;
}

int remaining_rigid_body_modes(const mesh::TetMesh& mesh, std::span<const int> held_nodes) {
  if (held_nodes.empty()) return 6;
  const Eigen::Vector3d& origin = mesh.nodes[at(held_nodes[0])];
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const int node : held_nodes) {
    const Eigen::Vector3d arm = mesh.nodes[at(node)] - origin;
    if (arm.squaredNorm() > farthest.squaredNorm()) farthest = arm;
  }
  if (farthest.squaredNorm() == 0) return 3;
  double widest = 0;
  for (const int node : held_nodes) {
    const Eigen::Vector3d arm = mesh.nodes[at(node)] - origin;
    widest = std::max(widest, arm.cross(farthest).norm());
  }
  // A distance from the line below 1e-6 of its length would leave a hinge that double precision
  // cannot tell from a free one.
  return widest > 1e-6 * farthest.squaredNorm() ? 0 : 1;
}

Body::Body(mesh::TetMesh mesh, const Materials& materials, std::span<const int> anchored,
           AnchorTreatment treatment, const Loads& loads, Elements elements)
    : mesh_(std::move(mesh)), materials_(materials), treatment_(treatment), elements_(elements) {
  if (mesh_.quadratic() != (elements != Elements::linear)) {
    throw std::invalid_argument(
        "quadratic elements need a mesh with mid-edge nodes, linear ones "
        "a mesh without");
  }
  const sparse::BlockMatrix full_stiffness =
      mesh_.quadratic() ? assemble_quadratic_stiffness(mesh_, materials_, elements)
                        : assemble_stiffness(mesh_, materials_);
  const std::vector<double> full_load = assemble_loads(mesh_, materials_, loads);
  hold(anchored, loads);
  expect_loads_on_free_nodes(mesh_, loads, held_);
  expect_no_rigid_body_modes(mesh_, held_);
  if (std::find(held_.begin(), held_.end(), 0) == held_.end()) {
    throw InputError("anchor", fmt::format("all {} nodes are held; expected some that can move",
                                           mesh_.nodes.size()));
  }
  active_of_node_.assign(mesh_.nodes.size(), -1);
  for (int i = 0; i < static_cast<int>(mesh_.nodes.size()); ++i) {
    if (treatment_ == AnchorTreatment::removed && held(i)) continue;
    active_of_node_[at(i)] = active_nodes();
    node_of_active_.push_back(i);
  }
  stiffness_ = reduce(full_stiffness);
  move_prescribed_to_load(full_stiffness, full_load);
}

const Material& Body::material() const {
  if (materials_.count() > 1) throw std::logic_error("a body of several materials");
  return materials_.table().front();
}

void Body::hold(std::span<const int> anchored, const Loads& loads) {
  held_.assign(mesh_.nodes.size(), 0);
  held_displacement_.assign(3 * mesh_.nodes.size(), 0.0);
  anchored_.assign(anchored.begin(), anchored.end());
  for (const int node : anchored_) {
    if (node < 0 || at(node) >= mesh_.nodes.size()) {
      throw InputError(
          fmt::format("anchored node {} is not in the mesh of {} nodes", node, mesh_.nodes.size()));
    }
    held_[at(node)] = 1;
  }
  std::vector<int> source(mesh_.nodes.size(), -1);
  for (std::size_t i = 0; i < loads.prescribed.size(); ++i) {
    const PrescribedDisplacement& prescribed = loads.prescribed[i];
    const std::string key = fmt::format("prescribed[{}].region", i);
    if (!prescribed.displacement.allFinite()) {
      throw InputError(fmt::format("prescribed[{}].displacement", i),
                       "the displacement is not finite");
    }
    const std::vector<int> nodes = mesh::select_nodes(prescribed.region, mesh_);
    if (nodes.empty()) {
      throw InputError(key, fmt::format("the region holds none of the {} nodes; expected at least "
                                        "one",
                                        mesh_.nodes.size()));
    }
    for (const int node : nodes) {
      double* displacement = &held_displacement_[3 * at(node)];
      const int earlier = source[at(node)];
      if (held_[at(node)] && earlier < 0) {
        throw InputError(key, fmt::format("node {} is anchored and has a prescribed displacement; "
                                          "expected regions that do not overlap",
                                          node));
      }
      if (earlier >= 0 &&
          !std::equal(displacement, displacement + 3, prescribed.displacement.data())) {
        throw InputError(key, fmt::format("node {} is prescribed two different displacements, "
                                          "here and in prescribed[{}]",
                                          node, earlier));
      }
      held_[at(node)] = 1;
      source[at(node)] = static_cast<int>(i);
      std::copy_n(prescribed.displacement.data(), 3, displacement);
    }
  }
}

sparse::BlockMatrix Body::reduce(const sparse::BlockMatrix& full) const {
  if (treatment_ == AnchorTreatment::removed) return full.submatrix(node_of_active_);
  double sum = 0;
  double entries = 0;
  for (int i = 0; i < full.block_rows(); ++i) {
    if (held(i)) continue;
    const double* block = full.block(static_cast<std::size_t>(full.find(i, i)));
    sum += block[0] + block[4] + block[8];
    entries += 3;
  }
  const double mean = sum / entries;
  sparse::BlockMatrix result = full;
  for (int i = 0; i < result.block_rows(); ++i) {
    for (int k = result.row_begin[at(i)]; k < result.row_begin[at(i) + 1]; ++k) {
      const int j = result.column[at(k)];
      if (!held(i) && !held(j)) continue;
      double* block = result.block(at(k));
      std::fill_n(block, 9, 0.0);
      if (i == j) block[0] = block[4] = block[8] = mean;
    }
  }
  return result;
}

void Body::move_prescribed_to_load(const sparse::BlockMatrix& full_stiffness,
                                   std::span<const double> full_load) {
  std::vector<double> elastic(held_displacement_.size());
  full_stiffness.multiply(held_displacement_, elastic);
  load_.assign(at(stiffness_.rows()), 0.0);
  dead_load_ = load_;
  for (int a = 0; a < active_nodes(); ++a) {
    const std::size_t node = at(node_of_active_[at(a)]);
    for (std::size_t r = 0; r < 3; ++r) {
      double& f = load_[3 * at(a) + r];
      if (held_[node]) {
        const double diagonal =
            stiffness_.block(static_cast<std::size_t>(stiffness_.find(a, a)))[0];
        f = diagonal * held_displacement_[3 * node + r];
        dead_load_[3 * at(a) + r] = f;
      } else {
        f = full_load[3 * node + r] - elastic[3 * node + r];
        dead_load_[3 * at(a) + r] = full_load[3 * node + r];
      }
    }
  }
}

sparse::BlockMatrix Body::mass(MassKind kind) const {
  return reduce(mesh_.quadratic() ? assemble_quadratic_mass(mesh_, materials_, kind)
                                  : assemble_mass(mesh_, materials_, kind));
}

std::vector<double> Body::initial_displacement() const {
  std::vector<double> u(load_.size());
  for (std::size_t a = 0; a < node_of_active_.size(); ++a) {
    std::copy_n(&held_displacement_[3 * at(node_of_active_[a])], 3, &u[3 * a]);
  }
  return u;
}

void Body::expand(std::span<const double> u_active, std::span<double> u_full) const {
  assert(u_active.size() == load_.size() && u_full.size() == held_displacement_.size());
  std::copy(held_displacement_.begin(), held_displacement_.end(), u_full.begin());
  for (std::size_t a = 0; a < node_of_active_.size(); ++a) {
    const std::size_t node = at(node_of_active_[a]);
    if (!held_[node]) std::copy_n(&u_active[3 * a], 3, &u_full[3 * node]);
  }
}

std::vector<double> Body::expand(std::span<const double> u_active) const {
  std::vector<double> u_full(held_displacement_.size());
  expand(u_active, u_full);
  return u_full;
}

}  // namespace hvp::fem
