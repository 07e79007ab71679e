// How often triangles turn around a point, against the solid angle of what is missing.
#include "models/mesh/winding_number.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "models/mesh/parametric_surface.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::winding_number_test {
namespace {

using Eigen::Vector3d;

// What groups that count as dipoles may err by: some hundredths, as the header has it.
constexpr double kDipoles = 0.05;

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const Surface ball = sphere_surface(1, 2000);
  const WindingNumber turns(ball);
  for (const double r : {0.0, 0.3, 0.7, 0.9, 1.1, 1.5, 4.0}) {
    for (const Vector3d& direction :
         {Vector3d(1, 0, 0), Vector3d(0.6, 0, 0.8), Vector3d(-0.48, 0.6, 0.64)}) {
      EXPECT_NEAR(turns.at_point(r * direction), r < 1 ? 1 : 0, kDipoles) << r;
    }
  }
  const Surface inwards = testing::turned_inside_out(ball);
  EXPECT_NEAR(WindingNumber(inwards).at_point({0.1, 0, 0}), -1, kDipoles);
  EXPECT_EQ(WindingNumber({}).at_point({0, 0, 0}), 0);
}

// A dozen triangles are near each other: none counts as a dipole.
TEST(WindingNumber, OfFewTrianglesIsExact) {
  const Surface cube = testing::unit_cube();
  const WindingNumber turns(cube);
  EXPECT_NEAR(turns.at_point({0.3, 0.2, 0.9}), 1, 1e-12);
  EXPECT_NEAR(turns.at_point({1.1, 0.2, 0.9}), 0, 1e-12);
  Surface open = cube;
  std::erase_if(open.triangles, [&](const auto& t) {
    return open.points[static_cast<std::size_t>(t[0])].z() == 1 &&
           open.points[static_cast<std::size_t>(t[1])].z() == 1 &&
           open.points[static_cast<std::size_t>(t[2])].z() == 1;
  });
  ASSERT_EQ(open.triangles.size(), 10U);
  // From the middle each side is a sixth; two bodies that overlap are turned around twice.
  EXPECT_NEAR(WindingNumber(open).at_point({0.5, 0.5, 0.5}), 5.0 / 6, 1e-12);
  const Surface twice = testing::together(cube, testing::moved(cube, {0.5, 0, 0}));
  EXPECT_NEAR(WindingNumber(twice).at_point({0.7, 0.3, 0.4}), 2, kDipoles);
}

}  // namespace
}  // namespace hvp::mesh::winding_number_test
