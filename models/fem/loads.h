#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/materials.h"
#include "models/mesh/region.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// The body force of gravity: table [loads.gravity].
struct Gravity {
  // Standard gravity (CGPM 1901) along −z.
  Eigen::Vector3d acceleration = {0, 0, -9.80665};  // m/s²

  void declare(config::Visitor& v);
};

// A force at the mesh node nearest to a position; at equal distance the lower node. The position
// must not be farther from the node than the longest edge there, which is the mesh's resolution.
struct PointLoad {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // N

  void declare(config::Visitor& v);
};

// A pressure on the boundary triangles of a region; positive pushes inwards.
struct SurfacePressure {
  mesh::Region region;
  double pressure = 0;  // Pa

  void declare(config::Visitor& v);
};

// A prescribed displacement of every node of a region.
struct PrescribedDisplacement {
  mesh::Region region;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m

  void declare(config::Visitor& v);
};

// The loads on the body besides the user's: the scenario's table [loads].
struct Loads {
  std::optional<Gravity> gravity;
  std::vector<PointLoad> points;
  std::vector<SurfacePressure> pressures;
  std::vector<PrescribedDisplacement> prescribed;

  void declare(config::Visitor& v);
};

// f of thesis (3.15) over all mesh nodes, three components a node, in newtons: ∫ Hᵀf_b dV of
// gravity, ∫ H_Sᵀf_S dS of pressures, and the point loads. Throws InputError if a pressure's region
// contains no boundary triangle, a point load lies off the body, or a number is not finite.
std::vector<double> assemble_loads(const mesh::TetMesh& mesh, const Materials& materials,
                                   const Loads& loads);

// Adds the nodal forces of a pressure on the listed boundary triangles: a third of
// −p·area·normal a corner, exact for linear interpolation; of a quadratic mesh by
// quadratic_face_shares().
void add_pressure(const mesh::TetMesh& mesh, std::span<const int> triangles, double pressure_pa,
                  std::span<double> f);

int nearest_node(const mesh::TetMesh& mesh, const Eigen::Vector3d& position);

// Throws InputError with the load's key if the displacement of a point load's node is prescribed,
// or those of all nodes of a pressure's triangles: the support would take the whole force.
void expect_loads_on_free_nodes(const mesh::TetMesh& mesh, const Loads& loads,
                                const std::vector<char>& held);

}  // namespace hvp::fem
