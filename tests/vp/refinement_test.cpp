// Frames with refinement: what each pass takes, to the picosecond, and what is not there without.
#include <gtest/gtest.h>

#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::refinement_test {
namespace {

using test::compute;
using test::kUs;
using test::pci_read;
using test::pci_write;
using test::Simulated;
using test::SmallScene;

constexpr int kUnknowns = SmallScene::kUnknowns;
constexpr int kVectorBytes = 2 * kUnknowns;
constexpr double kConversion = 4.0 * kUnknowns;

SmallScene::Options refined(int passes) {
  SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.solver.iterations = 15;
  options.refinement = host::Refinement{.passes = passes};
  return options;
}

double blocks(const SmallScene& scene) {
  return static_cast<double>(scene.computation.matrix().blocks());
}

int contact_blocks(const SmallScene& scene) {
  const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
  const auto row = static_cast<std::size_t>(scene.body.active_index(SmallScene::kTopNode));
  return k.row_begin[row + 1] - k.row_begin[row];
}

// b, the solve and U, the driver's part included.
Picoseconds pass(const SmallScene& scene) {
  return 1 * kUs + pci_write(kVectorBytes) + pci_write(4) +
         test::solve_time(scene.computation.board().matrix().row_begin, 15) + 5 * kUs +
         pci_read(4) + pci_write(4) + 1 * kUs + pci_read(kVectorBytes);
}

// A frame in a hold: the contact stays, its columns are moved. `since`: frames since it was met.
Picoseconds latency(const SmallScene& scene, int passes, int since) {
  const double columns = contact_blocks(scene);
  // Subtract, the largest of r and u; into words.
  const double residual = 3.0 * kUnknowns + kConversion;
  // From words; add, the largest, two comparisons with the range.
  const double accept = 4.0 * kUnknowns + kConversion;
  const double product = 18 * blocks(scene);
  // Of the held node p, q, what K and M multiply, the predictors: 12 for each component; its
  // column of K, and of the lumped masses its own.
  const double hold = 3 * 12 + 18 * columns + 6;
  Picoseconds sum = pci_write(4) + 1 * kUs + pci_read(12) + 1 * kUs;
  sum += compute(test::hand_over_operations(scene, since) + hold);
  sum += compute(36 * columns + 6 + residual) + pass(scene);
  for (int p = 1; p < passes; ++p) sum += compute(accept + product + residual) + pass(scene);
  return sum + compute(accept) + compute(18 * columns + 3)  // the last increment; the force
         + pci_write(12) + 10 * kUs;
}

void expect_times(int passes) {
  SmallScene scene(refined(passes));
  scene.touch();
  scene.settings.frames = 30;
  const Simulated run(scene);
  // Two norms, an inner product, the residual; and what Newmark's update takes (frame_test.cpp).
  const double judge = 18 * blocks(scene) + 8.0 * kUnknowns;
  const double update = (4 + 12 + 2 + 2) * kUnknowns + 18 * blocks(scene);
  int touched = 0;
  for (std::size_t n = 0; n < run.log.frames.size(); ++n) {
    const Frame& frame = run.log.frames[n];
    Picoseconds sum = 0;
    for (const SpanId id : run.log.paths[n]) {
      const Span& span = frame.spans[static_cast<std::size_t>(id)];
      sum += span.end - span.start;
    }
    EXPECT_EQ(sum, frame.latency()) << "frame " << n;
    if (frame.touch().contact.node < 0) continue;
    // The first frame of the contact also tells the board of it.
    if (touched > 0) {
      EXPECT_EQ(frame.latency(), latency(scene, passes, touched)) << "frame " << n;
      EXPECT_EQ(frame.work_done - frame.born,
                frame.latency() - 10 * kUs + compute(judge) + compute(update));
    }
    ++touched;
  }
  EXPECT_GT(touched, 15);  // longer than the hand-over
  EXPECT_TRUE(run.platform.verdict().force_in_time());
}

TEST(RefinedFrame, TakesTheSumOfItsSteps) { expect_times(2); }
TEST(RefinedFrame, TakesAPassMoreWithAPassMore) { expect_times(3); }

TEST(RefinedFrame, ShowsEveryPassInTheLedger) {
  SmallScene scene(refined(2));
  scene.touch();
  const Simulated run(scene);
  const Frame& frame = run.log.frames.back();
  ASSERT_GE(frame.touch().contact.node, 0);
  const auto count = [&](Phase phase) {
    return std::count_if(frame.spans.begin(), frame.spans.end(),
                         [phase](const Span& s) { return s.phase == phase; });
  };
  EXPECT_EQ(count(Phase::solve), 2);
  EXPECT_EQ(count(Phase::form_rhs), 0);
  // A residual before each solve, the last increment, and the product after the force.
  EXPECT_EQ(count(Phase::refinement), 4);
}

TEST(RefinedFrame, AtRestNothingIsSolved) {
  SmallScene scene(refined(2));
  const Simulated run(scene);
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) EXPECT_NE(span.phase, Phase::solve);
    EXPECT_TRUE(frame.solved());
    EXPECT_EQ(frame.flags, 0U);
  }
}

TEST(RefinedFrame, IsNoModuleAndNoProcess) {
  SmallScene scene(refined(2));
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  EXPECT_EQ(Platform::modules(), (std::vector<std::string>{"bus", "accelerator", "daq", "access",
                                                           "servo", "collision"}));
  EXPECT_EQ(Platform::processes(), 3U);
}

TEST(RefinedFrame, WithoutItsTableThereIsNone) {
  SmallScene scene;
  EXPECT_EQ(scene.computation.refined(), nullptr);
  const Simulated run(scene);
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) EXPECT_NE(span.phase, Phase::refinement);
  }
}

}  // namespace
}  // namespace hvp::vp::refinement_test
