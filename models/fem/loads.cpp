#include "models/fem/loads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/quadratic_element.h"
#include "models/index.h"

namespace hvp::fem {
namespace {

void expect_finite(const Eigen::Vector3d& value, const std::string& key) {
  if (value.allFinite()) return;
  throw InputError(key, fmt::format("({}, {}, {}) is not finite", value.x(), value.y(), value.z()));
}

// The loads of bodies and their surroundings, limited so that no product exceeds double precision.
// An ultracentrifuge reaches 1e6 g; a giganewton lifts a ship; beyond a thousand million metres
// there is no part of any body.
constexpr config::Range kAcceleration = config::between(-1e7, 1e7);
constexpr config::Range kForce = config::between(-1e9, 1e9);
constexpr config::Range kPressure = config::between(-1e13, 1e13);
constexpr config::Range kPosition = config::between(-1e9, 1e9);
constexpr config::Range kDisplacement = config::between(-1e3, 1e3);

// The longest edge of all elements that have the node, m.
double longest_edge_at(const mesh::TetMesh& mesh, int node) {
  double longest = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const std::array<int, 4>& t = mesh.tetrahedra[e];
    const bool at_corner = std::find(t.begin(), t.end(), node) != t.end();
    const bool at_middle =
        mesh.quadratic() &&
        std::find(mesh.mid_edge[e].begin(), mesh.mid_edge[e].end(), node) != mesh.mid_edge[e].end();
    if (!at_corner && !at_middle) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        longest = std::max(longest, (mesh.nodes[at(t[a])] - mesh.nodes[at(t[b])]).norm());
      }
    }
  }
  return longest;
}

std::string millimetres(const Eigen::Vector3d& x) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * x.x(), 1e3 * x.y(), 1e3 * x.z());
}

}  // namespace

void Gravity::declare(config::Visitor& v) {
  v.vector(
      "acceleration", acceleration, config::Dimension::acceleration, kAcceleration,
      {.help = "acceleration of every part of the body", .source = "standard gravity, CGPM 1901"});
}

void PointLoad::declare(config::Visitor& v) {
  v.vector("position", position, config::Dimension::length, kPosition,
           {.help = "the mesh node nearest to this takes the force; no farther from it than its "
                    "elements are long, and not where the body is held",
            .required = true});
  v.vector("force", force, config::Dimension::force, kForce,
           {.help = "the force on that node", .required = true});
}

void SurfacePressure::declare(config::Visitor& v) {
  v.table("region", region, {.help = "boundary triangles with all three nodes in here are loaded"});
  v.quantity("pressure", pressure, config::Dimension::pressure, kPressure,
             {.help = "positive pushes inwards, against the surface normal", .required = true});
}

void PrescribedDisplacement::declare(config::Visitor& v) {
  v.table("region", region, {.help = "the nodes that are moved"});
  v.vector("displacement", displacement, config::Dimension::length, kDisplacement,
           {.help = "their displacement", .required = true});
}

void Loads::declare(config::Visitor& v) {
  v.effect("gravity", gravity, {"the body's own weight", "no cost: part of f"});
  v.list("point", points, {.help = "forces on single nodes"});
  v.list("pressure", pressures, {.help = "pressures on parts of the surface"});
  v.list("prescribed", prescribed, {.help = "nodes whose displacement is given"});
}

