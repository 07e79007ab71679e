// Iterative refinement with the board's solver inside: that it leads to the true solution in spite
// of the words, what the thesis' dynamic case comes to, and what it does when things go wrong.
#include "models/host/refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"
#include "models/fixed/reference_solver.h"
#include "models/host/deviation.h"
#include "models/host/frame_computation.h"
#include "models/host/reference_run.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "tests/host/hold.h"

namespace hvp::host::refinement_test {
namespace {

using stability::Flag;
using stability::Flags;

constexpr double kPeriod = 2e-3;

fixed::Settings words(fixed::Method method = fixed::Method::jacobi_pcg, int iterations = 15) {
  fixed::Settings s;
  s.method = method;
  s.iterations = iterations;
  s.displacement_range = 0.04;
  return s;
}

fem::Body cube() {
  std::vector<int> floor(16);
  for (int i = 0; i < 16; ++i) floor[static_cast<std::size_t>(i)] = i;
  return {fem::structured_box({0.06, 0.06, 0.06}, {3, 3, 3}), fem::Material{}, floor,
          fem::AnchorTreatment::removed};
}
constexpr int kTop = 1 + 4 * (1 + 4 * 3);  // mesh node in the middle of the cube's top

fem::Body sphere() {
  mesh::TetMesh mesh = mesh::generate({});
  const std::vector<int> anchored = mesh::select_nodes({}, mesh);  // the lowest 15 %
  return {std::move(mesh), fem::Material{}, anchored, fem::AnchorTreatment::removed};
}

int highest_node(const fem::Body& body) {
  const auto& nodes = body.mesh().nodes;
  const auto top = std::max_element(nodes.begin(), nodes.end(),
                                    [](const auto& a, const auto& b) { return a.z() < b.z(); });
  return body.active_index(static_cast<int>(top - nodes.begin()));
}

// A board that answers: the reference solver with the contact put into its matrix.
class Board {
 public:
  explicit Board(const FrameComputation& computation)
      : computation_(computation),
        matrix_(computation.board().matrix()),
        solver_(computation.board().settings()),
        b_(static_cast<std::size_t>(matrix_.rows())),
        x_(b_.size()) {
    solver_.load(matrix_);
  }

  void touch(int node) {
    matrix_.set_contact(node, computation_.board().diagonal_word());
    solver_.update(node);
  }
  void release(int node) {
    matrix_.restore_row(node, computation_.board().matrix().row(node));
    solver_.update(node);
  }

  // One frame, refined or not. Returns how many solves it took.
  int solve(FrameComputation& computation, const Eigen::Vector3d& u_c) {
    test::hold(computation, u_c);
    FrameMethod& method = computation.method();
    int solves = 0;
    computation.begin();
    for (; method.next(b_); ++solves) {
      const Flags flags = run();
      method.accept(x_, flags);
    }
    method.finish();
    return solves;
  }

 private:
  Flags run() { return solver_.solve({.b = b_, .x = x_}, nullptr).flags; }

