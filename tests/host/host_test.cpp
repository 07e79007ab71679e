#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/structured_box.h"
#include "models/fixed/reference_solver.h"
#include "models/host/costs.h"
#include "models/host/deviation.h"
#include "models/host/frame_computation.h"
#include "models/host/reference_run.h"
#include "tests/host/hold.h"

namespace hvp::host::host_test {
namespace {

// A cube of 6 cm on its floor, 48 active nodes; a node in the middle of its top is touched.
class Cube {
 public:
  Cube()
      : body(fem::structured_box({0.06, 0.06, 0.06}, {3, 3, 3}), fem::Material{}, floor(),
             fem::AnchorTreatment::removed) {}

  static std::vector<int> floor() {
    std::vector<int> nodes(16);
    for (int i = 0; i < 16; ++i) nodes[static_cast<std::size_t>(i)] = i;
    return nodes;
  }
  std::vector<int> touched() const { return {body.active_index(1 + 4 * (1 + 4 * 3))}; }

  fem::Body body;
};

constexpr double kPeriod = 2e-3;
const Eigen::Vector3d kPress(1e-4, -2e-4, -3e-3);

fem::Dynamics damped() {
  fem::Dynamics d;
  d.newmark_gamma = 0.6;
  d.newmark_beta = 0.605;
  return d;
}

Eigen::VectorXd vector(std::span<const double> v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

// What an exact solver would answer to the words that the host sends.
std::vector<std::int32_t> exact_answer(const FrameComputation& c, std::span<const std::int32_t> b,
                                       const fixed::Settings& settings) {
  fixed::QuantisedMatrix a = c.board().matrix();
  for (const int node : c.contact()) a.set_contact(node, c.board().diagonal_word());
  const double shift = std::ldexp(1.0, settings.rhs_shift());
  Eigen::VectorXd rhs(static_cast<Eigen::Index>(b.size()));
  for (std::size_t i = 0; i < b.size(); ++i) rhs[static_cast<Eigen::Index>(i)] = b[i] * shift;
  const Eigen::MatrixXd dense = Eigen::MatrixXd(fixed::dequantise(a).to_eigen()) / a.scale;
  const Eigen::VectorXd x = dense.llt().solve(rhs);
  std::vector<std::int32_t> words;
  for (const double word : x) words.push_back(static_cast<std::int32_t>(std::lround(word)));
  return words;
}

TEST(FrameComputation, ExactSolutionOfItsWordsPutsTheContactWhereItIsPrescribed) {
  const Cube cube;
  fixed::Settings scaled;
  scaled.matrix_scaling = fixed::MatrixScaling::diagonal;
  scaled.static_scale = fixed::StaticScale::matrix_norm;
  const std::vector<std::pair<fem::ContactDiagonal, fixed::Settings>> variants = {
      {fem::ContactDiagonal::one, {}},
      {fem::ContactDiagonal::average, {}},
      {fem::ContactDiagonal::average, scaled}};
  for (const auto& [diagonal, wanted] : variants) {
    FrameComputation c(cube.body, diagonal, std::nullopt, wanted, kPeriod);
    const fixed::Settings& settings = c.board().settings();
    c.set_contact(cube.touched());
    std::vector<std::int32_t> b(c.displacement().size());
    test::hold(c, kPress);
    EXPECT_EQ(test::form_rhs(c, b), 0);
    test::accept(c, exact_answer(c, b, settings));
    const auto first = static_cast<std::size_t>(3 * cube.touched()[0]);
    // b of the contact rows is one word of 2^m units over the diagonal: that is its resolution.
    const double step = c.board().scaling().displacement_unit() *
                        std::ldexp(1.0, settings.rhs_shift()) / c.board().diagonal_word();
    for (int i = 0; i < 3; ++i) {
      const std::size_t entry = first + static_cast<std::size_t>(i);
      EXPECT_NEAR(c.displacement()[entry], kPress[i], c.board().words().scale[entry] * step);
    }
  }
}

TEST(FrameComputation, ForceOfAStaticFrameIsTheTrueStiffnessTimesTheSolution) {
  const Cube cube;
  const fixed::Settings settings;
  FrameComputation c(cube.body, fem::ContactDiagonal::average, std::nullopt, settings, kPeriod);
  EXPECT_EQ(c.force(), Eigen::Vector3d::Zero());
  c.set_contact(cube.touched());
  std::vector<std::int32_t> b(c.displacement().size());
  test::hold(c, kPress);
  test::form_rhs(c, b);
  test::accept(c, exact_answer(c, b, settings));
  const Eigen::VectorXd f =
      Eigen::MatrixXd(cube.body.stiffness().to_eigen()) * vector(c.displacement());
  const Eigen::Vector3d expected = f.segment<3>(3 * cube.touched()[0]);
  EXPECT_NEAR((c.force() - expected).norm(), 0, 1e-12 * expected.norm());
  // The user pushes down, so the force on the body points down.
  EXPECT_LT(c.force().z(), 0);
}

TEST(FrameComputation, WordsBeyondTheRangeAreClampedAndCounted) {
  const Cube cube;
  fixed::Settings settings;
  settings.displacement_range = 1e-4;
  settings.static_shift = 6;
  FrameComputation c(cube.body, fem::ContactDiagonal::average, std::nullopt, settings, kPeriod);
  c.set_contact(cube.touched());
  std::vector<std::int32_t> b(c.displacement().size());
  test::hold(c, kPress);
  EXPECT_GT(test::form_rhs(c, b), 0);
  for (const std::int32_t word : b) EXPECT_LE(std::abs(word), 32767);
}

TEST(FrameComputation, DynamicMatrixIsNewmarksAndTheUpdateMovesItsState) {
  const Cube cube;
  const fixed::Settings settings;
  FrameComputation c(cube.body, fem::ContactDiagonal::average, damped(), settings, kPeriod);
  EXPECT_TRUE(c.dynamic());
  EXPECT_GT(c.matrix().value[0], cube.body.stiffness().value[0]);
  c.set_contact(cube.touched());
  std::vector<std::int32_t> b(c.displacement().size());
  test::hold(c, kPress);
  test::form_rhs(c, b);
  test::accept(c, exact_answer(c, b, settings));
  const std::vector<double> before(c.external_force().begin(), c.external_force().end());
  c.update();
  // A body in motion pushes on: f̂ of the next frame is not that of rest.
  EXPECT_GT((vector(c.external_force()) - vector(before)).norm(), 0);
  EXPECT_GT(c.update_operations(), 18.0 * static_cast<double>(c.matrix().blocks()));
}

TEST(ReferenceRun, StaticContactIsTheConstrainedMinimumOfTheEnergy) {
  const Cube cube;
  ReferenceRun run(cube.body, std::nullopt, kPeriod, cube.body.stiffness(), cube.body.stiffness());
  run.step({cube.touched(), std::array{kPress}, {}, 0});
  const Eigen::MatrixXd k(cube.body.stiffness().to_eigen());
  const Eigen::VectorXd residual = k * vector(run.displacement());
  const Eigen::Index at = 3 * cube.touched()[0];
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    if (i >= at && i < at + 3) continue;
    EXPECT_NEAR(residual[i], 0, 1e-10 * run.force().norm());
  }
  EXPECT_NEAR((vector(run.displacement()).segment<3>(at) - kPress).norm(), 0, 1e-12);
  EXPECT_NEAR((run.force() - residual.segment<3>(at)).norm(), 0, 1e-10 * run.force().norm());
}

TEST(ReferenceRun, OfTheRoundedMatrixIsWhatAnExactSolverMakesOfTheHostsRightHandSide) {
  const Cube cube;
  const fixed::Settings settings;
  const FrameComputation c(cube.body, fem::ContactDiagonal::average, std::nullopt, settings,
                           kPeriod);
  const sparse::BlockMatrix rounded = fixed::dequantise(c.board().matrix());
  ReferenceRun run(cube.body, std::nullopt, kPeriod, cube.body.stiffness(), rounded);
  run.step({cube.touched(), std::array{kPress}, {}, 0});

  // The host moves the true columns to the right; the board's matrix is the rounded one.
  const Eigen::MatrixXd k(cube.body.stiffness().to_eigen());
  Eigen::MatrixXd a(rounded.to_eigen());
  const Eigen::Index at = 3 * cube.touched()[0];
  Eigen::VectorXd b = -k.middleCols<3>(at) * kPress;
  a.middleCols<3>(at).setZero();
  a.middleRows<3>(at).setZero();
  a.block<3, 3>(at, at).setIdentity();
  b.segment<3>(at) = kPress;
  const Eigen::VectorXd expected = a.llt().solve(b);
  EXPECT_NEAR((vector(run.displacement()) - expected).norm(), 0, 1e-10 * expected.norm());
}

TEST(ReferenceRun, DynamicRunFollowsTheSameStepsAsTheHost) {
  const Cube cube;
  // Words so long that the host's frames are the reference's but for their last bits.
  fixed::Settings settings;
  settings.matrix_bits = 24;
  settings.vector_bits = 32;
  settings.static_shift = 22;
  FrameComputation c(cube.body, fem::ContactDiagonal::average, damped(), settings, kPeriod);
  ReferenceRun run(cube.body, damped(), kPeriod, c.matrix(), c.matrix());
  std::vector<std::int32_t> b(c.displacement().size());
  Deviation deviation;
  for (int n = 0; n < 50; ++n) {
    const bool touching = n < 30;
    c.set_contact(touching ? cube.touched() : std::vector<int>{});
    const Eigen::Vector3d u_c = kPress * std::min(1.0, n / 20.0);
    test::hold(c, u_c);
    ASSERT_EQ(test::form_rhs(c, b), 0) << "frame " << n;
    test::accept(c, exact_answer(c, b, settings));
    c.update();
    run.step(c.held());
    deviation.add(c.displacement(), run.displacement());
  }
  EXPECT_LT(*deviation.relative(), 1e-4);
  EXPECT_GT(*deviation.relative(), 0);
}

// Every bit, over frames in which a contact comes and goes.
TEST(PairedRuns, AreTheTwoRunsAlone) {
  const Cube cube;
  for (const auto& dynamics : {std::optional<fem::Dynamics>(), std::optional(damped())}) {
    const FrameComputation c(cube.body, fem::ContactDiagonal::average, dynamics, fixed::Settings{},
                             kPeriod);
    const sparse::BlockMatrix rounded = fixed::dequantise(c.board().matrix());
    ReferenceRun one(cube.body, dynamics, kPeriod, c.matrix(), c.matrix());
    ReferenceRun other(cube.body, dynamics, kPeriod, c.matrix(), rounded);
    ReferenceRun one_alone(cube.body, dynamics, kPeriod, c.matrix(), c.matrix());
    ReferenceRun other_alone(cube.body, dynamics, kPeriod, c.matrix(), rounded);
    PairedRuns both(one, other);
    for (int n = 0; n < 12; ++n) {
      const std::vector<int> contact = n < 3 || n > 8 ? std::vector<int>{} : cube.touched();
      const std::vector<Eigen::Vector3d> places(contact.size(), kPress * n);
      const fem::Hold hold{contact, places, {}, n > 3 ? kPeriod : 0};
      both.step(hold);
      one_alone.step(hold);
      other_alone.step(hold);
      EXPECT_EQ(vector(one.displacement()), vector(one_alone.displacement())) << "frame " << n;
      EXPECT_EQ(vector(other.displacement()), vector(other_alone.displacement())) << "frame " << n;
      EXPECT_EQ(one.force(), one_alone.force());
      EXPECT_EQ(other.force(), other_alone.force());
      EXPECT_EQ(one.force().norm() > 0, !contact.empty());
    }
  }
}

TEST(Deviation, IsTheMeanOverFramesOverTheLargestReference) {
  Deviation d;
  EXPECT_FALSE(d.relative());
  const std::vector<double> zero = {0, 0}, one = {3, 4}, off = {3, 4.5};
  d.add(zero, zero);
  EXPECT_FALSE(d.relative());  // nothing to compare with
  EXPECT_EQ(d.frames(), 0);
  d.add(off, one);
  d.add(one, one);
  EXPECT_DOUBLE_EQ(*d.relative(), 0.5 / 2 / 5);
  EXPECT_DOUBLE_EQ(*d.worst_relative(), 0.5 / 5);
}

// The mean of the run's largest flatters: a frame that is all wrong, but small, hardly moves it.
TEST(Deviation, OfAFramesOwnSizeCountsFramesInContactOnly) {
  Deviation d;
  EXPECT_FALSE(d.of_frame());
  const std::vector<double> large = {30, 40}, small = {0.3, 0.4}, zero = {0, 0};
  d.add(large, large, 0, true);
  EXPECT_EQ(d.of_frame()->worst, 0);
  d.add(zero, small, 1, true);   // misses all of it
  d.add(zero, large, 2, false);  // out of contact
  d.add(large, zero, 3, true);   // nothing to relate it to
  const auto of_frame = d.of_frame();
  ASSERT_TRUE(of_frame);
  EXPECT_EQ(of_frame->frames, 2);
  EXPECT_DOUBLE_EQ(of_frame->worst, 1);
  EXPECT_EQ(of_frame->worst_frame, 1);
  EXPECT_NEAR(of_frame->p95, 1, 1.0 / 64);
  EXPECT_EQ(of_frame->median, 0);
  // The other scale has them all.
  EXPECT_EQ(d.frames(), 4);
  EXPECT_DOUBLE_EQ(*d.worst_relative(), 1);
}

TEST(Deviation, OfAReferenceThatIsNotFiniteHasNoFigure) {
  Deviation d;
  const std::vector<double> one = {1, 0}, none = {1e300, 1e300};
  d.add(one, one);
  EXPECT_TRUE(d.judged());
  d.add(one, none);
  EXPECT_FALSE(d.relative());
  EXPECT_FALSE(d.worst_relative());
  EXPECT_FALSE(d.of_frame());
  EXPECT_FALSE(d.judged());
}

TEST(Deviation, IsJudgedByAThirdOfItsWorstFramesToo) {
  Deviation d;
  const std::vector<double> one = {1, 0}, off = {1.6, 0};
  for (int i = 0; i < 90; ++i) d.add(one, one);
  EXPECT_EQ(d.judged(), 0);
  for (int i = 0; i < 10; ++i) d.add(off, one);
  EXPECT_EQ(d.of_frame()->median, 0);
  EXPECT_NEAR(*d.judged(), 0.2, 0.2 / 64);
}

TEST(Host, ComputingTakesOperationsOverRateInWholePicoseconds) {
  Host h;
  h.sustained_rate_flops = 300e6;
  EXPECT_EQ(h.compute_ps(300e6), 1'000'000'000'000);
  EXPECT_EQ(h.compute_ps(1), 3'333);
  EXPECT_EQ(h.graphics.period_ps(), 30'303'030'303);
  EXPECT_EQ(conversion_operations(1500), 6000);
}

TEST(Host, DrawingGrowsWithTheSurfaceWhereATriangleHasATime) {
  Graphics g;
  EXPECT_EQ(g.drawing_ps(1000), g.drawing_ps(0)) << "without a time for them";
  g.drawing_s = 2e-3;
  g.triangle_s = 1e-6;
  EXPECT_EQ(g.drawing_ps(0), 2'000'000'000);
  EXPECT_EQ(g.drawing_ps(998), 2'998'000'000);
}

// The same operations as where they are done, and nothing of what they would make.
TEST(FrameComputation, CountedCostsTheSameAndComputesNothing) {
  const Cube cube;
  const auto make = [&](Effort effort) {
    return FrameComputation(cube.body, fem::ContactDiagonal::average, damped(), fixed::Settings{},
                            kPeriod, std::nullopt, SolvedBy::board, effort);
  };
  FrameComputation done = make(Effort::computed);
  FrameComputation counted = make(Effort::counted);
  EXPECT_FALSE(done.timing_only());
  EXPECT_TRUE(counted.timing_only());
  std::vector<std::int32_t> b(done.displacement().size(), 7);
  const std::vector<std::int32_t> untouched = b;
  for (const bool touched : {false, true}) {
    for (FrameComputation* c : {&done, &counted}) {
      if (touched) c->set_contact(cube.touched());
    }
    EXPECT_EQ(counted.force_operations(), done.force_operations());
    EXPECT_EQ(counted.update_operations(), done.update_operations());
    for (FrameComputation* c : {&done, &counted}) test::hold(*c, kPress, 2e-3);
    EXPECT_EQ(counted.hold_operations(), done.hold_operations());
    EXPECT_EQ(counted.hold_operations() > 0, touched);
    EXPECT_EQ(test::form_rhs(counted, b), 0);
    EXPECT_EQ(b, untouched);
    std::vector<std::int32_t> words(b.size());
    test::form_rhs(done, words);
    EXPECT_EQ(counted.method().next_operations(), done.method().next_operations());
    test::accept(counted, b);
    EXPECT_EQ(vector(counted.displacement()).norm(), 0);
    EXPECT_EQ(counted.force().norm(), 0);
    for (FrameComputation* c : {&done, &counted}) c->update();
    EXPECT_EQ(vector(counted.external_force()).norm(), 0);
  }
  // A frame after one with a solution, and one after a frame without.
  std::array<double, 2> operations{};
  for (double& n : operations) {
    for (FrameComputation* c : {&done, &counted}) test::hold(*c, kPress, 2e-3);
    n = done.hold_operations();
    EXPECT_EQ(counted.hold_operations(), n);
  }
  EXPECT_GT(operations[1], operations[0]);
  EXPECT_EQ(counted.board().matrix().value, done.board().matrix().value);
}

TEST(FrameComputation, CountsNothingWhoseOperationsDependOnNumbers) {
  const Cube cube;
  const auto counted = [&](const std::optional<Refinement>& refinement, SolvedBy solver) {
    return FrameComputation(cube.body, fem::ContactDiagonal::average, std::nullopt,
                            fixed::Settings{}, kPeriod, refinement, solver, Effort::counted);
  };
  EXPECT_THROW(counted(Refinement{}, SolvedBy::board), InputError);
  EXPECT_THROW(counted(std::nullopt, SolvedBy::cg), InputError);
  EXPECT_THROW(counted(std::nullopt, SolvedBy::cholesky), InputError);
}

TEST(FrameComputation, HasWordsOnlyForABoard) {
  const Cube cube;
  for (const SolvedBy solver : {SolvedBy::board, SolvedBy::cg, SolvedBy::cholesky}) {
    const FrameComputation computation(cube.body, fem::ContactDiagonal::average, std::nullopt,
                                       fixed::Settings{}, kPeriod, std::nullopt, solver);
    EXPECT_EQ(computation.has_board(), solver == SolvedBy::board) << name(solver);
    if (computation.has_board()) continue;
    EXPECT_THROW(computation.board(), std::bad_optional_access);
  }
}

}  // namespace
}  // namespace hvp::host::host_test
