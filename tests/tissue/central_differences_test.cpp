#include "models/tissue/central_differences.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/contact.h"
#include "models/index.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/static_equilibrium.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/falling_beam.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::central_differences_test {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 1e-4;  // s

// The reference has ten digits of energies and thirteen of displacements. Their total is what is
// left of 10⁻⁴ J, and is compared with that.
TEST(CentralDifferences, AgreeWithTheReference) {
  for (const LawKind kind : {LawKind::linear, LawKind::corotational, LawKind::st_venant_kirchhoff,
                             LawKind::neo_hookean_log, LawKind::neo_hookean_isochoric}) {
    const fem::Body body = falling_beam();
    ASSERT_EQ(body.mesh().nodes.size(), 81u);
    ASSERT_EQ(body.mesh().tetrahedra.size(), 192u);
    const ElasticBody elastic(body, kind);
    CentralDifferences dynamics(elastic, its_weight(body), 0, kStep);
    int step = 0;
    for (const BeamRow& row : kBeamRows) {
      if (row.law != kind) continue;
      const Substeps done = dynamics.step(row.step - step);
      ASSERT_TRUE(done.complete());
      EXPECT_EQ(done.inverted, 0);
      step = row.step;
      const Vector3d expected(row.u_m[0], row.u_m[1], row.u_m[2]);
      EXPECT_LT((tip(dynamics) - expected).norm(), 1e-10 * expected.norm() + 1e-19)
          << static_cast<int>(kind) << ' ' << step;
      EXPECT_NEAR(dynamics.kinetic_energy(), row.kinetic_j, 1e-9 * row.kinetic_j);
      // Ψ = 10⁻¹³ J is what the strains of 10⁻⁵ leave of terms near one.
      EXPECT_NEAR(dynamics.strain_energy(), row.strain_j, 1e-9 * row.strain_j + 1e-17);
      EXPECT_NEAR(dynamics.kinetic_energy() + dynamics.strain_energy() - dynamics.work_of_load(),
                  row.total_j, 1e-9 * std::max(row.kinetic_j, row.strain_j));
    }
    EXPECT_EQ(step, 1000);
  }
}

// A tetrahedron with one free node, which moves along an eigenvector of its stiffness: one degree
// of freedom, of the trajectory in section 8 (ω·Δt = 0.5, ξ = 0.05).
TEST(CentralDifferences, OfOneDegreeOfFreedomAgreeWithTheReference) {
  const fem::Body body(one_tetrahedron(), reference_material(), std::vector<int>{1, 2, 3},
                       fem::AnchorTreatment::removed);
  const ElasticBody elastic(body, LawKind::linear);
  const Eigen::Map<const Eigen::Matrix3d> k(body.stiffness().block(0));
  const test::SymmetricModes modes = test::symmetric_modes(k);
  const double mass = 1000 * 120e-9 / 4;
  for (int mode = 0; mode < 3; ++mode) {
    const double omega = std::sqrt(modes.values[mode] / mass);
    const Vector3d along = 1e-3 * modes.vectors.col(mode);
    CentralDifferences dynamics(elastic, std::vector<double>(3), 2 * 0.05 * omega, 0.5 / omega);
    EXPECT_NEAR(dynamics.mass()[0], mass, 1e-18);
    dynamics.set_state(std::span(along.data(), 3), std::vector<double>(3));
    for (const double expected :
         {+0.875000000000, +0.542682926829, +0.094214753123, -0.355356132383, -0.696324503382}) {
      ASSERT_TRUE(dynamics.step(1).complete());
      const Eigen::Map<const Vector3d> u(dynamics.displacement().data());
      EXPECT_NEAR(u.dot(along) / along.squaredNorm(), expected, 2e-12);
      EXPECT_LT((u - expected * along).norm(), 1e-14);
    }
  }
}

// Mass damping settles at the static equilibrium: two seconds of the reference's run, and Newton.
TEST(CentralDifferences, WithDampingEndInTheStaticEquilibrium) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_isochoric);
  const std::vector<double> load = its_weight(body);
  CentralDifferences dynamics(elastic, load, 20, kStep);
  ASSERT_TRUE(dynamics.step(20000).complete());
  const Vector3d expected(-1.005922271e-03, 3.032132185e-03, -1.407895350e-02);
  EXPECT_LT((tip(dynamics) - expected).norm(), 1e-11);

  std::vector<double> u(load.size());
  ASSERT_TRUE(StaticEquilibrium(elastic).solve(load, {}, u).converged());
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(dynamics.displacement()[i], u[i], 5e-11);
}

