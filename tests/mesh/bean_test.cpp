#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "models/mesh/generate.h"
#include "models/mesh/quality.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_reader.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::bean_test {
namespace {

const std::string kBean = HVP_SURFACES "/bean.stl";

TEST(Bean, IsAboutEightyByFiftyByFortyMillimetres) {
  const Surface bean = check_surface(read_surface(kBean, 1e-3));
  Eigen::Vector3d low = bean.points.front();
  Eigen::Vector3d high = low;
  for (const auto& x : bean.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  EXPECT_TRUE((high - low).isApprox(Eigen::Vector3d(0.080, 0.049, 0.040), 0.02))
      << (high - low).transpose();
  EXPECT_EQ(bean.triangles.size(), 500U);
  EXPECT_EQ(testing::euler_characteristic(bean.triangles), 2);
}

// A point above a triangle's plane shows that the surface is not the boundary of a convex body;
// in the hollow it is millimetres above.
TEST(Bean, IsNotConvex) {
  const Surface bean = check_surface(read_surface(kBean, 1e-3));
  double deepest = 0.0;
  for (const auto& t : bean.triangles) {
    const auto x = [&](std::size_t k) { return bean.points[static_cast<std::size_t>(t[k])]; };
    const double area2 = (x(1) - x(0)).norm() * (x(2) - x(0)).norm();
    for (const auto& other : bean.points) {
      deepest = std::max(deepest, jacobian_determinant(x(0), x(1), x(2), other) / area2);
    }
  }
  EXPECT_GT(deepest, 5e-3);
}

TEST(Bean, IsMeshedTo500Nodes) {
  const TetMesh mesh =
      generate({.shape = MeshSettings::Shape::surface, .surface = config::File(kBean)});
  const Quality quality = measure(mesh);
  EXPECT_NEAR(static_cast<double>(quality.nodes), 500.0, 50.0);
  EXPECT_EQ(quality.slivers, 0U);
  EXPECT_EQ(testing::euler_characteristic(mesh.boundary), 2);
  EXPECT_NEAR(testing::volume_from_boundary(mesh), quality.volume, 1e-12 * quality.volume);
}

TEST(Bean, SaysWhoMadeIt) {
  std::ifstream file(kBean);
  std::string line;
  std::getline(file, line);
  EXPECT_NE(line.find("made for this project by scenarios/surfaces/make_bean.py"),
            std::string::npos);
}

}  // namespace
}  // namespace hvp::mesh::bean_test