  const FrameComputation& computation_;
  fixed::QuantisedMatrix matrix_;
  fixed::ReferenceSolver solver_;
  std::vector<std::int32_t> b_, x_;
};

struct Trajectory {
  double pressed = 0;
  double released = 0;
  double force = 0;  // pressed
  Flags flags;
  std::vector<double> u;  // at the end
};

// Pressed at its highest node by a tenth of 5 cm within 0.2 s, held for 0.1 s, let go for 0.2 s.
Trajectory press(const fem::Body& body, const fixed::Settings& settings, int passes,
                 const std::optional<fem::Dynamics>& dynamics) {
  std::optional<Refinement> refinement;
  if (passes > 0) refinement = Refinement{.passes = passes};
  FrameComputation c(body, fem::ContactDiagonal::average, dynamics, settings, kPeriod, refinement);
  ReferenceRun reference(body, dynamics, kPeriod, c.matrix(), c.matrix());
  Board board(c);
  const std::vector<int> contact = {highest_node(body)};
  Deviation pressed, released, force;
  Trajectory result;
  for (int n = 0; n < 250; ++n) {
    const bool touching = n < 150;
    if (n == 0) board.touch(contact[0]);
    if (n == 150) board.release(contact[0]);
    c.set_contact(touching ? contact : std::vector<int>());
    const Eigen::Vector3d u_c(0, 0, touching ? -5e-3 * std::min(1.0, (n + 1) / 100.0) : 0);
    board.solve(c, u_c);
    reference.step(c.held());
    (touching ? pressed : released).add(c.displacement(), reference.displacement());
    if (touching) {
      const Eigen::Vector3d f = c.force();
      force.add({f.data(), 3}, {reference.force().data(), 3});
    }
    if (c.refined() != nullptr) result.flags.merge(c.refined()->flags());
    c.update();
  }
  result.pressed = pressed.relative().value_or(0);
  result.released = released.relative().value_or(0);
  result.force = force.relative().value_or(0);
  result.u.assign(c.displacement().begin(), c.displacement().end());
  std::ostringstream errors;
  errors << result.pressed << " " << result.released << " " << result.force;
  testing::Test::RecordProperty(
      (dynamics ? "dynamic_" : "static_") + std::to_string(passes) + "_passes", errors.str());
  return result;
}

fem::Dynamics damped() {
  fem::Dynamics d;
  d.newmark_gamma = 0.6;
  d.newmark_beta = 0.605;
  return d;
}

// Bounds: independent computations gave 8e-3 and 7e-2, 1.9e-4 and 2.6e-3, 5e-7 and 5e-6 for one,
// two and three passes of 15 iterations, 29 and 40 % without.
TEST(Refinement, MakesTheDynamicCaseUsableWithTheThesisWords) {
  const fem::Body body = sphere();
  const Trajectory thesis = press(body, words(fixed::Method::cg, 60), 0, damped());
  EXPECT_GT(thesis.pressed, 0.1);
  EXPECT_GT(thesis.released, 0.2);

  const Trajectory one = press(body, words(), 1, damped());
  EXPECT_LT(one.pressed, 1e-2);
  EXPECT_LT(one.released, 1e-1);
  const Trajectory two = press(body, words(), 2, damped());
  EXPECT_LT(two.pressed, 1e-3);
  EXPECT_LT(two.released, 5e-3);
  EXPECT_TRUE(two.flags.empty()) << two.flags.bits();
  const Trajectory three = press(body, words(), 3, damped());
  EXPECT_LT(three.pressed, 1e-6);
  EXPECT_LT(three.released, 1e-5);
}

TEST(Refinement, WorksWithPlainCgAndWithTheScaledMatrix) {
  const fem::Body body = sphere();
  fixed::Settings cg = words(fixed::Method::cg);
  cg.static_scale = fixed::StaticScale::matrix_norm;
  fixed::Settings scaled = words();
  scaled.matrix_scaling = fixed::MatrixScaling::diagonal;
  for (const fixed::Settings& settings : {cg, scaled}) {
    const Trajectory two = press(body, settings, 2, damped());
    EXPECT_LT(two.pressed, 1e-3);
    EXPECT_LT(two.released, 5e-3);
    EXPECT_TRUE(two.flags.empty()) << two.flags.bits();
  }
}

// Independent: a static force error of 6e-3 comes to 3e-4.
TEST(Refinement, TakesTheStaticForceFromTheRoundedMatrixToTheTrueOne) {
  const fem::Body body = sphere();
  const Trajectory thesis = press(body, words(fixed::Method::jacobi_pcg, 30), 0, std::nullopt);
  const Trajectory two = press(body, words(fixed::Method::jacobi_pcg, 30), 2, std::nullopt);
  EXPECT_GT(thesis.force, 4e-3);
  EXPECT_LT(two.force, 3e-4);
  EXPECT_LT(two.pressed, 1e-3);
}

// A static cube with a load and a prescribed node, in double precision.
struct Loaded {
  Loaded() : body(cube()), contact({body.active_index(kTop)}) {
    f.resize(static_cast<std::size_t>(body.stiffness().rows()), 0.0);
    for (std::size_t i = 0; i < f.size(); i += 7) f[i] = 1e-3 * static_cast<double>(i % 5);
    const Eigen::MatrixXd k(body.stiffness().to_eigen());
    Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(f.data(), k.rows());
    const Eigen::Index at = 3 * contact[0];
    Eigen::MatrixXd a = k;
    b -= k.middleCols<3>(at) * u_c;
    a.middleCols<3>(at).setZero();
    a.middleRows<3>(at).setZero();
    a.block<3, 3>(at, at).setIdentity();
    b.segment<3>(at) = u_c;
    exact = a.llt().solve(b);
  }

  double error(std::span<const double> u) const {
    return (Eigen::Map<const Eigen::VectorXd>(u.data(), exact.size()) - exact).norm() /
           exact.norm();
  }

