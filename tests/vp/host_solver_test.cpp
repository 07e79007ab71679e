// No board: the servo process solves.
#include <gtest/gtest.h>

#include "models/fem/direct_solver.h"
#include "models/host/processor.h"
#include "models/time/picoseconds.h"
#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::host_solver_test {
namespace {

using test::kUs;
using test::Simulated;
using test::SmallScene;

SmallScene::Options solved_by(host::SolvedBy solver) {
  SmallScene::Options options;
  options.solved_by = solver;
  return options;
}

// Everything but the solve: the DAQ's registers, the lookup and the converter.
Picoseconds around_the_solve() {
  return test::pci_write(4) + 1 * kUs + test::pci_read(12) + 1 * kUs + test::pci_write(12) +
         10 * kUs;
}

TEST(HostSolver, NeitherBoardNorItsProcessIsThere) {
  SmallScene scene(solved_by(host::SolvedBy::cholesky));
  const Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  // The bus and its master carry the DAQ board.
  EXPECT_EQ(Platform::modules(),
            (std::vector<std::string>{"bus", "daq", "access", "servo", "collision"}));
  EXPECT_EQ(Platform::processes(), 2U);
  EXPECT_EQ(platform.board(), nullptr);
}

TEST(HostSolver, TriangularSolvesTakeTheirOperations) {
  SmallScene scene(solved_by(host::SolvedBy::cholesky));
  const Simulated run(scene);
  const fem::DirectSolver factors(scene.computation.matrix());
  const double operations =
      4.0 * static_cast<double>(factors.factor_nonzeros()) + SmallScene::kUnknowns;
  // Before the first frame the factors are made.
  EXPECT_EQ(run.platform.session().begin, test::compute(factors.factor_operations()));
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.latency(), around_the_solve() + test::compute(operations));
  }
}

TEST(HostSolver, ConjugateGradientsTakeTheirIterations) {
  SmallScene::Options options = solved_by(host::SolvedBy::cg);
  options.solver.iterations = 7;
  SmallScene scene(options);
  scene.touch();
  scene.settings.frames = 30;
  const Simulated run(scene);
  const double n = SmallScene::kUnknowns;
  const double product = 18.0 * static_cast<double>(scene.computation.matrix().blocks());
  const int row = scene.body.active_index(SmallScene::kTopNode);
  const auto& begin = scene.computation.matrix().row_begin;
  const int blocks =
      begin[static_cast<std::size_t>(row) + 1] - begin[static_cast<std::size_t>(row)];
  int touched = 0;
  for (const Frame& frame : run.log.frames) {
    if (frame.touch().contact.node < 0) continue;
    EXPECT_EQ(frame.latency(), around_the_solve() +
                                   test::compute(test::hand_over_operations(scene, touched)) +
                                   test::compute(product + 3 * n + 7 * (product + 10 * n + 2)) +
                                   test::compute(18.0 * blocks + 3))
        << "frame " << frame.number;
    ++touched;
  }
  EXPECT_GT(touched, 15);
}

TEST(HostSolver, AMeasuredRateScalesTheSolveAlone) {
  SmallScene scene(solved_by(host::SolvedBy::cholesky));
  scene.settings.host.solver_rate_flops = 4 * scene.settings.host.sustained_rate_flops;
  const Simulated run(scene);
  const fem::DirectSolver factors(scene.computation.matrix());
  const double operations =
      4.0 * static_cast<double>(factors.factor_nonzeros()) + SmallScene::kUnknowns;
  EXPECT_EQ(run.log.frames[0].latency(), around_the_solve() + test::compute(operations / 4));
}

// A processor that is priced by kind and bytes: its triangular solves, what they move, and a call.
TEST(HostSolver, AProcessorPricesKindsAndBytes) {
  SmallScene scene(solved_by(host::SolvedBy::cholesky));
  scene.settings.host.model = host::ProcessorModel::desktop_2026;
  const Simulated run(scene);
  const fem::DirectSolver factors(scene.computation.matrix());
  const host::Processor& p = host::built_in(host::ProcessorModel::desktop_2026);
  const auto entries = static_cast<double>(factors.factor_nonzeros());
  const double n = SmallScene::kUnknowns;
  const double seconds = p.call_s + (4 * entries + n) / p.triangular_flops +
                         (24 * entries + 72 * n) / p.bandwidth(12 * entries + 24 * n);
  EXPECT_EQ(run.log.frames[0].latency(), around_the_solve() + to_picoseconds(seconds));
}

// What can be found after the force does not keep it waiting.
TEST(HostSolver, TheInteriorIsSolvedForAfterTheForce) {
  SmallScene scene(solved_by(host::SolvedBy::condensed));
  const Simulated run(scene);
  const host::FrameMethod& method = scene.computation.method();
  for (const Frame& frame : run.log.frames) {
    EXPECT_EQ(frame.latency(), around_the_solve() + test::compute(method.solve_work().operations()))
        << frame.number;
  }
}

// The numbers are those of the double-precision reference, frame by frame.
class AgainstReference : public FrameObserver {
 public:
  explicit AgainstReference(const SmallScene& scene)
      : solver_(scene.computation.matrix()),
        constraint_(scene.computation.matrix(), fem::ContactDiagonal::average),
        forces_(scene.body.active_nodes()),
        load_(scene.body.load()),
        u_(load_.size()) {}
  void solved(const Frame& frame, const Solution& solution) override {
    if (!solution.hold.present()) return;
    forces_.add_to(solution.hold.let_go, loaded_ = load_);
    solver_.solve_with_contact(loaded_, solution.hold.nodes, solution.hold.displacement, u_);
    Eigen::Vector3d force;
    constraint_.reaction(u_, load_, solution.hold.nodes, forces_);
    forces_.sum(solution.hold, {&force, 1});
    EXPECT_LE((frame.touch().force - force).norm(), 1e-9 * force.norm()) << frame.number;
    ++compared;
  }
  int compared = 0;

 private:
  fem::DirectSolver solver_;
  fem::ContactConstraint constraint_;
  fem::HeldForces forces_;
  std::vector<double> load_;
  std::vector<double> loaded_;
  std::vector<double> u_;
};

TEST(HostSolver, ForcesAreThoseOfTheTrueModel) {
  SmallScene scene(solved_by(host::SolvedBy::cholesky));
  scene.slide(0.06);
  scene.settings.frames = 40;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  AgainstReference reference(scene);
  platform.add_observer(reference);
  platform.run();
  EXPECT_GT(reference.compared, 20);
  EXPECT_GE(platform.servo().counts().contact_changes, 2);
  EXPECT_EQ(platform.servo().counts().driver_errors, 0);
}

}  // namespace
}  // namespace hvp::vp::host_solver_test
