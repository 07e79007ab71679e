#include <cmath>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/mesh/sandboxed_mesh.h"
#include "models/index.h"
#include "models/mesh/generate.h"
#include "models/mesh/quality.h"
#include "models/mesh/region.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::quadratic_mesh_test {
namespace {

using testing::euler_characteristic;
using ::testing::HasSubstr;
using testing::refusal;
using testing::volume_from_boundary;
using Shape = MeshSettings::Shape;

MeshSettings quadratic(Shape shape, int nodes) {
  return {.shape = shape, .nodes = nodes, .quadratic = true};
}

void expect_a_body_of(const TetMesh& mesh, int nodes) {
  const Quality quality = measure(mesh);
  EXPECT_LE(std::abs(static_cast<int>(quality.nodes) - nodes), nodes / 10) << nodes;
  EXPECT_EQ(quality.inverted, 0U);
  EXPECT_EQ(quality.slivers, 0U);
  ASSERT_EQ(mesh.mid_edge.size(), mesh.tetrahedra.size());
  EXPECT_EQ(euler_characteristic(mesh.boundary), 2);
  EXPECT_NEAR(volume_from_boundary(mesh), quality.volume, 1e-12 * quality.volume);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const std::array<int, 10> node = mesh.ten_nodes(e);
    for (std::size_t k = 0; k < 6; ++k) {
      const Eigen::Vector3d middle =
          0.5 * (mesh.nodes[at(node[kTetEdges[k][0]])] + mesh.nodes[at(node[kTetEdges[k][1]])]);
      EXPECT_EQ(mesh.nodes[at(node[4 + k])], middle);
    }
  }
}

TEST(QuadraticMesh, CountsAllNodes) {
  for (const int nodes : {60, 200, 500, 3000}) {
    expect_a_body_of(generate(quadratic(Shape::sphere, nodes)), nodes);
  }
  for (const int nodes : {300, 500, 3000}) {
    expect_a_body_of(generate(quadratic(Shape::box, nodes)), nodes);
  }
}

TEST(QuadraticMesh, OfAUsersSurface) {
  MeshSettings settings = quadratic(Shape::surface, 600);
  settings.surface = config::File(std::string(HVP_SURFACES) + "/bean.stl");
  expect_a_body_of(app::sandboxed_mesh(settings), 600);
}

TEST(QuadraticMesh, IsTheSameThroughTheChildProcess) {
  const MeshSettings settings = quadratic(Shape::sphere, 300);
  const TetMesh here = generate(settings);
  const TetMesh there = app::sandboxed_mesh(settings);
  EXPECT_EQ(here.nodes, there.nodes);
  EXPECT_EQ(here.mid_edge, there.mid_edge);
  EXPECT_EQ(here.boundary, there.boundary);
}

TEST(QuadraticMesh, ATetrahedronHasTenNodes) {
  EXPECT_THAT(refusal("nodes", [] { generate(quadratic(Shape::sphere, 9)); }),
              HasSubstr("9 nodes are wanted; a quadratic tetrahedron has 10"));
}

TEST(QuadraticMesh, ACountThatCannotBeReachedNamesOneThatCan) {
  const std::string text = refusal("nodes", [] { generate(quadratic(Shape::box, 14)); });
  EXPECT_THAT(text, HasSubstr("14 nodes cannot be reached within 10 %"));
  const auto at = text.find("expected ");
  ASSERT_NE(at, std::string::npos) << text;
  const int offer = std::stoi(text.substr(at + 9));
  EXPECT_NO_THROW(generate(quadratic(Shape::box, offer))) << text;
}

// A row has the nodes of all its elements: a mid-edge node those around its edge alone.
TEST(QuadraticMesh, RowsAreLonger) {
  const Quality linear = measure(generate({.shape = Shape::sphere, .nodes = 500}));
  const Quality ten = measure(generate(quadratic(Shape::sphere, 500)));
  EXPECT_GT(ten.mean_row_nonzeros, 1.4 * linear.mean_row_nonzeros);
  EXPECT_LT(ten.mean_row_nonzeros, 2.5 * linear.mean_row_nonzeros);
}

}  // namespace
}  // namespace hvp::mesh::quadratic_mesh_test
