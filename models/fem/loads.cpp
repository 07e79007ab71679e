#include "models/fem/loads.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/element.h"

namespace hvp::fem {
namespace {

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void expect_finite(const Eigen::Vector3d& value, const std::string& key) {
  if (value.allFinite()) return;
  throw InputError(key, fmt::format("({}, {}, {}) is not finite", value.x(), value.y(), value.z()));
}

}  // namespace

void Gravity::declare(config::Visitor& v) {
  v.vector(
      "acceleration", acceleration, config::Dimension::acceleration, {},
      {.help = "acceleration of every part of the body", .source = "standard gravity, CGPM 1901"});
}

void PointLoad::declare(config::Visitor& v) {
  v.vector("position", position, config::Dimension::length, {},
           {.help = "the mesh node nearest to this takes the force", .required = true});
  v.vector("force", force, config::Dimension::force, {},
           {.help = "the force on that node", .required = true});
}

void SurfacePressure::declare(config::Visitor& v) {
  v.table("region", region, {.help = "boundary triangles with all three nodes in here are loaded"});
  v.quantity("pressure", pressure, config::Dimension::pressure, {},
             {.help = "positive pushes inwards, against the surface normal", .required = true});
}

void PrescribedDisplacement::declare(config::Visitor& v) {
  v.table("region", region, {.help = "the nodes that are moved"});
  v.vector("displacement", displacement, config::Dimension::length, {},
           {.help = "their displacement", .required = true});
}

void Loads::declare(config::Visitor& v) {
  v.effect("gravity", gravity, {.help = "the body's own weight"});
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

void add_pressure(const mesh::TetMesh& mesh, std::span<const int> triangles, double pressure_pa,
                  std::span<double> f) {
  for (const int triangle : triangles) {
    const auto& corner = mesh.boundary[index(triangle)];
    const Eigen::Vector3d& origin = mesh.nodes[index(corner[0])];
    const Eigen::Vector3d twice_area =
        (mesh.nodes[index(corner[1])] - origin).cross(mesh.nodes[index(corner[2])] - origin);
    const Eigen::Vector3d share = -pressure_pa / 6 * twice_area;
    for (const int node : corner) {
      for (int r = 0; r < 3; ++r) f[3 * index(node) + index(r)] += share[r];
    }
  }
}

std::vector<double> assemble_loads(const mesh::TetMesh& mesh, const Material& material,
                                   const Loads& loads) {
  std::vector<double> f(3 * mesh.nodes.size(), 0.0);
  if (loads.gravity) {
    expect_finite(loads.gravity->acceleration, "gravity.acceleration");
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      const double volume = element_geometry(mesh, static_cast<int>(e)).volume();
      const Eigen::Vector3d share =
          material.density_kg_m3 * volume / 4 * loads.gravity->acceleration;
      for (const int node : mesh.tetrahedra[e]) {
        for (int r = 0; r < 3; ++r) f[3 * index(node) + index(r)] += share[r];
      }
    }
  }
  for (std::size_t i = 0; i < loads.points.size(); ++i) {
    const PointLoad& point = loads.points[i];
    expect_finite(point.position, fmt::format("point[{}].position", i));
    expect_finite(point.force, fmt::format("point[{}].force", i));
    const int node = nearest_node(mesh, point.position);
    for (int r = 0; r < 3; ++r) f[3 * index(node) + index(r)] += point.force[r];
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
