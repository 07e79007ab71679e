#include "models/fem/locking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/direct_solver.h"
#include "models/mesh/mid_edge_nodes.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::locking_test {
namespace {

// The whole beam, all cells cut alike: the mesh of the independent computation below.
double whole_cantilever_ratio(double nu, int cells) {
  const double length = 5;
  const mesh::TetMesh mesh = structured_box({length, 1, 1}, {5 * cells, cells, cells});
  std::vector<double> share(mesh.nodes.size(), 0.0);
  for (const auto& triangle : mesh.boundary) {
    const auto& a = mesh.nodes[static_cast<std::size_t>(triangle[0])];
    const auto& b = mesh.nodes[static_cast<std::size_t>(triangle[1])];
    const auto& c = mesh.nodes[static_cast<std::size_t>(triangle[2])];
    if (std::min({a.x(), b.x(), c.x()}) < length) continue;
    for (const int node : triangle) {
      share[static_cast<std::size_t>(node)] += (b - a).cross(c - a).norm() / 6;
    }
  }
  std::vector<int> free;
  std::vector<double> f;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i].x() == 0) continue;
    free.push_back(static_cast<int>(i));
    f.insert(f.end(), {0, 0, share[i]});
  }
  std::vector<double> u(f.size());
  const Material material{.young_modulus_pa = 1, .poisson_ratio = nu};
  DirectSolver(assemble_stiffness(mesh, material).submatrix(free)).solve(f, u);
  double tip = 0;
  for (std::size_t i = 0; i < f.size(); ++i) tip += f[i] * u[i];
  const double kappa = 10 * (1 + nu) / (12 + 11 * nu);
  return tip / (4 * length * length * length + length * 2 * (1 + nu) / kappa);
}

struct Row {
  double nu;
  double two, four, eight;
};

// Tip over Timoshenko for 2, 4 and 8 cells a side, from an independent computation, to its two
// digits.
constexpr Row kPublished[] = {{0.3, 0.51, 0.78, 0.92},
                              {0.45, 0.31, 0.59, 0.82},
                              {0.49, 0.13, 0.29, 0.57},
                              {0.499, 0.05, 0.08, 0.17}};

TEST(Locking, WholeBeamReproducesTheTable) {
  for (const Row& row : kPublished) {
    EXPECT_NEAR(whole_cantilever_ratio(row.nu, 2), row.two, 0.006);
    EXPECT_NEAR(whole_cantilever_ratio(row.nu, 4), row.four, 0.006);
  }
  EXPECT_NEAR(whole_cantilever_ratio(0.49, 8), 0.57, 0.006);
}

// The quarter beam mirrors its cells at the middle planes; it is a little stiffer.
TEST(Locking, QuarterBeamAgreesWithTheTable) {
  for (const Row& row : kPublished) {
    EXPECT_NEAR(cantilever_ratio(row.nu, 2), row.two, 0.045);
    EXPECT_NEAR(cantilever_ratio(row.nu, 4), row.four, 0.045);
    EXPECT_NEAR(cantilever_ratio(row.nu, 8), row.eight, 0.045);
  }
}

TEST(Locking, IsMeasuredAboveTheLimitOnly) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.1, 0.1}, {4, 8, 8});
  EXPECT_NEAR(cells_across(mesh), 4, 1e-12);
  EXPECT_FALSE(measure_locking(mesh, Material{.poisson_ratio = 0.45}));
  const auto locking = measure_locking(mesh, Material{.poisson_ratio = 0.49});
  ASSERT_TRUE(locking);
  EXPECT_EQ(locking->cells, 4);
  EXPECT_EQ(locking->stiffness_ratio, cantilever_ratio(0.49, 4));
  EXPECT_NE(locking->sentence.find("0.25"), std::string::npos) << locking->sentence;
}

// Ten-node tetrahedra bend as Timoshenko's beam does, which is no exact solution at the clamped
// end.
TEST(Locking, QuadraticElementsHardlyLockInBending) {
  for (const Elements elements : {Elements::quadratic, Elements::mean_dilatation}) {
    EXPECT_NEAR(cantilever_ratio(0.3, 4, elements), 1, 0.02);
    EXPECT_NEAR(cantilever_ratio(0.49, 4, elements), 1, 0.06);
    EXPECT_THROW(cantilever_ratio(0.3, 8, elements), InputError);
  }
  const mesh::TetMesh mesh = mesh::with_mid_edge_nodes(jittered_box({0.05, 0.1, 0.1}, {4, 8, 8}));
  const Material material{.poisson_ratio = 0.49};
  const auto locking = measure_locking(mesh, material, Elements::quadratic);
  ASSERT_TRUE(locking);
  EXPECT_EQ(locking->stiffness_ratio, cantilever_ratio(0.49, 4, Elements::quadratic));
  EXPECT_FALSE(measure_locking(mesh, Material{.poisson_ratio = 0.45}, Elements::quadratic));
  EXPECT_FALSE(measure_locking(mesh, material, Elements::mean_dilatation));
}

TEST(Locking, FinerMeshesLockLess) {
  EXPECT_LT(cantilever_ratio(0.49, 2), cantilever_ratio(0.49, 6));
  EXPECT_LT(cantilever_ratio(0.49, 6),
            cantilever_ratio(0.49, most_locking_cells(Elements::linear)));
  EXPECT_THROW(cantilever_ratio(0.49, 3), InputError);
  EXPECT_THROW(cantilever_ratio(0.49, 0), InputError);
}

}  // namespace
}  // namespace hvp::fem::locking_test
