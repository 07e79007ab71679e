#include "models/fem/loads.h"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/strain.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::loads_test {
namespace {

const Material kTissue{.young_modulus_pa = 1e3, .poisson_ratio = 0.3, .density_kg_m3 = 1050};

mesh::Region half_space(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  mesh::Region region;
  region.kind = mesh::Region::Kind::half_space;
  region.point = point;
  region.normal = normal;
  return region;
}

mesh::Region everywhere() {
  mesh::Region region;
  region.kind = mesh::Region::Kind::all;
  return region;
}

struct Resultant {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
};

Resultant resultant(const mesh::TetMesh& mesh, const std::vector<double>& f) {
  Resultant sum;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Eigen::Vector3d force = Eigen::Vector3d::Map(&f[3 * i]);
    sum.force += force;
    sum.moment += mesh.nodes[i].cross(force);
  }
  return sum;
}

TEST(Loads, GravitySumsToTheWeight) {
  const mesh::TetMesh mesh = jittered_box({1, 2, 0.5}, {3, 4, 2});
  Loads loads;
  loads.gravity.emplace();
  const Resultant sum = resultant(mesh, assemble_loads(mesh, kTissue, loads));
  const Eigen::Vector3d weight(0, 0, -1050 * 9.80665);
  EXPECT_LT((sum.force - weight).norm(), 1e-12 * weight.norm());
  EXPECT_LT((sum.moment - Eigen::Vector3d(0.5, 1, 0.25).cross(weight)).norm(),
            1e-12 * weight.norm());
}

TEST(Loads, PressureOnAClosedSurfaceHasNoResultant) {
  const mesh::TetMesh mesh = jittered_box({1, 2, 0.5}, {3, 4, 2});
  Loads loads;
  loads.pressures.push_back({.region = everywhere(), .pressure = 300});
  const Resultant sum = resultant(mesh, assemble_loads(mesh, kTissue, loads));
  EXPECT_LT(sum.force.norm(), 1e-12 * 300);
  EXPECT_LT(sum.moment.norm(), 1e-12 * 300);
}

TEST(Loads, PressureOnOneFacePushesInwards) {
  const mesh::TetMesh mesh = jittered_box({1, 2, 0.5}, {3, 4, 2});
  Loads loads;
  loads.pressures.push_back({.region = half_space({0, 0, 0.5}, {0, 0, -1}), .pressure = 300});
  const Resultant sum = resultant(mesh, assemble_loads(mesh, kTissue, loads));
  const Eigen::Vector3d expected(0, 0, -300 * 2.0);
  EXPECT_LT((sum.force - expected).norm(), 1e-12 * 600);
  EXPECT_LT((sum.moment - Eigen::Vector3d(0.5, 1, 0.5).cross(expected)).norm(), 1e-12 * 600);
}

// Pressure p on all sides: σ = −p·I and a linear displacement, which the mesh reproduces. Three
// nodes are given that displacement (they are held); nothing else is.
TEST(Loads, HydrostaticPressureGivesUniformStress) {
  const mesh::TetMesh mesh = jittered_cube(3);
  const double p = 30;
  const double bulk = kTissue.lame_lambda() + 2 * kTissue.lame_mu() / 3;
  Loads loads;
  loads.pressures.push_back({.region = everywhere(), .pressure = p});
  for (const Eigen::Vector3d& corner :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
    mesh::Region point;
    point.kind = mesh::Region::Kind::sphere;
    point.centre = corner;
    point.radius = 1e-3;
    loads.prescribed.push_back({.region = point, .displacement = -p / (3 * bulk) * corner});
  }
  const Body body(mesh, kTissue, {}, AnchorTreatment::removed, loads);
  std::vector<double> u(body.load().size());
  DirectSolver(body.stiffness()).solve(body.load(), u);
  for (const ElementStress& element : element_stress(mesh, kTissue, body.expand(u))) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(element.stress[i], -p, 1e-10);
      EXPECT_NEAR(element.stress[i + 3], 0, 1e-10);
    }
  }
}