  fem::Body body;
  std::vector<int> contact;
  std::vector<double> f;
  Eigen::Vector3d u_c{1e-4, -2e-4, -3e-3};
  Eigen::VectorXd exact;
};

// The class by itself, with the reference solver.
class Bench {
 public:
  Bench(const Loaded& load, const Refinement& refinement, fixed::Settings settings = words())
      : load_(load),
        system_(fixed::prepare(load.body.stiffness(), settings)),
        matrix_(system_.matrix),
        forces_(load.body.stiffness()),
        refined(refinement, forces_, load.body.stiffness(), system_,
                std::vector<double>(load.f.size())) {
    settings.start = fixed::Start::zero;
    solver_.emplace(settings);
    matrix_.set_contact(load.contact[0], matrix_.mean_diagonal());
    solver_->load(matrix_);
    b.resize(load.f.size());
    x.resize(b.size());
  }

  void begin(double share = 1) {
    std::vector<double> f = load_.f;
    for (double& value : f) value *= share;
    const std::vector<Eigen::Vector3d> u(load_.contact.size(), share * load_.u_c);
    refined.begin(f, {load_.contact, u, {}, 0});
  }
  Flags solve() { return solver_->solve({.b = b, .x = x}, nullptr).flags; }
  void run(double share = 1) {
    begin(share);
    while (refined.next(b)) {
      const Flags flags = solve();
      refined.accept(x, flags);
    }
    refined.finish();
  }

 private:
  const Loaded& load_;
  fixed::System system_;
  fixed::QuantisedMatrix matrix_;
  std::optional<fixed::ReferenceSolver> solver_;
  fem::LinearForces forces_;

