// What a renewed matrix is worth in frames: a body that is pressed and dragged at nodes that follow
// the probe, solved in the board's words with one pass a frame, beside full Newton in double
// precision.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/host/frame_computation.h"
#include "models/host/word_board.h"
#include "models/tissue/model.h"
#include "tests/tissue/pressed_sphere.h"

namespace hvp::host::renewal_test {
namespace {

using tissue::LawKind;

constexpr double kPeriod = 2e-3;

fem::Dynamics undamped() {
  return {.newmark_beta = 0.605,
          .newmark_gamma = 0.6,
          .mass = fem::MassKind::lumped,
          .rayleigh_mass = 0.1,
          .rayleigh_stiffness = 0};
}

tissue::Model model_of(LawKind law) {
  tissue::Model model;
  model.kind = law;
  return model;
}

fixed::Settings words() {
  fixed::Settings settings;
  settings.method = fixed::Method::jacobi_pcg;
  settings.iterations = 120;
  settings.matrix_bits = 12;
  settings.vector_bits = 20;
  settings.displacement_range = 0.08;
  return settings;
}

struct ForceError {
  double mean = 0;
  double worst = 0;
  int frames = 0;
  stability::Flags flags;
  std::optional<RenewalCounts> renewals;
};

// Presses the sphere's cap by `depth` within 0.4 s and drags it by `way` at 25 mm/s. Errors are
// shares of the largest force.
ForceError drag(LawKind law, double depth, double way, const fem::MatrixRenewal& renewal,
                const SolverChoice& solver = SolvedBy::board) {
  const fem::Body body = tissue::thesis_sphere();
  const std::vector<int> nodes = tissue::cap(body, 0.012);
  const tissue::Model model = model_of(law);
  FrameComputation computation(tissue::make_tissue(body, model, fem::ContactDiagonal::average,
                                                   undamped(), kPeriod, Effort::computed),
                               words(), Refinement{.passes = 1}, solver, Effort::computed, renewal);
  std::optional<WordBoard> board;
  if (computation.has_board()) {
    board.emplace(computation.board().matrix(), computation.board().settings());
  }
  const std::unique_ptr<fem::ReferenceModel> truth =
      tissue::make_reference(body, model, undamped(), kPeriod, 1);
  computation.set_contact(nodes);
  if (board) board->set_contact(nodes, computation.board().diagonal_word());
  std::vector<std::int32_t> b(computation.displacement().size());
  std::vector<Eigen::Vector3d> place(nodes.size());
  std::vector<double> errors;
  ForceError result;
  double largest = 0;
  const int pressing = 200;
  const int dragging = static_cast<int>(std::lround(way / 25e-3 / kPeriod));
  for (int frame = 1; frame <= pressing + dragging; ++frame) {
    const double down = depth * std::min(1.0, static_cast<double>(frame) / pressing);
    const double along = way * std::max(0.0, static_cast<double>(frame - pressing) / dragging);
    std::ranges::fill(place, Eigen::Vector3d(along, 0, -down));
    const fem::Hold hold{nodes, place, {}, kPeriod};
    computation.hold(hold);
    computation.begin();
    while (computation.method().next(b)) {
      const fixed::Report report = board->solve(b);
      computation.method().accept(board->solution(), report.flags);
    }
    const Eigen::Vector3d force = computation.force();
    computation.method().finish();
    result.flags.merge(computation.method().flags());
    computation.update();
    if (computation.renewal_is_due()) {
      result.flags.merge(computation.renew());
      if (board) board->renew(computation.board().matrix(), computation.board().diagonal_word());
    }
    truth->step(hold);
    errors.push_back((force - truth->forces().front()).norm());
    largest = std::max(largest, truth->forces().front().norm());
  }
  for (const double error : errors) {
    result.mean += error / largest / static_cast<double>(errors.size());
    result.worst = std::max(result.worst, error / largest);
  }
  result.frames = static_cast<int>(errors.size());
  if (computation.renewals() != nullptr) result.renewals = *computation.renewals();
  return result;
}

// Pressed by 10 mm and dragged by 30 mm, with matrix words of 12 bits and one pass: the prototype's
// sphere, whose old matrix oscillates (worst error 1.0) and whose renewed one has a mean of 1.7e-3
// and a worst of 8e-3, within a factor of 1.5; but for the corotational law's mean, which is 1.7
// times as large: its warped tangent leaves out how the elements turn.
TEST(RenewedMatrix, ServesWhereTheOldOneDoesNot) {
  for (const LawKind law : {LawKind::corotational, LawKind::neo_hookean_isochoric}) {
    const ForceError renewed = drag(law, 10e-3, 30e-3, {.every = 50, .headroom = 1.25});
    const double factor = law == LawKind::corotational ? 2 : 1.5;
    EXPECT_LT(renewed.mean, factor * 1.7e-3) << static_cast<int>(law);
    EXPECT_LT(renewed.worst, 1.5 * 8e-3) << static_cast<int>(law);
    EXPECT_FALSE(renewed.flags.has(stability::Flag::divergence));
    ASSERT_TRUE(renewed.renewals);
    EXPECT_EQ(renewed.renewals->renewed, renewed.frames / 50);
    EXPECT_EQ(renewed.renewals->beyond, 0);
    // Warped blocks grow by less than a hundredth; stiffening ones by more.
    if (law == LawKind::corotational) {
      EXPECT_LT(renewed.renewals->growth, 1.01);
      EXPECT_EQ(renewed.renewals->projected, 0);
    } else {
      EXPECT_GT(renewed.renewals->growth, 1.05);
      EXPECT_LT(renewed.renewals->growth, 1.25);
      EXPECT_LT(renewed.renewals->projected, 50);  // with its inertia, hardly any
    }
  }
  EXPECT_GT(drag(LawKind::neo_hookean_isochoric, 10e-3, 30e-3, {}).worst, 0.5);
}

// The same without words: factors, an inverse at the surface, and iterations, of a matrix
// that was taken from the deformed body, are exact steps of Newton's method with the last tangent.
TEST(RenewedMatrix, ServesTheHostsOwnSolversToo) {
  constexpr LawKind kLaw = LawKind::neo_hookean_isochoric;
  const fem::MatrixRenewal renewal{.every = 50};
  const ForceError factors = drag(kLaw, 10e-3, 30e-3, renewal, SolvedBy::cholesky);
  EXPECT_LT(factors.mean, 1.7e-3);
  EXPECT_LT(factors.worst, 8e-3);
  EXPECT_FALSE(factors.flags.has(stability::Flag::divergence));
  ASSERT_TRUE(factors.renewals);
  EXPECT_EQ(factors.renewals->renewed, factors.frames / 50);
  EXPECT_EQ(factors.renewals->undefined, 0);
  EXPECT_GT(factors.renewals->growth, 1.05);
  const ForceError same = drag(kLaw, 10e-3, 30e-3, renewal, SolvedBy::condensed);
  EXPECT_NEAR(same.worst, factors.worst, 1e-9);
  EXPECT_EQ(same.renewals->renewed, factors.renewals->renewed);
  const ForceError iterated = drag(kLaw, 10e-3, 30e-3, renewal, SolvedBy::cg);
  EXPECT_NEAR(iterated.worst, factors.worst, 1e-3);
}

// More steps of the sharper tangent: twice as often is nearer.
TEST(RenewedMatrix, IsNearerWhereTheHostRenewsItMoreOften) {
  const auto error = [](int every) {
    return drag(LawKind::corotational, 5e-3, 10e-3, {.every = every}, SolvedBy::cholesky).mean;
  };
  const double never = error(0);
  const double seldom = error(40);
  const double often = error(5);
  EXPECT_LT(seldom, never);
  EXPECT_LT(often, seldom);
}

// A renewal takes what the set-up took, and the contact's columns anew.
TEST(RenewedMatrix, TakesTheHostsSetUpAnew) {
  const fem::Body body = tissue::thesis_sphere();
  FrameComputation computation(
      tissue::make_tissue(body, model_of(LawKind::corotational), fem::ContactDiagonal::average,
                          undamped(), kPeriod, Effort::computed),
      words(), Refinement{.passes = 1}, SolvedBy::cholesky, Effort::computed, {.every = 1});
  const std::vector<int> nodes = tissue::cap(body, 0.012);
  const std::vector<Eigen::Vector3d> place(nodes.size(), Eigen::Vector3d(0, 0, -1e-3));
  computation.set_contact(nodes);
  computation.hold({nodes, place, {}, kPeriod});
  computation.begin();
  computation.method().next({});
  computation.method().finish();
  computation.update();
  ASSERT_TRUE(computation.renewal_is_due());
  const std::int64_t before = computation.revision();
  EXPECT_EQ(computation.method().renew_work().operations(), 0);
  computation.renew();
  EXPECT_GT(computation.revision(), before);
  const SolveWork work = computation.method().renew_work();
  const SolveWork set_up = computation.method().set_up_work();
  const SolveWork contact = computation.method().contact_work();
  EXPECT_GT(set_up.operations(), 0);
  EXPECT_GT(contact.operations(), 0);
  EXPECT_EQ(work.operations(), set_up.operations() + contact.operations());
  EXPECT_EQ(work.bytes, set_up.bytes + contact.bytes);
  EXPECT_GT(computation.renew_operations(), 0);
}

// The sphere's cap under a hold, frame by frame.
class Frames {
 public:
  explicit Frames(int every)
      : body_(tissue::thesis_sphere()),
        nodes_(tissue::cap(body_, 0.012)),
        computation_(tissue::make_tissue(body_, model_of(LawKind::corotational),
                                         fem::ContactDiagonal::average, undamped(), kPeriod,
                                         Effort::computed),
                     words(), Refinement{.passes = 1}, SolvedBy::board, Effort::computed,
                     {.every = every}),
        board_(computation_.board().matrix(), computation_.board().settings()),
        b_(computation_.displacement().size()),
        x_(b_.size()) {}