TEST(Loads, PointLoadsGoToTheNearestNode) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  Loads loads;
  loads.points.push_back({.position = {0.9, 0.1, 0.55}, .force = {1, 2, 3}});
  loads.points.push_back({.position = {1, 0, 0.5}, .force = {1, 0, 0}});
  const std::vector<double> f = assemble_loads(mesh, kTissue, loads);
  EXPECT_EQ(f[3 * 11], 2);
  EXPECT_EQ(f[3 * 11 + 1], 2);
  EXPECT_EQ(f[3 * 11 + 2], 3);
  // Equally near to all eight corners of a cell: the first.
  EXPECT_EQ(nearest_node(mesh, {0.25, 0.25, 0.25}), 0);
}

std::string key_refused(const mesh::TetMesh& mesh, const Loads& loads) {
  try {
    assemble_loads(mesh, kTissue, loads);
  } catch (const InputError& error) {
    return error.key();
  }
  return "none";
}

// Cells of 0.5: the longest edge, at every node, is a face's or the cell's diagonal.
TEST(Loads, APointLoadOffTheBodyIsRefused) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  double longest = 0;
  for (const auto& t : mesh.tetrahedra) {
    for (const int a : t) {
      for (const int b : t) {
        longest = std::max(longest, (mesh.nodes[static_cast<std::size_t>(a)] -
                                     mesh.nodes[static_cast<std::size_t>(b)])
                                        .norm());
      }
    }
  }
  Loads loads;
  loads.points.push_back({.position = {0.5, 0.5, 1}, .force = {1, 0, 0}});
  loads.points.push_back({.position = {0.5, 0.5, 1 + 0.999 * longest}, .force = {1, 0, 0}});
  EXPECT_EQ(key_refused(mesh, loads), "none");
  loads.points[1].position.z() = 1 + 1.001 * longest;
  EXPECT_EQ(key_refused(mesh, loads), "point[1].position");
  loads.points[1].position.z() = 1e300;
  EXPECT_EQ(key_refused(mesh, loads), "point[1].position");
}

// The support would take them: the body would not notice.
TEST(Loads, LoadsOnHeldNodesAloneAreRefused) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  const std::vector<int> bottom = mesh::select_nodes(half_space({0, 0, 0.1}, {0, 0, 1}), mesh);
  const auto refused = [&](const Loads& loads, AnchorTreatment treatment) -> std::string {
    try {
      const Body body(mesh, kTissue, bottom, treatment, loads);
    } catch (const InputError& error) {
      return error.key();
    }
    return "none";
  };
  for (const AnchorTreatment treatment : {AnchorTreatment::removed, AnchorTreatment::kept}) {
    Loads loads;
    loads.points.push_back({.position = {0.5, 0.5, 1}, .force = {1, 0, 0}});
    loads.pressures.push_back({.region = everywhere(), .pressure = 1});
    EXPECT_EQ(refused(loads, treatment), "none");
    loads.points.push_back({.position = {0.5, 0.5, 0.1}, .force = {1, 0, 0}});
    EXPECT_EQ(refused(loads, treatment), "point[1].position");
    loads.points.pop_back();
    loads.pressures.push_back({.region = half_space({0, 0, 0}, {0, 0, 1}), .pressure = 1});
    EXPECT_EQ(refused(loads, treatment), "pressure[1].region");
    loads.pressures.pop_back();
    // What is moved on purpose is held as well.
    loads.prescribed.push_back(
        {.region = half_space({0, 0, 0.9}, {0, 0, -1}), .displacement = {0, 0, -0.1}});
    EXPECT_EQ(refused(loads, treatment), "point[0].position");
  }
}

TEST(Loads, RefusesRegionsThatHoldNothing) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  Loads loads;
  loads.pressures.push_back({.region = half_space({0, 0, 2}, {0, 0, -1}), .pressure = 1});
  try {
    assemble_loads(mesh, kTissue, loads);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "pressure[0].region");
  }
  loads = {};
  loads.points.push_back({.position = {0, 0, 0}, .force = {std::nan(""), 0, 0}});
  EXPECT_THROW(assemble_loads(mesh, kTissue, loads), InputError);
}

}  // namespace
}  // namespace hvp::fem::loads_test