TEST(CentralDifferences, AreOfSecondOrder) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_log);
  std::vector<double> v(body.load().size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = i % 3 == 2 ? 0.02 * body.mesh().nodes[at(body.node_of_active()[i / 3])].x() / 0.04 : 0;
  }
  const auto end = [&](int substeps) {
    CentralDifferences dynamics(elastic, its_weight(body), 5, 0.03 / substeps);
    const std::vector<double> u(v.size());
    dynamics.set_state(u, v);
    EXPECT_TRUE(dynamics.step(substeps).complete());
    std::vector<double> velocity(v.size());
    dynamics.velocity(velocity);
    return std::pair(tip(dynamics), velocity.back());
  };
  const auto a = end(400);
  const auto b = end(800);
  const auto c = end(1600);
  EXPECT_NEAR((a.first - b.first).norm() / (b.first - c.first).norm(), 4, 0.2);
  EXPECT_NEAR((a.second - b.second) / (b.second - c.second), 4, 0.2);
}

// At the start and after each substep, the velocity is that of the differences on both sides.
TEST(CentralDifferences, VelocityIsTheCentralOne) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::corotational);
  const std::size_t size = body.load().size();
  CentralDifferences dynamics(elastic, its_weight(body), 7, kStep);
  const std::vector<double> u = fem::noise_vector(size, 1);
  std::vector<double> start(size);
  std::vector<double> v(size);
  for (std::size_t i = 0; i < size; ++i) {
    start[i] = 1e-5 * u[i];
    v[i] = 1e-2 * fem::noise(i);
  }
  dynamics.set_state(start, v);
  std::vector<double> velocity(size);
  dynamics.velocity(velocity);
  for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(velocity[i], v[i], 1e-15);
  for (int step = 0; step < 3; ++step) {
    const std::vector<double> before(dynamics.displacement().begin(),
                                     dynamics.displacement().end());
    ASSERT_TRUE(dynamics.step(1).complete());
    dynamics.velocity(velocity);
    ASSERT_TRUE(dynamics.step(1).complete());
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(velocity[i], (dynamics.displacement()[i] - before[i]) / (2 * kStep), 1e-13);
    }
  }
}

// The beam's far face as a contact.
fem::Hold hold_of(std::span<const int> nodes, std::span<const Vector3d> displacement) {
  return {.nodes = nodes, .displacement = displacement, .let_go = {}};
}

std::vector<int> far_face(const fem::Body& body) {
  std::vector<int> face;
  for (int a = 0; a < body.active_nodes(); ++a) {
    if (body.mesh().nodes[at(body.node_of_active()[at(a)])].x() > 0.0399) face.push_back(a);
  }
  return face;
}

// Contact nodes arrive in equal parts; released, they go on with the velocity they had.
TEST(CentralDifferences, MoveHeldNodesEvenly) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_isochoric);
  const std::vector<double> none(body.load().size());
  const std::vector<int> face = far_face(body);
  ASSERT_EQ(face.size(), 9u);
  const std::vector<Vector3d> target(face.size(), Vector3d(1e-3, 2e-3, -3e-3));
  CentralDifferences whole(elastic, none, 0, kStep);
  ASSERT_TRUE(whole.step(20, hold_of(face, target)).complete());

  CentralDifferences parts(elastic, none, 0, kStep);
  for (int part = 1; part <= 4; ++part) {
    const std::vector<Vector3d> quarter(face.size(), part / 4.0 * target[0]);
    ASSERT_TRUE(parts.step(5, hold_of(face, quarter)).complete());
  }
  std::vector<double> v(none.size());
  whole.velocity(v);
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_NEAR(parts.displacement()[i], whole.displacement()[i], 1e-16);
  }
  for (const int node : face) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(whole.displacement()[3 * at(node) + at(i)], target[0][i]);
      EXPECT_NEAR(v[3 * at(node) + at(i)], target[0][i] / (20 * kStep), 1e-12);
    }
  }
  ASSERT_TRUE(whole.step(1).complete());
  const double pull = whole.internal_forces().back();  // after a substep; it has hardly changed
  const double coasted = -3e-3 - 3e-3 / 20;
  EXPECT_NEAR(tip(whole).z(), coasted, 2 * std::abs(pull) * kStep * kStep / whole.mass().back());
  EXPECT_NE(tip(whole).z(), coasted);
}

