#include "models/fem/body.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/direct_solver.h"
#include "models/fem/newmark.h"
#include "models/fem/strain.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::body_test {
namespace {

const Material kTissue{.young_modulus_pa = 1e3, .poisson_ratio = 0.3};

mesh::Region top_of_unit_cube() {
  mesh::Region region;
  region.kind = mesh::Region::Kind::half_space;
  region.point = {0, 0, 1};
  region.normal = {0, 0, -1};
  return region;
}

std::vector<double> static_displacement(const Body& body) {
  std::vector<double> u(body.load().size());
  DirectSolver(body.stiffness()).solve(body.load(), u);
  return body.expand(u);
}

TEST(Body, RemovedAndKeptAnchorsGiveTheSameDisplacement) {
  const mesh::TetMesh mesh = jittered_cube(3);
  Loads loads;
  loads.gravity.emplace();
  loads.points.push_back({.position = {1, 0, 1}, .force = {1, 2, 3}});
  const Body removed(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::removed, loads);
  const Body kept(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::kept, loads);
  EXPECT_EQ(removed.active_nodes(), 48);
  EXPECT_EQ(kept.active_nodes(), 64);
  const std::vector<double> a = static_displacement(removed);
  const std::vector<double> b = static_displacement(kept);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
  for (const int anchor : removed.anchored()) {
    EXPECT_EQ(removed.active_index(anchor), -1);
    EXPECT_EQ(kept.active_index(anchor), anchor);
    EXPECT_EQ(b[3 * static_cast<std::size_t>(anchor)], 0);
  }
}

// The diagonal of kept rows is the mean over the free ones, so the mean does not change.
TEST(Body, KeptRowsHaveTheMeanDiagonal) {
  const mesh::TetMesh mesh = jittered_cube(3);
  const Body removed(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::removed);
  const Body kept(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::kept);
  const double mean = removed.stiffness().to_eigen().diagonal().mean();
  const Eigen::MatrixXd k = kept.stiffness().to_eigen().toDense();
  EXPECT_EQ(k, k.transpose());
  for (const int anchor : kept.anchored()) {
    for (int r = 0; r < 3; ++r) {
      const int row = 3 * anchor + r;
      EXPECT_NEAR(k(row, row), mean, 1e-12 * mean);
      EXPECT_EQ(k.row(row).cwiseAbs().sum(), k(row, row));
    }
  }
}

// A cube squeezed between its floor and its top by prescribed displacements.
TEST(Body, PrescribedDisplacementsAreMet) {
  const mesh::TetMesh mesh = jittered_cube(3);
  Loads loads;
  loads.prescribed.push_back({.region = top_of_unit_cube(), .displacement = {0.01, 0, -0.1}});
  const Body removed(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::removed, loads);
  const Body kept(mesh, kTissue, floor_nodes(mesh), AnchorTreatment::kept, loads);
  EXPECT_EQ(removed.active_nodes(), 32);
  const std::vector<double> a = static_displacement(removed);
  const std::vector<double> b = static_displacement(kept);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) EXPECT_NEAR(a[3 * i + r], b[3 * i + r], 1e-13);
    if (mesh.nodes[i].z() < 1) continue;
    EXPECT_EQ(a[3 * i], 0.01);
    EXPECT_EQ(a[3 * i + 2], -0.1);
  }
  // No force acts on what is neither anchored nor prescribed.
  std::vector<double> force(a.size());
  assemble_stiffness(removed.mesh(), removed.material()).multiply(a, force);
  for (const int node : removed.node_of_active()) {
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_NEAR(force[3 * static_cast<std::size_t>(node) + r], 0, 1e-10);
    }
  }
}

// Held nodes stay where they start, and the moving body settles at the static solution.
TEST(Body, DynamicsLeavesHeldNodesInPlace) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {2, 2, 2});
  Loads loads;
  mesh::Region top = top_of_unit_cube();
  top.point = {0, 0, 0.05};
  loads.prescribed.push_back({.region = top, .displacement = {0, 0, -0.005}});
  for (const AnchorTreatment treatment : {AnchorTreatment::removed, AnchorTreatment::kept}) {
    const Body body(mesh, kTissue, floor_nodes(mesh), treatment, loads);
    Newmark newmark(body.stiffness(), body.mass(MassKind::consistent),
                    {.mass = MassKind::consistent, .rayleigh_mass = 20}, 2e-3);
    const std::vector<double> zero(body.load().size(), 0.0);
    newmark.set_state(body.initial_displacement(), zero, zero);
    const DirectSolver solver(newmark.effective_matrix());
    std::vector<double> f_hat(zero.size()), u(zero.size());
    for (int step = 0; step < 3000; ++step) {
      newmark.predict();
      newmark.rhs(body.load(), f_hat);
      solver.solve(f_hat, u);
      newmark.update(u);
      for (int a = 0; a < body.active_nodes(); ++a) {
        if (!body.held(body.node_of_active()[static_cast<std::size_t>(a)])) continue;
        const double start = body.initial_displacement()[3 * static_cast<std::size_t>(a) + 2];
        ASSERT_NEAR(u[3 * static_cast<std::size_t>(a) + 2], start, 1e-12);
      }
    }
    const std::vector<double> expected = static_displacement(body);
    const std::vector<double> found = body.expand(u);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-10);
  }
}