  void touch() {
    computation_.set_contact(nodes_);
    board_.set_contact(nodes_, computation_.board().diagonal_word());
  }
  // True where the matrix is to be renewed after a frame with the cap so deep, m. `uphill`: the
  // board gives the solution's opposite, with which the residual grows.
  bool renews_after(std::optional<double> depth, bool uphill = false) {
    if (depth) place_.assign(nodes_.size(), Eigen::Vector3d(0, 0, -*depth));
    computation_.hold(depth ? fem::Hold{nodes_, place_, {}, kPeriod} : fem::Hold{});
    computation_.begin();
    while (computation_.method().next(b_)) {
      const fixed::Report report = board_.solve(b_);
      std::ranges::transform(board_.solution(), x_.begin(),
                             [&](std::int32_t x) { return uphill ? -x : x; });
      computation_.method().accept(x_, report.flags);
    }
    computation_.method().finish();
    computation_.update();
    return computation_.renewal_is_due();
  }
  stability::Flags flags() const { return computation_.method().flags(); }

 private:
  fem::Body body_;
  std::vector<int> nodes_;
  FrameComputation computation_;
  WordBoard board_;
  std::vector<std::int32_t> b_, x_;
  std::vector<Eigen::Vector3d> place_;
};

// Nothing presses the body at first: the board is not asked, and has no frame to renew after.
TEST(RenewedMatrix, CountsTheFramesInWhichTheBoardSolved) {
  Frames frames(2);
  for (int frame = 0; frame < 3; ++frame) EXPECT_FALSE(frames.renews_after(std::nullopt));
  frames.touch();
  EXPECT_FALSE(frames.renews_after(1e-3));
  EXPECT_TRUE(frames.renews_after(1e-3));
  EXPECT_FALSE(frames.renews_after(1e-3));
}

// A body that is not where its forces have it is no place to take a matrix from: the next frame is.
TEST(RenewedMatrix, WaitsForAFrameWhoseResidualFell) {
  Frames frames(2);
  frames.touch();
  EXPECT_FALSE(frames.renews_after(1e-3));
  EXPECT_FALSE(frames.renews_after(2e-3, true));
  EXPECT_TRUE(frames.flags().has(stability::Flag::divergence));
  EXPECT_TRUE(frames.renews_after(2e-3));
  EXPECT_FALSE(frames.flags().has(stability::Flag::divergence));
  EXPECT_FALSE(frames.renews_after(2e-3));
}

TEST(RenewedMatrix, NeedsAMatrixThatChanges) {
  const fem::Body body = tissue::thesis_sphere();
  const auto make = [&](LawKind law, SolvedBy solver) {
    const FrameComputation computation(
        tissue::make_tissue(body, model_of(law), fem::ContactDiagonal::average, undamped(), kPeriod,
                            Effort::computed),
        words(), Refinement{.passes = 1}, solver, Effort::computed, {.every = 5});
  };
  EXPECT_NO_THROW(make(LawKind::corotational, SolvedBy::board));
  EXPECT_THROW(make(LawKind::linear, SolvedBy::board), InputError);
  EXPECT_THROW(make(LawKind::linear, SolvedBy::cg), InputError);
  EXPECT_NO_THROW(make(LawKind::corotational, SolvedBy::cg));
}

}  // namespace
}  // namespace hvp::host::renewal_test
