// A body that nobody touches stays at rest, whatever rounding makes of forces that cancel there.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/host/frame_computation.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"

namespace hvp::host::rest_test {
namespace {

using tissue::LawKind;

constexpr double kPeriod = 2e-3;
constexpr int kFrames = 5;

fem::Body sphere(double young_modulus_pa, double poisson_ratio) {
  mesh::MeshSettings settings;
  settings.nodes = 60;
  mesh::TetMesh mesh = mesh::generate(settings);
  const std::vector<int> anchored = mesh::select_nodes(mesh::Region{}, mesh);
  const fem::Material material{.young_modulus_pa = young_modulus_pa,
                               .poisson_ratio = poisson_ratio};
  return fem::Body(std::move(mesh), material, anchored, fem::AnchorTreatment::removed);
}

bool at_rest(std::span<const double> u) {
  return std::ranges::all_of(u, [](double x) { return x == 0; });
}

void expect_rest(const fem::Body& body, LawKind law, const std::optional<fem::Dynamics>& dynamics) {
  for (const SolvedBy solver : {SolvedBy::board, SolvedBy::cholesky}) {
    FrameComputation frames(std::make_unique<tissue::NonlinearTissue>(
                                body, law, fem::ContactDiagonal::average, dynamics, kPeriod),
                            fixed::Settings{}, Refinement{}, solver, Effort::computed);
    std::vector<std::int32_t> words(static_cast<std::size_t>(frames.matrix().rows()));
    for (int frame = 0; frame < kFrames; ++frame) {
      frames.hold({{}, {}, {}, kPeriod});
      frames.begin();
      EXPECT_FALSE(frames.method().next(words)) << "something to solve";
      frames.method().finish();
      EXPECT_TRUE(frames.method().flags().empty()) << frames.method().flags().bits();
      EXPECT_TRUE(at_rest(frames.displacement()));
      frames.update();
    }
    EXPECT_EQ(frames.increments()->worst_remaining(), 0);
    EXPECT_EQ(frames.increments()->without_start(), 0);
    // What was rounding does not bound the forces of the first touch.
    const std::vector<int> nodes = {body.active_nodes() - 1};
    const std::vector<Eigen::Vector3d> place = {{0, 0, -1e-4}};
    frames.set_contact(nodes);
    frames.hold({nodes, place, {}, kPeriod});
    frames.begin();
    EXPECT_EQ(frames.method().next(words), solver == SolvedBy::board);
    if (solver == SolvedBy::board) continue;
    frames.method().finish();
    EXPECT_TRUE(frames.method().flags().empty()) << frames.method().flags().bits();
  }
  tissue::NewtonRun truth(body, law, dynamics, kPeriod, 1);
  for (int frame = 0; frame < kFrames; ++frame) truth.step({{}, {}, {}, kPeriod});
  EXPECT_EQ(truth.unsolved(), 0);
  EXPECT_EQ(truth.indefinite(), 0);
  EXPECT_LE(truth.tangents(), 1);
  EXPECT_TRUE(at_rest(truth.displacement()));
}

TEST(ABodyAtRest, HasNothingToSolveOfAnyLaw) {
  const fem::Dynamics newmark{.rayleigh_stiffness = 0};
  for (const double e : {5e3, 9e3, 20e3, 21e3, 40e3, 80e3, 1e6, 1e9}) {
    for (const double nu : {0.3, 0.4, 0.49}) {
      const fem::Body body = sphere(e, nu);
      for (const LawKind law :
           {LawKind::linear, LawKind::corotational, LawKind::st_venant_kirchhoff,
            LawKind::neo_hookean_log, LawKind::neo_hookean_isochoric, LawKind::fung}) {
        SCOPED_TRACE(std::string(tissue::name(law)) + ", E " + std::to_string(e) + ", nu " +
                     std::to_string(nu));
        expect_rest(body, law, std::nullopt);
        expect_rest(body, law, newmark);
      }
    }
  }
}

}  // namespace
}  // namespace hvp::host::rest_test
