#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/structured_box.h"
#include "models/host/frame_computation.h"
#include "models/index.h"
#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"

namespace hvp::host::nonlinear_frames_test {
namespace {

constexpr double kPeriod = 2e-3;

fem::Body cube() {
  mesh::TetMesh mesh = fem::structured_box({0.03, 0.03, 0.03}, {3, 3, 3});
  std::vector<int> clamped;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) clamped.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), {}, clamped, fem::AnchorTreatment::removed);
}

double largest_difference(std::span<const double> a, std::span<const double> b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// Frames by increments with the matrix at rest, until nothing is left, against Newton's method with
// the exact tangent: pressed in, held, let go. Both with the same scheme, each with its own way
// through a frame.
TEST(NonlinearFrames, LeadWhereNewtonsMethodDoes) {
  const fem::Body body = cube();
  const std::vector<int> nodes = {
      body.active_index(static_cast<int>(body.mesh().nodes.size()) - 1)};
  fem::Dynamics newmark;
  fem::Dynamics relaxed{.scheme = fem::Scheme::generalised_alpha, .spectral_radius = 0.8};
  fem::Dynamics dissipative{.scheme = fem::Scheme::generalised_alpha, .spectral_radius = 0};
  dissipative.rayleigh_stiffness = 0;
  dissipative.mass = fem::MassKind::consistent;
  for (const fem::Dynamics& dynamics : {newmark, relaxed, dissipative}) {
    for (const bool relaxes : {false, true}) {
      if (relaxes && dynamics.rayleigh_stiffness > 0) continue;
      tissue::Constitution constitution(tissue::LawKind::neo_hookean_log);
      if (relaxes) constitution.prony = {{0.5, 0.02}};
      FrameComputation frames(
          std::make_unique<tissue::NonlinearTissue>(
              body, constitution, fem::ContactDiagonal::average, dynamics, kPeriod),
          fixed::Settings{}, Refinement{.passes = 60, .tolerance = 1e-12}, SolvedBy::cholesky,
          Effort::computed);
      tissue::NewtonRun truth(body, constitution, dynamics, kPeriod, 1);
      double largest = 0;
      double strongest = 0;
      for (int frame = 0; frame < 40; ++frame) {
        const bool held = frame < 25;
        const std::vector<int> contact = held ? nodes : std::vector<int>();
        if (frame == 0 || frame == 25) frames.set_contact(contact);
        const std::vector<Eigen::Vector3d> place(contact.size(),
                                                 {0, 0, -3e-3 * std::min(1.0, frame / 15.0)});
        const std::vector<fem::LetGo> fading = {{nodes.front(), 1 - 0.1 * (frame - 25), 0}};
        const bool fades = !held && frame < 35;
        const fem::Hold hold{contact, place,
                             fades ? std::span(fading) : std::span<const fem::LetGo>(), kPeriod};
        frames.hold(hold);
        frames.begin();
        std::vector<std::int32_t> none;
        while (frames.method().next(none)) {
        }
        const Eigen::Vector3d force = frames.force();
        frames.method().finish();
        truth.step(hold);
        for (const double u : truth.displacement()) largest = std::max(largest, std::abs(u));
        strongest = std::max(strongest, truth.forces()[0].norm());
        EXPECT_LE(largest_difference(frames.displacement(), truth.displacement()), 1e-6 * largest)
            << frame;
        EXPECT_LE((force - truth.forces()[0]).norm(), 1e-5 * strongest) << frame;
        frames.update();
      }
      EXPECT_EQ(truth.unsolved(), 0);
      EXPECT_GT(strongest, 1e-3);
    }
  }
}

}  // namespace
}  // namespace hvp::host::nonlinear_frames_test