// For the linear law the force at held nodes is that of the board's contact, with K for its matrix,
// plus the drag of α at the node: what Newmark::hold() leaves of Â·u − f̂ for a lumped mass.
TEST(CentralDifferences, ReactionIsThatOfContactWithoutInertia) {
  for (const fem::AnchorTreatment treatment :
       {fem::AnchorTreatment::removed, fem::AnchorTreatment::kept}) {
    mesh::TetMesh mesh = fem::jittered_box({0.04, 0.04, 0.02}, {4, 4, 2});
    const std::vector<int> floor = fem::floor_nodes(mesh);
    const fem::Body body(std::move(mesh), reference_material(), floor, treatment);
    const ElasticBody elastic(body, LawKind::linear);
    const std::vector<double> load = its_weight(body);
    const double alpha = 30;
    CentralDifferences dynamics(elastic, load, alpha, kStep);
    const int last = body.active_nodes() - 1;
    const std::vector<int> nodes = {last - 1, last};
    const std::vector<Vector3d> target = {{0, 0, -1e-3}, {1e-3, 0, -2e-3}};
    ASSERT_TRUE(dynamics.step(20, hold_of(nodes, target)).complete());

    const fem::ContactConstraint contact(body.stiffness(), fem::ContactDiagonal::one);
    fem::HeldForces forces(body.active_nodes());
    const Vector3d found = dynamics.reaction(nodes, forces);
    Vector3d expected = contact.reaction(dynamics.displacement(), load, nodes);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      expected += alpha * dynamics.mass()[at(nodes[n])] * target[n] / (20 * kStep);
    }
    EXPECT_GT(expected.norm(), 1e-2);
    EXPECT_LT((found - expected).norm(), 1e-12);
    EXPECT_EQ(found, dynamics.reaction(nodes));
    std::vector<Vector3d> on_probe(1);
    forces.sum(hold_of(nodes, target), on_probe);
    EXPECT_EQ(on_probe[0], found);
  }
}

// What a free node feels is a load, which may change from frame to frame; at a node without hold
// the same expression is minus what accelerates it.
TEST(CentralDifferences, FollowTheLoad) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::linear);
  CentralDifferences dynamics(elastic, std::vector<double>(body.load().size()), 0, kStep);
  ASSERT_TRUE(dynamics.step(3).complete());
  EXPECT_EQ(tip(dynamics), Vector3d::Zero());
  dynamics.set_load(its_weight(body));
  ASSERT_TRUE(dynamics.step(1).complete());
  EXPECT_NEAR(tip(dynamics).z(), -9.81 * kStep * kStep, 1e-20);
}

// Anchored nodes that stay in the system change nothing.
TEST(CentralDifferences, AreTheSameWithKeptNodes) {
  const auto box = [](fem::AnchorTreatment treatment) {
    mesh::TetMesh mesh = fem::jittered_box({0.04, 0.04, 0.02}, {4, 4, 2});
    const std::vector<int> floor = fem::floor_nodes(mesh);
    fem::Loads loads;
    mesh::Region corner;
    corner.kind = mesh::Region::Kind::box;
    corner.low_corner = {-1, -1, 0.019};
    corner.high_corner = {0.001, 1, 1};
    loads.prescribed.push_back({.region = corner, .displacement = {0, 0, 1e-3}});
    loads.gravity = fem::Gravity{};
    return fem::Body(std::move(mesh), reference_material(), floor, treatment, loads);
  };
  const fem::Body removed = box(fem::AnchorTreatment::removed);
  const fem::Body kept = box(fem::AnchorTreatment::kept);
  const ElasticBody of_removed(removed, LawKind::neo_hookean_log);
  const ElasticBody of_kept(kept, LawKind::neo_hookean_log);
  CentralDifferences one(of_removed, removed.dead_load(), 3, kStep);
  CentralDifferences other(of_kept, kept.dead_load(), 3, kStep);
  ASSERT_TRUE(one.step(50).complete());
  ASSERT_TRUE(other.step(50).complete());
  EXPECT_EQ(removed.expand(one.displacement()), kept.expand(other.displacement()));
  EXPECT_EQ(one.kinetic_energy(), other.kinetic_energy());
  EXPECT_EQ(one.work_of_load(), other.work_of_load());
  EXPECT_EQ(one.strain_energy(), other.strain_energy());
  EXPECT_GT(one.strain_energy(), 1e-6);
  EXPECT_GT(one.work_of_load(), 1e-8);
}

