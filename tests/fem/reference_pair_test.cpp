#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::reference_pair_test {
namespace {

using Vector = std::vector<double>;

sparse::BlockMatrix stiffness(int cells = 4) {
  mesh::TetMesh mesh = jittered_cube(cells);
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), Material{}, floor, AnchorTreatment::removed).stiffness();
}

// To so many units of the largest entry, as words round it: some entries become zero.
sparse::BlockMatrix rounded(sparse::BlockMatrix a) {
  double largest = 0;
  for (const double entry : a.value) largest = std::max(largest, std::abs(entry));
  const double unit = largest / 2047;
  for (double& entry : a.value) entry = unit * std::round(entry / unit);
  return a;
}

// Every bit of both solutions, with a contact that comes, moves, grows and goes.
TEST(ReferencePair, GivesTheBitsThatEachSolverHasAlone) {
  const sparse::BlockMatrix a = stiffness();
  const sparse::BlockMatrix b = rounded(a);
  DirectSolver one(a), other(b), one_alone(a), other_alone(b);
  ReferencePair pair(one, other);
  const auto rows = static_cast<std::size_t>(a.rows());
  const std::vector<std::vector<int>> patches = {{}, {40}, {40}, {41}, {41, 45, 46}, {}};
  for (std::size_t frame = 0; frame < patches.size(); ++frame) {
    const Vector f = noise_vector(rows, 2 * frame);
    const Vector g = noise_vector(rows, 2 * frame + 1);
    const Eigen::Vector3d u_c(1e-3, -2e-3, 1e-4 * static_cast<double>(frame));
    Vector x(rows), y(rows), x_alone(rows), y_alone(rows);
    if (patches[frame].empty()) {
      pair.solve({f, x}, {g, y});
      one_alone.solve(f, x_alone);
      other_alone.solve(g, y_alone);
    } else {
      pair.solve_with_contact({f, x}, {g, y}, patches[frame], {&u_c, 1});
      one_alone.solve_with_contact(f, patches[frame], u_c, x_alone);
      other_alone.solve_with_contact(g, patches[frame], u_c, y_alone);
    }
    EXPECT_EQ(x, x_alone) << "frame " << frame;
    EXPECT_EQ(y, y_alone) << "frame " << frame;
    EXPECT_NE(x, y);
  }
}

TEST(ReferencePair, SolvesInPlace) {
  const sparse::BlockMatrix a = stiffness();
  DirectSolver one(a), other(rounded(a));
  ReferencePair pair(one, other);
  Vector x = noise_vector(static_cast<std::size_t>(a.rows()), 1);
  Vector y = x;
  Vector x_alone(x.size()), y_alone(y.size());
  one.solve(x, x_alone);
  other.solve(y, y_alone);
  const std::size_t before = hvp::test::allocation_count();
  pair.solve({x, x}, {y, y});
  EXPECT_EQ(hvp::test::allocation_count(), before);
  EXPECT_EQ(x, x_alone);
  EXPECT_EQ(y, y_alone);
}

// Bodies of another mesh, and of another size: one after the other.
TEST(ReferencePair, OfDifferentPatternsIsTwoSolvers) {
  const sparse::BlockMatrix a = stiffness();
  sparse::BlockMatrix diagonal;
  for (int node = 0; node < a.block_rows(); ++node) {
    diagonal.column.push_back(node);
    diagonal.row_begin.push_back(node + 1);
    for (int e = 0; e < 9; ++e) diagonal.value.push_back(e % 4 == 0 ? 3 : 0);
  }
  for (const sparse::BlockMatrix& b : {diagonal, stiffness(3)}) {
    DirectSolver one(a), other(b);
    ReferencePair pair(one, other);
    const Vector f = noise_vector(static_cast<std::size_t>(a.rows()), 1);
    const Vector g = noise_vector(static_cast<std::size_t>(b.rows()), 2);
    Vector x(f.size()), y(g.size()), x_alone(f.size()), y_alone(g.size());
    pair.solve({f, x}, {g, y});
    one.solve(f, x_alone);
    other.solve(g, y_alone);
    EXPECT_EQ(x, x_alone);
    EXPECT_EQ(y, y_alone);
  }
}

TEST(ReferencePair, RefusesASingularMatrix) {
  const sparse::BlockMatrix a = stiffness();
  sparse::BlockMatrix nothing = a;
  for (double& entry : nothing.value) entry = 0;
  DirectSolver one(a), other(nothing);
  EXPECT_THROW(ReferencePair(one, other), InputError);
  EXPECT_THROW(ReferencePair(other, one), InputError);
}

}  // namespace
}  // namespace hvp::fem::reference_pair_test