 public:
  RefinedSolve refined;
  std::vector<std::int32_t> b, x;
};

TEST(Refinement, EachPassGainsUntilDoublePrecisionIsReached) {
  const Loaded load;
  double before = 1;
  for (const int passes : {1, 2, 3, 4}) {
    Bench bench(load, {.passes = passes}, words(fixed::Method::jacobi_pcg, 60));
    bench.run();
    const double error = load.error(bench.refined.displacement());
    EXPECT_LT(error, before / 10) << passes << " passes";
    before = error;
  }
  Bench bench(load, {.passes = 16}, words(fixed::Method::jacobi_pcg, 60));
  bench.run();
  EXPECT_LT(load.error(bench.refined.displacement()), 1e-12);
  EXPECT_LT(bench.refined.residual(), 1e-13);
  EXPECT_TRUE(bench.refined.flags().empty()) << bench.refined.flags().bits();
}

TEST(Refinement, ContactIsWhereItIsPrescribedToTheLastBit) {
  const Loaded load;
  Bench bench(load, {});
  bench.run();
  for (int i = 0; i < 3; ++i) {
    const auto entry = static_cast<std::size_t>(3 * load.contact[0] + i);
    EXPECT_EQ(bench.refined.displacement()[entry], load.u_c[i]);
    EXPECT_EQ(bench.b[entry], 0);
  }
}

// The board is linear: a load of a thousandth has the same words, and a thousandth of the solution.
TEST(Refinement, UnitFollowsTheLoad) {
  const Loaded load;
  Bench whole(load, {});
  Bench share(load, {});
  constexpr double kShare = 0x1p-10;
  whole.run();
  share.run(kShare);
  EXPECT_EQ(whole.b, share.b);
  EXPECT_EQ(whole.x, share.x);
  for (std::size_t i = 0; i < load.f.size(); ++i) {
    EXPECT_EQ(kShare * whole.refined.displacement()[i], share.refined.displacement()[i]);
  }
}

TEST(Refinement, NothingIsSolvedWhereNothingIsLeft) {
  const Loaded load;
  Bench bench(load, {});
  bench.begin(0);
  EXPECT_FALSE(bench.refined.next(bench.b));
  bench.refined.finish();
  EXPECT_EQ(bench.refined.residual(), 0);
  EXPECT_TRUE(bench.refined.flags().empty());
}

// What `hvp explain` prices is what a frame without contact runs.
TEST(Refinement, StepsAreThoseOfAFrame) {
  const Loaded load;
  Bench bench(load, {});
  bench.refined.begin(load.f, {});
  double ran = 0;
  int solves = 0;
  while (bench.refined.next(bench.b)) {
    ran += bench.refined.next_operations();
    const Flags flags = bench.solve();
    bench.refined.accept(bench.x, flags);
    ++solves;
  }
  ran += bench.refined.next_operations() + bench.refined.finish_operations();
  double priced = 0;
  for (const Step& step : bench.refined.steps()) {
    if (step.where == Step::Where::board) {
      EXPECT_EQ(step.times, solves);
    }
    priced += step.times * step.operations;
  }
  EXPECT_EQ(priced, ran);
}

TEST(Refinement, OperationsFollowWhatWasFormed) {
  const Loaded load;
  Bench bench(load, {});
  const double rows = load.body.stiffness().rows();
  const double blocks = static_cast<double>(load.body.stiffness().blocks());
  const auto& row_begin = load.body.stiffness().row_begin;
  double contact = 0;  // two products with its columns, and the way of its nodes
  for (const int node : load.contact) {
    const auto row = static_cast<std::size_t>(node);
    contact += 36.0 * (row_begin[row + 1] - row_begin[row]) + 6;
  }
  bench.begin();
  ASSERT_TRUE(bench.refined.next(bench.b));
  EXPECT_EQ(bench.refined.next_operations(), contact + (3 + 4) * rows);
  const Flags flags = bench.solve();
  bench.refined.accept(bench.x, flags);
  ASSERT_TRUE(bench.refined.next(bench.b));
  // The increment is added first.
  EXPECT_EQ(bench.refined.next_operations(), (4 + 4) * rows + 18 * blocks + (3 + 4) * rows);
  bench.refined.accept(bench.x, flags);
  EXPECT_FALSE(bench.refined.next(bench.b));
  EXPECT_EQ(bench.refined.next_operations(), (4 + 4) * rows);
}

TEST(Refinement, ExtrapolationIsNearerThanTheLastSolutionAndThatNearerThanNothing) {
  const Loaded load;
  const auto ramp = [&load](fixed::Start start) {
    fixed::Settings settings = words(fixed::Method::jacobi_pcg, 5);
    settings.start = start;
    Bench bench(load, {.passes = 1}, settings);
    for (int n = 1; n <= 20; ++n) bench.run(n / 20.0);
    return load.error(bench.refined.displacement());
  };
  const double warm = ramp(fixed::Start::warm);
  EXPECT_LT(ramp(fixed::Start::extrapolated), warm / 2);
  EXPECT_LT(warm, ramp(fixed::Start::zero) / 2);
}

TEST(Refinement, SaturationWidensTheUnitAndIsNoFlagWhereALaterPassMakesItGood) {
  const Loaded load;
  Bench bench(load, {.passes = 8}, words(fixed::Method::jacobi_pcg, 60));
  bench.run(0.5);
  const std::int64_t before = bench.refined.widened();
  bench.begin(1);
  ASSERT_TRUE(bench.refined.next(bench.b));
  bench.solve();
  // The board clamps: a tenth of what the increment reaches is its largest word.
  for (std::int32_t& word : bench.x) word = std::clamp(word * 10, -32767, 32767);
  Flags saturated;
  saturated.raise(Flag::saturation);
  bench.refined.accept(bench.x, saturated);
  EXPECT_EQ(bench.refined.widened(), before + 1);
  while (bench.refined.next(bench.b)) {
    const Flags flags = bench.solve();
    bench.refined.accept(bench.x, flags);
  }
  bench.refined.finish();
  EXPECT_TRUE(bench.refined.flags().empty()) << bench.refined.flags().bits();
  EXPECT_LT(load.error(bench.refined.displacement()), 1e-3);
}

TEST(Refinement, ABoardThatMakesItWorseIsFlaggedAndStaysFinite) {
  const Loaded load;
  Bench bench(load, {});
  for (int n = 0; n < 200; ++n) {
    bench.begin();
    while (bench.refined.next(bench.b)) {
      const Flags flags = bench.solve();
      for (std::int32_t& word : bench.x) word = -word;
      bench.refined.accept(bench.x, flags);
    }
    bench.refined.finish();
    EXPECT_TRUE(bench.refined.flags().has(Flag::not_converged));
    EXPECT_TRUE(bench.refined.flags().has(Flag::divergence));
    for (const double u : bench.refined.displacement()) ASSERT_LE(std::abs(u), 0.04);
  }
}

TEST(Refinement, AFailedSolveLeavesTheLastSolution) {
  const Loaded load;
  Bench bench(load, {});
  bench.run(0.5);
  const std::vector<double> last(bench.refined.displacement().begin(),
                                 bench.refined.displacement().end());
  Bench undisturbed(load, {});
  undisturbed.run(0.5);

  bench.begin();
  ASSERT_TRUE(bench.refined.next(bench.b));
  const Flags flags = bench.solve();
  bench.refined.accept(bench.x, flags);
  bench.refined.abandon();
  EXPECT_TRUE(std::ranges::equal(bench.refined.displacement(), last));
  bench.run();
  undisturbed.run();
  // But for the gain, which the board's answer had taught it.
  EXPECT_LT(load.error(bench.refined.displacement()),
            2 * load.error(undisturbed.refined.displacement()));
}

}  // namespace
}  // namespace hvp::host::refinement_test
