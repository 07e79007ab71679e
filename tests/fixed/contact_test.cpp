// What the board is for: a probe presses one node a little further in every frame, the previous
// solution is the guess, 60 iterations (thesis §3.7, §6.2). Bounds: displacement within 2 % (CG)
// or 1 % (PCG) of the solution of the rounded system and 6 % of that of the true one, mean over
// frames, relative to the run's largest reference norm.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/newmark.h"
#include "models/fixed/reference_solver.h"
#include "models/fixed/spectrum.h"
#include "models/fixed/system.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::contact_test {
namespace {

using Factor = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;

// A body and how it is pressed: 25 mm/s at 500 Hz for a fifth of a second.
struct Press {
  sparse::BlockMatrix stiffness;
  int node = 0;
  Eigen::Vector3d direction;
  int frames = 100;
  double step = 5e-5;  // m a frame
};

struct Accuracy {
  double against_rounded = 0;
  double against_true = 0;
  stability::Flags flags;
  int clamped = 0;
};

Accuracy press(const Press& p, Settings s) {
  const QuantisedMatrix original = quantise(p.stiffness, s.matrix_bits);
  QuantisedMatrix matrix = original;
  const std::int32_t word = original.mean_diagonal();
  matrix.set_contact(p.node, word);
  const double diagonal = matrix.scale * word;
  const Factor true_system(test::with_contact(p.stiffness, p.node, diagonal).to_eigen());
  const Factor rounded_system(dequantise(matrix).to_eigen());
  const double depth = p.frames * p.step;
  const Eigen::VectorXd load =
      test::contact_load(p.stiffness, p.node, diagonal, depth * p.direction);
  // Linear: every frame's exact solution is a share of the last one's.
  const Eigen::VectorXd true_last = true_system.solve(load);
  const Eigen::VectorXd rounded_last = rounded_system.solve(load);

  const Scaling scaling(s, matrix);
  ReferenceSolver solver(s);
  const auto rows = static_cast<std::size_t>(matrix.rows());
  std::vector<std::int32_t> b(rows);
  std::vector<std::int32_t> x(rows, 0);
  Eigen::VectorXd u(matrix.rows());
  Accuracy result;
  for (int frame = 1; frame <= p.frames; ++frame) {
    const double share = static_cast<double>(frame) / p.frames;
    const Eigen::VectorXd force = share * load;
    result.clamped += scaling.right_hand_side({force.data(), rows}, b);
    result.flags.merge(solver.solve(matrix, {.b = b, .x = x}).flags);
    scaling.displacements(x, {u.data(), rows});
    result.against_rounded += (u - share * rounded_last).norm() / rounded_last.norm() / p.frames;
    result.against_true += (u - share * true_last).norm() / true_last.norm() / p.frames;
  }
  return result;
}

void expect_accurate(const Press& p) {
  Settings s;
  const Accuracy cg = press(p, s);
  testing::Test::RecordProperty("cg_rounded", std::to_string(cg.against_rounded));
  testing::Test::RecordProperty("cg_true", std::to_string(cg.against_true));
  EXPECT_LT(cg.against_rounded, 0.02);
  EXPECT_LT(cg.against_true, 0.06);
  EXPECT_TRUE(cg.flags.empty()) << cg.flags.bits();
  EXPECT_EQ(cg.clamped, 0);
  s.method = Method::jacobi_pcg;
  const Accuracy pcg = press(p, s);
  testing::Test::RecordProperty("pcg_rounded", std::to_string(pcg.against_rounded));
  testing::Test::RecordProperty("pcg_true", std::to_string(pcg.against_true));
  EXPECT_LT(pcg.against_rounded, 0.01);
  EXPECT_LT(pcg.against_true, 0.06);
  EXPECT_TRUE(pcg.flags.empty()) << pcg.flags.bits();
  EXPECT_EQ(pcg.clamped, 0);
  // The rest is the rounding of the matrix: 18 bits remove it.
  s.matrix_bits = 18;
  const Accuracy wide = press(p, s);
  EXPECT_LT(wide.against_true, pcg.against_true / 3);
}

Press box_press() {
  const test::Body body =
      test::make_body({.cells_x = 7, .cells_y = 7, .cells_z = 7, .cell = 0.0125});
  return {.stiffness = body.stiffness,
          .node = body.nearest({0.0875, 0.044, 0.044}),
          .direction = Eigen::Vector3d(-1, 0.1, -0.2).normalized()};
}

struct Sphere {
  fem::Body body;
  int top = 0;  // active index
};

// The thesis' scene (§6.2.4): a sphere of 5 cm, 500 nodes, the lowest 15 % of them held.
Sphere sphere() {
  mesh::TetMesh mesh = mesh::generate({});
  const std::vector<int> anchored = mesh::select_nodes({}, mesh);
  int top = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() > mesh.nodes[static_cast<std::size_t>(top)].z())
      top = static_cast<int>(n);
  }
  fem::Body body(std::move(mesh), {}, anchored, fem::AnchorTreatment::removed);
  const int active = body.active_index(top);
  return {.body = std::move(body), .top = active};
}

