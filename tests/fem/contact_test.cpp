#include "models/fem/contact.h"

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/newmark.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::contact_test {
namespace {

const Eigen::Vector3d kPress(0.01, -0.02, -0.1);

Body cube() {
  mesh::TetMesh mesh = jittered_cube(3);
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), Material{.young_modulus_pa = 100, .poisson_ratio = 0.3}, floor,
              AnchorTreatment::removed);
}

Eigen::VectorXd as_eigen(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

// minimise ½·uᵀA·u − uᵀf subject to u = u_c at the patch, by Lagrange multipliers, densely.
Eigen::VectorXd constrained_minimum(const sparse::BlockMatrix& a, const std::vector<double>& f,
                                    const std::vector<int>& patch, const Eigen::Vector3d& u_c) {
  const Eigen::Index n = a.rows();
  const auto m = static_cast<Eigen::Index>(3 * patch.size());
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(n + m);
  system.topLeftCorner(n, n) = a.to_eigen().toDense();
  rhs.head(n) = as_eigen(f);
  for (Eigen::Index c = 0; c < m; ++c) {
    const Eigen::Index row = 3 * patch[static_cast<std::size_t>(c / 3)] + c % 3;
    system(row, n + c) = system(n + c, row) = 1;
    rhs[n + c] = u_c[c % 3];
  }
  return test::solve(system, rhs).head(n);
}

TEST(Contact, ModifiedSystemEqualsConstrainedMinimisation) {
  const Body body = cube();
  const sparse::BlockMatrix& a = body.stiffness();
  const std::vector<double> f = noise_vector(static_cast<std::size_t>(a.rows()));
  DirectSolver reference(a);
  const int top = body.active_nodes() - 1;
  for (const std::vector<int>& patch :
       {std::vector<int>{top}, {top - 6}, {top - 5, top - 1, top}}) {
    const Eigen::VectorXd expected = constrained_minimum(a, f, patch, kPress);
    std::vector<double> u(f.size());
    reference.solve_with_contact(f, patch, kPress, u);
    EXPECT_LT((as_eigen(u) - expected).norm(), 1e-12 * expected.norm());
    for (const ContactDiagonal diagonal : {ContactDiagonal::one, ContactDiagonal::average}) {
      const ContactConstraint contact(a, diagonal);
      std::vector<double> b(f.size());
      contact.modified_rhs(f, patch, kPress, b);
      DirectSolver modified(contact.modified_matrix(patch));
      EXPECT_TRUE(modified.positive_definite());
      modified.solve(b, u);
      EXPECT_LT((as_eigen(u) - expected).norm(), 1e-12 * expected.norm());
    }
  }
}

TEST(Contact, MatrixKeepsItsPatternAndSymmetry) {
  const Body body = cube();
  const ContactConstraint contact(body.stiffness(), ContactDiagonal::average);
  const int node = 20;
  const sparse::BlockMatrix modified = contact.modified_matrix(node);
  EXPECT_EQ(modified.row_begin, body.stiffness().row_begin);
  EXPECT_EQ(modified.column, body.stiffness().column);
  const Eigen::MatrixXd dense = modified.to_eigen().toDense();
  EXPECT_EQ(dense, dense.transpose());
  const Eigen::MatrixXd original = body.stiffness().to_eigen().toDense();
  EXPECT_NEAR(contact.diagonal(), original.diagonal().mean(), 1e-12 * original.diagonal().mean());
  for (Eigen::Index i = 0; i < dense.rows(); ++i) {
    for (Eigen::Index j = 0; j < dense.cols(); ++j) {
      const bool touched = i / 3 == node || j / 3 == node;
      const double expected = !touched ? original(i, j) : i == j ? contact.diagonal() : 0;
      EXPECT_EQ(dense(i, j), expected);
    }
  }
}

// The rows of the contact node in b are diagonal·u_c.
TEST(Contact, RowsOfTheContactHoldTheDisplacement) {
  const Body body = cube();
  const std::vector<double> f = noise_vector(body.load().size());
  std::vector<double> b(f.size());
  const ContactConstraint one(body.stiffness(), ContactDiagonal::one);
  one.modified_rhs(f, 7, kPress, b);
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(b[21 + r], kPress[static_cast<int>(r)]);
}

// The work of the contact force is the change of energy: with Π(u_c) the minimum of
// ½·uᵀA·u − uᵀf, ∂Π/∂u_c is the force on the body. Π is quadratic, so that the central
// difference is exact.
TEST(Contact, ReactionIsTheDerivativeOfEnergy) {
  const Body body = cube();
  const sparse::BlockMatrix& a = body.stiffness();
  const std::vector<double> f = noise_vector(body.load().size());
  DirectSolver reference(a);
  const ContactConstraint contact(a, ContactDiagonal::average);
  for (const std::vector<int>& patch : {std::vector<int>{40}, {36, 40, 41}}) {
    const auto energy = [&](const Eigen::Vector3d& u_c) {
      std::vector<double> u(f.size());
      reference.solve_with_contact(f, patch, u_c, u);
      const Eigen::VectorXd x = as_eigen(u);
      return 0.5 * x.dot(a.to_eigen() * x) - x.dot(as_eigen(f));
    };
    std::vector<double> u(f.size());
    reference.solve_with_contact(f, patch, kPress, u);
    const Eigen::Vector3d force = contact.reaction(u, f, patch);
    for (int r = 0; r < 3; ++r) {
      const Eigen::Vector3d step = 0.1 * Eigen::Vector3d::Unit(r);
      const double derivative = (energy(kPress + step) - energy(kPress - step)) / 0.2;
      EXPECT_NEAR(force[r], derivative, 1e-10 * force.norm());
    }
  }
}

// Pressing from above needs a force downwards; the supports push back with the opposite.
TEST(Contact, ReactionBalancesTheSupports) {
  const Body body = cube();
  const std::vector<double> f(body.load().size(), 0.0);
  DirectSolver reference(body.stiffness());
  const ContactConstraint contact(body.stiffness(), ContactDiagonal::average);
  const int node = body.active_index(nearest_node(body.mesh(), {2.0 / 3, 2.0 / 3, 1}));
  std::vector<double> u(f.size());
  reference.solve_with_contact(f, node, {0, 0, -0.1}, u);
  const Eigen::Vector3d force = contact.reaction(u, f, node);
  EXPECT_LT(force.z(), 0);
  const std::vector<double> u_full = body.expand(u);
  std::vector<double> nodal(u_full.size());
  assemble_stiffness(body.mesh(), body.material()).multiply(u_full, nodal);
  Eigen::Vector3d support = Eigen::Vector3d::Zero();
  for (const int anchor : body.anchored()) {
    support += Eigen::Vector3d::Map(&nodal[3 * static_cast<std::size_t>(anchor)]);
  }
  EXPECT_LT((force + support).norm(), 1e-12 * force.norm());
}

// In a dynamic step A is Â and f is f̂; the reaction is M·a + C·v + K·u − f at the node.
TEST(Contact, ReactionOfADynamicStepIncludesInertia) {
  const Body body = cube();
  const Dynamics dynamics;
  const sparse::BlockMatrix m = body.mass(MassKind::lumped);
  Newmark newmark(body.stiffness(), m, dynamics, 2e-3);
  const std::vector<double> f = noise_vector(body.load().size());
  newmark.set_state(noise_vector(f.size(), 1), noise_vector(f.size(), 2),
                    noise_vector(f.size(), 3));
  DirectSolver reference(newmark.effective_matrix());
  const ContactConstraint contact(newmark.effective_matrix(), ContactDiagonal::average);
  std::vector<double> f_hat(f.size()), u(f.size());
  newmark.predict();
  newmark.rhs(f, f_hat);
  reference.solve_with_contact(f_hat, 30, kPress, u);
  newmark.update(u);
  const Eigen::Vector3d force = contact.reaction(u, f_hat, 30);
  std::vector<double> ku(f.size()), kv(f.size()), mv(f.size()), ma(f.size());
  body.stiffness().multiply(newmark.displacement(), ku);
  body.stiffness().multiply(newmark.velocity(), kv);
  m.multiply(newmark.velocity(), mv);
  m.multiply(newmark.acceleration(), ma);
  for (std::size_t r = 0; r < 3; ++r) {
    const std::size_t i = 90 + r;
    EXPECT_NEAR(force[static_cast<int>(r)], ma[i] + 0.1 * mv[i] + 1e-3 * kv[i] + ku[i] - f[i],
                1e-9 * force.norm());
  }
}

TEST(Contact, CallsOfARunningSimulationAllocateNothing) {
  const Body body = cube();
  const std::vector<double> f = noise_vector(body.load().size());
  std::vector<double> b(f.size()), u(f.size());
  DirectSolver reference(body.stiffness());
  const ContactConstraint contact(body.stiffness(), ContactDiagonal::average);
  reference.solve_with_contact(f, 40, kPress, u);
  const std::size_t before = hvp::test::allocation_count();
  reference.solve_with_contact(f, 40, 2 * kPress, u);
  reference.solve_with_contact(f, 12, kPress, u);
  contact.modified_rhs(f, 12, kPress, b);
  const Eigen::Vector3d force = contact.reaction(u, f, 12);
  EXPECT_EQ(hvp::test::allocation_count(), before);
  EXPECT_TRUE(force.allFinite());
}

TEST(Contact, OperationCountsFollowTheRow) {
  const Body body = cube();
  const ContactConstraint contact(body.stiffness(), ContactDiagonal::one);
  const double blocks = body.stiffness().row_begin[6] - body.stiffness().row_begin[5];
  EXPECT_EQ(contact.modified_rhs_flops(5), 18 * blocks + 3);
  EXPECT_EQ(contact.reaction_flops(5), 18 * blocks + 3);
}

TEST(Contact, PatchHoldsTheSurfaceNodesWithinItsRadius) {
  const mesh::TetMesh mesh = structured_box({1, 1, 1}, {4, 4, 4});
  const int top = nearest_node(mesh, {0.5, 0.5, 1});
  EXPECT_EQ(contact_patch(mesh, top, 0), std::vector<int>{top});
  EXPECT_EQ(contact_patch(mesh, top, 0.25),
            (std::vector<int>{top - 5, top - 1, top, top + 1, top + 5}));
}

TEST(Contact, RefusesNodesThatAreNotThere) {
  const Body body = cube();
  const ContactConstraint contact(body.stiffness(), ContactDiagonal::one);
  EXPECT_THROW(contact.modified_matrix(-1), InputError);
  EXPECT_THROW(contact.modified_matrix(body.active_nodes()), InputError);
  EXPECT_THROW(contact.modified_matrix(std::vector<int>{4, 4}), InputError);
  DirectSolver reference(body.stiffness());
  std::vector<double> u(body.load().size());
  EXPECT_THROW(reference.solve_with_contact(body.load(), 100000, kPress, u), InputError);
}

}  // namespace
}  // namespace hvp::fem::contact_test