std::string refusal(const mesh::TetMesh& mesh, const std::vector<int>& anchored,
                    const Loads& loads = {}) {
  try {
    const Body body(mesh, kTissue, anchored, AnchorTreatment::removed, loads);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Body, TooFewAnchorsAreRefusedWithTheModesThatRemain) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  EXPECT_NE(refusal(mesh, {}).find("no anchored node and keeps 6 rigid-body modes"),
            std::string::npos);
  EXPECT_NE(refusal(mesh, {4}).find("one anchored node and keeps 3 rigid-body modes"),
            std::string::npos);
  EXPECT_NE(refusal(mesh, {0, 1, 2})
                .find("3 anchored nodes on one line and keeps 1 rigid-body "
                      "mode:"),
            std::string::npos);
  EXPECT_EQ(refusal(mesh, {0, 1, 3}), "");
  std::vector<int> all(mesh.nodes.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  EXPECT_NE(refusal(mesh, all).find("all 27 nodes are held"), std::string::npos);
  EXPECT_NE(refusal(mesh, {-1}).find("-1"), std::string::npos);
}

// Three nodes that are not on one line are enough, and the count agrees with the eigenvalues.
TEST(Body, RemainingModesAgreeWithTheSpectrum) {
  const mesh::TetMesh mesh = jittered_cube(2);
  const sparse::BlockMatrix k = assemble_stiffness(mesh, kTissue);
  for (const std::vector<int>& held :
       {std::vector<int>{}, {5}, {0, 2}, {0, 1, 2}, {0, 1, 3}, {0, 13, 26}}) {
    std::vector<int> free;
    for (int i = 0; i < k.block_rows(); ++i) {
      if (std::find(held.begin(), held.end(), i) == held.end()) free.push_back(i);
    }
    const Eigen::VectorXd eigenvalues =
        test::symmetric_eigenvalues(k.submatrix(free).to_eigen().toDense());
    const auto zero = (eigenvalues.array() < 1e-10 * eigenvalues.maxCoeff()).count();
    EXPECT_EQ(remaining_rigid_body_modes(mesh, held), zero);
  }
}

TEST(Body, EveryPartNeedsItsOwnAnchors) {
  mesh::TetMesh mesh = structured_box({1, 1, 1}, {1, 1, 1});
  const mesh::TetMesh second = mesh;
  for (const auto& node : second.nodes) mesh.nodes.push_back(node + Eigen::Vector3d(3, 0, 0));
  for (auto tet : second.tetrahedra) {
    for (int& node : tet) node += 8;
    mesh.tetrahedra.push_back(tet);
  }
  EXPECT_NE(refusal(mesh, {0, 1, 2}).find("the part of the body with node 8 (one of 2 parts)"),
            std::string::npos);
  EXPECT_EQ(refusal(mesh, {0, 1, 2, 8, 9, 10}), "");
}

TEST(Body, ContradictorySupportsAreRefused) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {2, 2, 2});
  Loads loads;
  loads.prescribed.push_back({.region = top_of_unit_cube(), .displacement = {0, 0, -0.1}});
  std::vector<int> anchored = floor_nodes(mesh);
  EXPECT_EQ(refusal(mesh, anchored, loads), "");
  anchored.push_back(20);
  EXPECT_NE(refusal(mesh, anchored, loads).find("node 20 is anchored and"), std::string::npos);
  loads.prescribed.push_back(loads.prescribed.front());
  EXPECT_EQ(refusal(mesh, floor_nodes(mesh), loads), "");
  loads.prescribed.back().displacement.z() = -0.2;
  EXPECT_NE(refusal(mesh, floor_nodes(mesh), loads).find("two different"), std::string::npos);
}

}  // namespace
}  // namespace hvp::fem::body_test
