#include "models/host/dense_solve.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "tests/allocation_count.h"
#include "tests/host/difference.h"

namespace hvp::host::dense_solve_test {
namespace {

// A cube of 4 × 4 × 4 cells on its floor, with nodes inside.
struct Cube {
  fem::Body body{fem::structured_box({0.06, 0.06, 0.06}, {4, 4, 4}), fem::Material{}, floor(),
                 fem::AnchorTreatment::removed};
  const sparse::BlockMatrix& a = body.stiffness();
  std::size_t n = static_cast<std::size_t>(a.rows());
  std::vector<int> surface = touchable_nodes(body);

  static std::vector<int> floor() {
    std::vector<int> nodes;
    for (int i = 0; i < 25; ++i) nodes.push_back(i);
    return nodes;
  }
  std::vector<double> load() const {
    std::vector<double> f(n);
    for (std::size_t i = 0; i < n; ++i) f[i] = 1e-3 * std::sin(static_cast<double>(i));
    return f;
  }
  int inner() const {
    for (int node = 0;; ++node) {
      if (!std::ranges::binary_search(surface, node)) return node;
    }
  }
};

struct Case {
  SolvedBy by;
  Precision precision;
  double tolerance;
};

class DenseSolve : public testing::TestWithParam<Case> {
 protected:
  std::unique_ptr<HostSolve> make(std::vector<int> touchable) const {
    return make_dense_solve({GetParam().by, GetParam().precision, std::move(touchable)}, cube_.a);
  }
  Cube cube_;
};

// A box of 4 × 4 × 4 cells on its floor has 125 nodes, 27 of them inside and 25 on the floor.
TEST(TouchableNodes, AreThoseOfTheSurfaceThatMove) {
  const Cube cube;
  EXPECT_EQ(cube.surface.size(), 125U - 27U - 25U);
  EXPECT_TRUE(std::ranges::is_sorted(cube.surface));
}

// Loads on the surface and, once, inside; contact at none, two and one of the nodes.
TEST_P(DenseSolve, FindsWhatFactorsFind) {
  for (const bool all : {false, true}) {
    const auto solve = make(all ? std::vector<int>{} : cube_.surface);
    Prefactored factors(cube_.a);
    std::vector<double> f = cube_.load();
    std::vector<double> u(cube_.n);
    std::vector<double> expected(cube_.n);
    const std::vector<Eigen::Vector3d> held = {{1e-3, 0, -2e-3}, {0, 1e-3, -1e-3}};
    const std::vector<std::vector<int>> contacts = {
        {}, {cube_.surface[20], cube_.surface[40]}, {}, {cube_.surface[7]}};
    for (std::size_t frame = 0; frame < contacts.size(); ++frame) {
      const auto& contact = contacts[frame];
      const std::span<const Eigen::Vector3d> places(held.data(), contact.size());
      f[3 * static_cast<std::size_t>(cube_.surface[frame]) + 1] += 2e-3;
      if (frame == 2) f[3 * static_cast<std::size_t>(cube_.inner())] += 3e-3;
      solve->move_contact(contact);
      factors.move_contact(contact);
      solve->solve(f, places, u);
      factors.solve(f, places, expected);
      EXPECT_LT(test::difference(u, expected), GetParam().tolerance) << "frame " << frame;
    }
  }
}

TEST_P(DenseSolve, AllocatesNothingInAFrame) {
  const auto solve = make(cube_.surface);
  std::vector<double> f = cube_.load();
  std::vector<double> u(cube_.n);
  const std::vector<int> contact = {cube_.surface[20], cube_.surface[40]};
  const std::vector<Eigen::Vector3d> held(2, {1e-3, 0, 0});
  solve->move_contact(contact);
  solve->solve(f, held, u);
  const std::size_t before = hvp::test::allocation_count();
  for (const int node : cube_.surface) {
    f[3 * static_cast<std::size_t>(node)] += 1e-3;
    solve->solve(f, held, u);
  }
  EXPECT_EQ(hvp::test::allocation_count(), before);
}

// Single precision is not double precision: its error is that of its words.
TEST_P(DenseSolve, ErrsByItsPrecision) {
  const auto solve = make(cube_.surface);
  Prefactored factors(cube_.a);
  const std::vector<double> f = cube_.load();
  std::vector<double> u(cube_.n);
  std::vector<double> expected(cube_.n);
  solve->move_contact({});
  solve->solve(f, {}, u);
  factors.solve(f, {}, expected);
  const bool single = GetParam().precision == Precision::single_precision;
  EXPECT_EQ(test::difference(u, expected) > 1e-9, single);
  EXPECT_EQ(is_exact(GetParam().by, GetParam().precision), !single);
}

INSTANTIATE_TEST_SUITE_P(
    All, DenseSolve,
    testing::Values(Case{SolvedBy::inverse, Precision::double_precision, 1e-11},
                    Case{SolvedBy::inverse, Precision::single_precision, 1e-5},
                    Case{SolvedBy::superposition, Precision::double_precision, 1e-11},
                    Case{SolvedBy::superposition, Precision::single_precision, 1e-5},
                    Case{SolvedBy::condensed, Precision::double_precision, 1e-11},
                    Case{SolvedBy::condensed, Precision::single_precision, 1e-5}),
    [](const auto& test) {
      return std::string(name(test.param.by)) +
             (test.param.precision == Precision::single_precision ? "_single" : "_double");
    });

// n² entries, a multiplication and an addition each; A⁻¹, the load and the solution are moved. A
// contact of one node has 3 columns: 2·3·n to add them up and 2·9 for the small system.
TEST(DenseSolveWork, OfAnInverse) {
  const Cube cube;
  const auto n = static_cast<double>(cube.n);
  std::vector<double> u(cube.n);
  for (const bool single : {false, true}) {
    const auto solve = make_dense_solve(
        {SolvedBy::inverse, single ? Precision::single_precision : Precision::double_precision, {}},
        cube.a);
    const double entry = single ? 4 : 8;
    solve->move_contact({});
    solve->solve(cube.load(), {}, u);
    const double conversions = single ? 2 * n : 0;
    EXPECT_EQ(solve->work().operations(), 2 * n * n + conversions);
    EXPECT_EQ(single ? solve->work().dense_single : solve->work().dense, 2 * n * n);
    EXPECT_EQ(solve->work().bytes, entry * (n * n + 2 * n));
    EXPECT_EQ(solve->memory().kept, entry * n * n);
    const std::vector<int> contact = {cube.surface[3]};
    solve->move_contact(contact);
    EXPECT_EQ(solve->contact_work().operations(), 18);
    const Eigen::Vector3d held(1e-3, 0, 0);
    solve->solve(cube.load(), {&held, 1}, u);
    EXPECT_EQ(solve->work().operations(), 2 * n * n + conversions + 18 + 6 * n);
  }
}

// The loads are compared, and a column is added for each that differs from the first frame's.
TEST(DenseSolveWork, OfSuperposition) {
  const Cube cube;
  const auto n = static_cast<double>(cube.n);
  const auto s = 3 * static_cast<double>(cube.surface.size());
  const auto solve = make_dense_solve(
      {SolvedBy::superposition, Precision::double_precision, cube.surface}, cube.a);
  std::vector<double> f = cube.load();
  std::vector<double> u(cube.n);
  solve->move_contact({});
  solve->solve(f, {}, u);
  EXPECT_EQ(solve->work().operations(), n);
  f[3 * static_cast<std::size_t>(cube.surface[5])] += 1e-3;
  f[3 * static_cast<std::size_t>(cube.surface[9]) + 2] += 1e-3;
  solve->solve(f, {}, u);
  EXPECT_EQ(solve->work().operations(), n + 2 * 2 * n);
  EXPECT_EQ(solve->most_work().operations(), n + 9 * 2 * n);
  const Prefactored factors(cube.a);
  const fem::DirectSolver solver(cube.a);
  // A load inside has no column, and takes a pair of triangular solves.
  f[3 * static_cast<std::size_t>(cube.inner())] += 1e-3;
  solve->solve(f, {}, u);
  EXPECT_EQ(solve->work().triangular, triangular_work(solver).triangular);
  EXPECT_EQ(solve->memory().kept, 8 * (s * n + 4 * n));
  // Two columns were added last, and before any solve it would be a facet's nine.
  EXPECT_EQ(solve->memory().working_set, 8 * (2 + 3 + 2) * n);
  EXPECT_EQ(
      make_dense_solve({SolvedBy::superposition, Precision::double_precision, cube.surface}, cube.a)
          ->memory()
          .working_set,
      8 * (9 + 3 + 2) * n);
  EXPECT_EQ(solve->memory().set_up, factor_bytes(solver));
  EXPECT_EQ(solve->set_up_work().triangular,
            solver.factor_operations() + (s + 1) * triangular_work(solver).triangular);
}

// The interior is solved for again only where its load has changed, and after the force.
TEST(DenseSolveWork, OfACondensedBody) {
  const Cube cube;
  const auto n = static_cast<double>(cube.n);
  const auto s = 3 * static_cast<double>(cube.surface.size());
  const auto solve =
      make_dense_solve({SolvedBy::condensed, Precision::double_precision, cube.surface}, cube.a);
  std::vector<double> f = cube.load();
  std::vector<double> u(cube.n);
  solve->move_contact({});
  solve->solve(f, {}, u);
  EXPECT_GT(solve->work().triangular, 0);
  EXPECT_EQ(solve->work().operations(), solve->most_work().operations());
  f[3 * static_cast<std::size_t>(cube.surface[5])] += 1e-3;
  solve->solve(f, {}, u);
  EXPECT_EQ(solve->work().triangular, 0);
  EXPECT_EQ(solve->work().operations(), (n - s) + s + 2 * s * s);
  EXPECT_GT(solve->rest_work().triangular, 0);
}

// Of a static body the interior's loads stay, and the force waits for no triangular solve.
TEST(DenseSolveWork, OfACondensedStaticBodyIsLess) {
  const Cube cube;
  const auto n = static_cast<double>(cube.n);
  const auto s = 3 * static_cast<double>(cube.surface.size());
  const SolverChoice steady(SolvedBy::condensed, Precision::double_precision, cube.surface, false);
  const auto solve = make_dense_solve(steady, cube.a);
  EXPECT_EQ(solve->most_work().operations(), n + 2 * s * s);
  EXPECT_EQ(solve->memory().set_up, factor_bytes(fem::DirectSolver(cube.a)));
}

TEST(DenseSolveWork, AContactElsewhereIsRefused) {
  const Cube cube;
  const auto solve =
      make_dense_solve({SolvedBy::condensed, Precision::double_precision, cube.surface}, cube.a);
  const std::vector<int> inside = {cube.inner()};
  EXPECT_THROW(solve->move_contact(inside), InputError);
}

}  // namespace
}  // namespace hvp::host::dense_solve_test