// A substep whose forces are not defined is not done, and the state is still one to go on from.
TEST(CentralDifferences, DoNotEnterWhatIsNotDefined) {
  const fem::Body body = falling_beam();
  const std::vector<int> tip_node = {body.active_nodes() - 1};
  const std::vector<Vector3d> target = {{-0.02, 0, 0}};  // four cells into the beam
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    CentralDifferences dynamics(elastic, its_weight(body), 0, kStep);
    const Substeps pushed = dynamics.step(10, hold_of(tip_node, target));
    if (!elastic.needs_positive_determinant()) {
      EXPECT_GT(pushed.inverted, 0);
      EXPECT_LT(pushed.smallest_determinant, 0);
      EXPECT_TRUE(pushed.complete());
      EXPECT_EQ(pushed.undefined, 0);
      continue;
    }
    EXPECT_FALSE(pushed.complete());
    EXPECT_TRUE(pushed.undefined > 0 || pushed.exploded) << static_cast<int>(kind);
    EXPECT_GT(pushed.done, 0);
    EXPECT_NEAR(tip(dynamics).x(), -0.02 * pushed.done / 10, 1e-15);
    const std::vector<double> before(dynamics.displacement().begin(),
                                     dynamics.displacement().end());
    const double energy = dynamics.strain_energy();
    const Substeps again = dynamics.step(1, hold_of(tip_node, target));
    EXPECT_EQ(again.done, 0);
    EXPECT_TRUE(std::ranges::equal(before, dynamics.displacement()));
    EXPECT_EQ(dynamics.strain_energy(), energy);
    // Fung's law has stiffened beyond what this substep is stable for.
    if (kind == LawKind::fung) continue;
    EXPECT_TRUE(dynamics.step(1, hold_of(tip_node, std::vector{tip(dynamics)})).complete());
  }
}

// A stiffening body is thrown apart by steps that are far too long: the one that would do so is not
// done, and what is left are numbers.
TEST(CentralDifferences, DoNotThrowTheBodyApart) {
  for (const LawKind kind :
       {LawKind::linear, LawKind::corotational, LawKind::st_venant_kirchhoff}) {
    SCOPED_TRACE(static_cast<int>(kind));
    const fem::Body body = falling_beam();
    const ElasticBody elastic(body, kind);
    CentralDifferences dynamics(elastic, its_weight(body), 0, 100 * kStep);
    Substeps done;
    for (int frame = 0; frame < 300; ++frame) {
      done = dynamics.step(1);
      for (const double u : dynamics.displacement()) ASSERT_TRUE(std::isfinite(u));
      for (const double f : dynamics.internal_forces()) ASSERT_TRUE(std::isfinite(f));
    }
    EXPECT_TRUE(done.exploded);
    EXPECT_FALSE(done.complete());
    std::vector<double> v(dynamics.displacement().size());
    dynamics.velocity(v);
    for (const double value : v) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(CentralDifferences, CountOperations) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_isochoric);
  CentralDifferences dynamics(elastic, its_weight(body), 0, kStep);
  // Section 17 for an element, one factor less (operations_test.cpp); and for an active node its
  // three residuals, products with Δt²/m and (1 − αΔt/2)/(1 + αΔt/2), and two sums.
  const Operations substep{192 * 202.0 + 72 * 15, 192 * 2, 192};
  EXPECT_EQ(dynamics.step(3).operations, 3 * substep);
  const std::vector<int> nodes = {3, 4};
  const std::vector<Vector3d> target(2, Vector3d::Zero());
  EXPECT_EQ(dynamics.step(1, hold_of(nodes, target)).operations,
            substep + (Operations{2 * 12, 1, 0}));
  EXPECT_EQ(dynamics.reaction_flops(nodes), 24);
}

TEST(CentralDifferences, DoNotAllocate) {
  const fem::Body body = falling_beam();
  const std::vector<double> load = its_weight(body);
  const std::vector<int> nodes = far_face(body);
  const std::vector<Vector3d> target(nodes.size(), Vector3d(0, 0, 1e-4));
  std::vector<double> v(load.size());
  fem::HeldForces forces(body.active_nodes());
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    CentralDifferences dynamics(elastic, load, 1, kStep);
    const std::size_t before = test::allocation_count();
    const bool complete = dynamics.step(3, hold_of(nodes, target)).complete();
    dynamics.set_load(load);
    dynamics.velocity(v);
    const double sum = dynamics.kinetic_energy() + dynamics.strain_energy() +
                       dynamics.work_of_load() + dynamics.reaction(nodes, forces).norm();
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_TRUE(complete && std::isfinite(sum));
  }
}

TEST(CentralDifferences, RefuseWhatHasNoMeaning) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_log);
  const std::vector<double> load = its_weight(body);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double step : {0.0, -1e-4, nan, HUGE_VAL}) {
    EXPECT_THROW(CentralDifferences(elastic, load, 0, step), InputError);
  }
  for (const double alpha : {-1.0, nan, HUGE_VAL}) {
    EXPECT_THROW(CentralDifferences(elastic, load, alpha, kStep), InputError);
  }
  EXPECT_THROW(CentralDifferences(elastic, std::vector<double>(3), 0, kStep), InputError);
  CentralDifferences dynamics(elastic, load, 0, kStep);
  std::vector<double> inside_out(load.size());
  inside_out[inside_out.size() - 3] = -0.02;
  EXPECT_THROW(dynamics.set_state(inside_out, load), InputError);
}

}  // namespace
}  // namespace hvp::tissue::central_differences_test
