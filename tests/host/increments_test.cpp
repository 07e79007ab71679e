#include "models/host/increments.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "models/index.h"

namespace hvp::host::increments_test {
namespace {

// A body that has no forces where a displacement is beyond a limit, and elsewhere those of a
// multiple of K·u.
class Brittle final : public fem::InternalForces {
 public:
  Brittle(const sparse::BlockMatrix& k, double limit, double times)
      : k_(k), limit_(limit), times_(times) {}

  bool linear() const override { return false; }
  fem::ElementsFound evaluate(std::span<const double> u, std::span<double> q) override {
    k_.multiply(u, q);
    for (double& force : q) force *= times_;
    const auto beyond = [this](double x) { return std::abs(x) > limit_; };
    const auto broken = static_cast<int>(std::ranges::count_if(u, beyond));
    return {broken, broken};
  }
  fem::ElementsFound follow(std::span<const int> /*nodes*/,
                            std::span<const Eigen::Vector3d> /*moved*/, std::span<const double> u,
                            std::span<double> q) override {
    return evaluate(u, q);
  }
  double evaluate_operations() const override { return 1; }
  double follow_operations() const override { return 1; }

 private:
  const sparse::BlockMatrix& k_;
  double limit_;
  double times_;
};

fem::Body cube() {
  mesh::TetMesh mesh = fem::structured_box({0.02, 0.02, 0.02}, {2, 2, 2});
  std::vector<int> clamped;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) clamped.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), {}, clamped, fem::AnchorTreatment::removed);
}

struct Bench {
  explicit Bench(fixed::Start start = fixed::Start::warm, double times = 0)
      : body(cube()),
        forces(body.stiffness(), 1e-3, times),
        increments(forces, body.stiffness(), body.initial_displacement(), start, 1e-3, 1),
        load(body.load()) {}

  // One frame: the contact at a depth, and an increment of all other nodes.
  bool frame(double depth, double increment, int passes = 1) {
    const std::vector<int> nodes = {top};
    const std::vector<Eigen::Vector3d> displacement = {{0, 0, -depth}};
    increments.begin(load, {.nodes = nodes, .displacement = displacement, .let_go = {}});
    made = 0;
    for (; made < passes && increments.form_residual(); ++made) {
      evaluated = increments.evaluate_operations();
      const std::span<double> u = increments.change();
      for (std::size_t i = 0; i < u.size(); ++i) {
        if (i / 3 != at(top)) u[i] += increment;
      }
    }
    return increments.finish(1e9);
  }
  double at_contact() const { return increments.displacement()[3 * at(top) + 2]; }
  double elsewhere() const { return increments.displacement()[0]; }

  fem::Body body;
  Brittle forces;
  Increments increments;
  std::vector<double> load;
  int top = 13;
  int made = 0;
  double evaluated = 0;  // operations of the last pass' evaluations, one each
};

TEST(Increments, GoOnFromTheLastSolution) {
  Bench bench;
  EXPECT_TRUE(bench.frame(1e-4, 1e-5));
  EXPECT_TRUE(bench.frame(2e-4, 1e-5, 3));
  EXPECT_EQ(bench.made, 3);
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 4e-5);
  EXPECT_EQ(bench.at_contact(), -2e-4);
  EXPECT_EQ(bench.increments.inverted(), 0);
}

// The contact alone leads where there are no forces: the frame keeps the last solution, and the
// next one tries again.
TEST(Increments, KeepTheLastSolutionWithoutAStart) {
  Bench bench;
  bench.frame(1e-4, 1e-5);
  EXPECT_FALSE(bench.frame(2e-3, 1e-5));
  EXPECT_EQ(bench.made, 0);
  EXPECT_EQ(bench.at_contact(), -1e-4);
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 1e-5);
  EXPECT_EQ(bench.increments.inverted(), 1);
  EXPECT_TRUE(bench.frame(3e-4, 1e-5));
  EXPECT_EQ(bench.at_contact(), -3e-4);
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 2e-5);
}

// An increment that leads there even halved and halved again is taken back, whether there is
// another pass or not; what the frame had reached before it stays.
TEST(Increments, TakeOneBackThatLeadsNowhere) {
  for (const int passes : {1, 2, 3}) {
    Bench bench;
    bench.frame(1e-4, 1e-5);
    EXPECT_FALSE(bench.frame(2e-4, 2e-2, passes));
    EXPECT_EQ(bench.made, 1);
    EXPECT_EQ(bench.at_contact(), -2e-4);
    EXPECT_DOUBLE_EQ(bench.elsewhere(), 1e-5);
    EXPECT_GT(bench.increments.inverted(), 0);
    EXPECT_TRUE(bench.frame(3e-4, 0));
    EXPECT_EQ(bench.increments.inverted(), 0);
  }
}

TEST(Increments, HalveOneThatLeadsTooFar) {
  Bench bench;
  bench.frame(1e-4, 1e-5);
  EXPECT_FALSE(bench.frame(2e-4, 1.9e-3, 2));
  EXPECT_EQ(bench.made, 2);
  // The first one's half; the second one, which no pass follows, is taken back.
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 1e-5 + 0.95e-3);
}

TEST(Increments, HalveOneAfterWhichTheResidualHasGrown) {
  Bench bench(fixed::Start::warm, 1);
  EXPECT_TRUE(bench.frame(1e-4, 1e-4, 2));
  EXPECT_EQ(bench.made, 2);
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 1e-4 / 8 + 1e-4);
  EXPECT_TRUE(bench.increments.diverged() || bench.increments.remaining() > 0);
  EXPECT_EQ(bench.evaluated, 1 + 3);
}

// Forces of a million times the load are on their way out of double precision, and count as none.
TEST(Increments, HaveNoStartWhereForcesAreBeyondAllBounds) {
  Bench bench(fixed::Start::warm, 1e6);
  EXPECT_FALSE(bench.frame(1e-4, 0));
  EXPECT_EQ(bench.made, 0);
  EXPECT_EQ(bench.at_contact(), 0);
  EXPECT_TRUE(std::isfinite(bench.increments.remaining()));
}

// The extrapolated place has no forces, the last solution has.
TEST(Increments, StartAtTheSolutionWhereItsExtrapolationLeadsNowhere) {
  Bench bench(fixed::Start::extrapolated);
  bench.frame(1e-4, 0);
  bench.frame(1e-4, 7e-4);
  EXPECT_TRUE(bench.frame(1e-4, 0));
  EXPECT_EQ(bench.made, 1);
  EXPECT_DOUBLE_EQ(bench.elsewhere(), 7e-4);
  EXPECT_GT(bench.increments.inverted(), 0);
}

TEST(Increments, AreGivenUpWhereTheSolveFailed) {
  Bench bench;
  bench.frame(1e-4, 1e-5);
  const std::vector<int> nodes = {bench.top};
  const std::vector<Eigen::Vector3d> displacement = {{0, 0, -5e-4}};
  bench.increments.begin(bench.load, {.nodes = nodes, .displacement = displacement, .let_go = {}});
  EXPECT_TRUE(bench.increments.form_residual());
  bench.increments.abandon();
  EXPECT_EQ(bench.at_contact(), -1e-4);
}

}  // namespace
}  // namespace hvp::host::increments_test