int nearest_node(const mesh::TetMesh& mesh, const Eigen::Vector3d& position) {
  int nearest = 0;
  double least = config::kInfinity;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const double distance = (mesh.nodes[i] - position).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

void expect_loads_on_free_nodes(const mesh::TetMesh& mesh, const Loads& loads,
                                const std::vector<char>& held) {
  for (std::size_t i = 0; i < loads.points.size(); ++i) {
    const int node = nearest_node(mesh, loads.points[i].position);
    if (!held[at(node)]) continue;
    throw InputError(fmt::format("point[{}].position", i),
                     fmt::format("the node that is nearest to it, at {}, is held, where a force "
                                 "moves nothing; expected a place where the body is free",
                                 millimetres(mesh.nodes[at(node)])));
  }
  for (std::size_t i = 0; i < loads.pressures.size(); ++i) {
    const std::vector<int> triangles = mesh::select_boundary(loads.pressures[i].region, mesh);
    const bool free = std::any_of(triangles.begin(), triangles.end(), [&](int triangle) {
      const auto& corners = mesh.boundary[at(triangle)];
      return std::any_of(corners.begin(), corners.end(), [&](int node) { return !held[at(node)]; });
    });
    if (free) continue;
    throw InputError(
        fmt::format("pressure[{}].region", i),
        fmt::format("all nodes of its {} boundary triangles are held, where a pressure "
                    "moves nothing; expected a region where the body is free",
                    triangles.size()));
  }
}

void add_pressure(const mesh::TetMesh& mesh, std::span<const int> triangles, double pressure_pa,
                  std::span<double> f) {
  for (const int triangle : triangles) {
    const auto& corner = mesh.boundary[at(triangle)];
    const Eigen::Vector3d& origin = mesh.nodes[at(corner[0])];
    const Eigen::Vector3d twice_area =
        (mesh.nodes[at(corner[1])] - origin).cross(mesh.nodes[at(corner[2])] - origin);
    if (mesh.quadratic()) {
      const Eigen::Vector3d force = -pressure_pa / 2 * twice_area;
      const std::array<double, 6> shares = quadratic_face_shares(at(triangle) % 4);
      const std::array<int, 6> face = quadratic_face(mesh, triangle);
      for (std::size_t a = 0; a < 6; ++a) {
        for (int r = 0; r < 3; ++r) f[3 * at(face[a]) + at(r)] += shares[a] * force[r];
      }
      continue;
    }
    const Eigen::Vector3d share = -pressure_pa / 6 * twice_area;
    for (const int node : corner) {
      for (int r = 0; r < 3; ++r) f[3 * at(node) + at(r)] += share[r];
    }
  }
}

std::vector<double> assemble_loads(const mesh::TetMesh& mesh, const Materials& materials,
                                   const Loads& loads) {
  std::vector<double> f(3 * mesh.nodes.size(), 0.0);
  if (loads.gravity) {
    expect_finite(loads.gravity->acceleration, "gravity.acceleration");
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      const double volume = element_geometry(mesh, static_cast<int>(e)).volume();
      if (mesh.quadratic()) {
        const Eigen::Vector3d weight =
            materials.of(e).density_kg_m3 * volume * loads.gravity->acceleration;
        const std::array<int, kTenNodes> node = mesh.ten_nodes(e);
        for (std::size_t a = 0; a < kTenNodes; ++a) {
          for (int r = 0; r < 3; ++r) {
            f[3 * at(node[a]) + at(r)] += quadratic_volume_share(a) * weight[r];
          }
        }
        continue;
      }
      const Eigen::Vector3d share =
          materials.of(e).density_kg_m3 * volume / 4 * loads.gravity->acceleration;
      for (const int node : mesh.tetrahedra[e]) {
        for (int r = 0; r < 3; ++r) f[3 * at(node) + at(r)] += share[r];
      }
    }
  }
  for (std::size_t i = 0; i < loads.points.size(); ++i) {
    const PointLoad& point = loads.points[i];
    expect_finite(point.position, fmt::format("point[{}].position", i));
    expect_finite(point.force, fmt::format("point[{}].force", i));
    const int node = nearest_node(mesh, point.position);
    const double distance = (mesh.nodes[at(node)] - point.position).norm();
    const double longest = longest_edge_at(mesh, node);
    if (!(distance <= longest)) {
      throw InputError(
          fmt::format("point[{}].position", i),
          fmt::format("lies off the body: the nearest node is {:.4g} mm away, at {}, and the "
                      "elements there are {:.4g} mm long; expected no more",
                      1e3 * distance, millimetres(mesh.nodes[at(node)]), 1e3 * longest));
    }
    for (int r = 0; r < 3; ++r) f[3 * at(node) + at(r)] += point.force[r];
  }
  for (std::size_t i = 0; i < loads.pressures.size(); ++i) {
    const SurfacePressure& load = loads.pressures[i];
    if (!std::isfinite(load.pressure)) {
      throw InputError(
          fmt::format("pressure[{}].pressure", i),
          fmt::format("the pressure is {} Pa; expected a finite value", load.pressure));
    }
    const std::vector<int> triangles = mesh::select_boundary(load.region, mesh);
    if (triangles.empty()) {
      throw InputError(fmt::format("pressure[{}].region", i),
                       fmt::format("the region holds none of the {} boundary triangles; expected "
                                   "at least one with all three nodes inside",
                                   mesh.boundary.size()));
    }
    add_pressure(mesh, triangles, load.pressure, f);
  }
  return f;
}

}  // namespace hvp::fem