TEST(StaticContact, PressedBoxIsAccurate) { expect_accurate(box_press()); }

TEST(StaticContact, PressedSphereIsAccurate) {
  const Sphere s = sphere();
  expect_accurate({.stiffness = s.body.stiffness(),
                   .node = s.top,
                   .direction = Eigen::Vector3d(0.2, 0.1, -1).normalized()});
}

TEST(StaticContact, EveryHeadroomUpToFourWorks) {
  for (const int headroom : {0, 1, 2, 3, 4}) {
    Settings s;
    s.headroom_bits = headroom;
    Press p = box_press();
    p.frames = 30;
    const Accuracy result = press(p, s);
    EXPECT_LT(result.against_rounded, 0.04) << headroom;
    EXPECT_TRUE(result.flags.empty()) << headroom;
  }
}

// A load beyond the range is clamped by the host, counted, and never silent.
TEST(StaticContact, LeavingTheRangeIsCounted) {
  Press p = box_press();
  p.step = 2e-3;
  EXPECT_GT(press(p, {}).clamped, 0);
}

// The dynamic system (thesis §3.6.1) is well conditioned (independent: 30 to 44): CG reaches its
// rounded solution to the last places. What 12 bits do to Â itself is another matter.
TEST(DynamicContact, SolutionOfTheRoundedSystemToTheLastPlaces) {
  const Sphere s = sphere();
  const fem::Newmark newmark(s.body.stiffness(), s.body.mass(fem::MassKind::lumped), {}, 2e-3);
  const sparse::BlockMatrix& a = newmark.effective_matrix();
  const double condition = test::condition_number(a);
  EXPECT_GT(condition, 25);
  EXPECT_LT(condition, 50);
  const Press p{.stiffness = a,
                .node = s.top,
                .direction = Eigen::Vector3d(0.2, 0.1, -1).normalized(),
                .frames = 1,
                .step = 5e-3};
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    Settings settings;
    settings.method = method;
    settings.iterations = 30;
    const QuantisedMatrix original = quantise(a, settings.matrix_bits);
    QuantisedMatrix matrix = original;
    matrix.set_contact(p.node, original.mean_diagonal());
    const Eigen::VectorXd load = test::contact_load(
        a, p.node, matrix.scale * original.mean_diagonal(), p.step * p.direction);
    const Scaling scaling(settings, matrix);
    std::vector<std::int32_t> b(static_cast<std::size_t>(matrix.rows()));
    std::vector<std::int32_t> x(b.size(), 0);
    EXPECT_EQ(scaling.right_hand_side({load.data(), b.size()}, b), 0);
    ReferenceSolver solver(settings);
    EXPECT_TRUE(solver.solve(matrix, {.b = b, .x = x}).clean());
    const Eigen::VectorXd exact = Factor(dequantise(matrix).to_eigen()).solve(load);
    double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      worst = std::max(worst, std::abs(x[i] - exact[static_cast<Eigen::Index>(i)] /
                                                  scaling.displacement_unit()));
    }
    RecordProperty(method == Method::cg ? "cg_worst" : "pcg_worst", std::to_string(worst));
    EXPECT_LT(worst, 8);
  }
}

}  // namespace
}  // namespace hvp::fixed::contact_test
