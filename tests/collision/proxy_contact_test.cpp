#include "models/collision/proxy_contact.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/collision/allocations.h"
#include "tests/collision/glide_block.h"

namespace hvp::collision::proxy_contact_test {
namespace {

using Eigen::Vector3d;
using test::Glide;
using test::normal_force;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// M stands for what is between the tip and the body at rest: least eigenvalue of S, and the same
// from both sides of each edge of the top.
TEST(ProxyContact, ComplianceIsThatOfTheFormula) {
  Glide glide({.friction = kInfinite, .s0 = {0.002}, .newmark = true});
  const Eigen::MatrixXd g = test::dense_inverse(glide.body.stiffness());
  const Eigen::MatrixXd inverse = test::dense_inverse(glide.matrix);
  int edges = 0;
  const auto set = [&](const SurfaceSpot& spot) {
    glide.contact.release_all();
    glide.contact.suggest(0, spot);
    std::fill(glide.u.begin(), glide.u.end(), 0);
    const Vector3d place = glide.contact.walk().rest(spot);
    const std::vector<Vector3d> at_spot = {place - 1e-6 * glide.contact.walk().normal(spot)};
    glide.contact.look(at_spot, glide.u);
    return glide.contact.probes()[0].spot;
  };
  for (int triangle = 0; triangle < static_cast<int>(glide.surface.triangles().size());
       triangle += 3) {
    if (!glide.contact.walk().touchable(triangle)) continue;
    for (const Vector3d& weight : {Vector3d(0.3, 0.3, 0.4), Vector3d(0.6, 0.1, 0.3)}) {
      const SurfaceSpot spot = set({triangle, weight});
      ASSERT_TRUE(spot.present()) << triangle;
      const Eigen::Matrix3d m = glide.contact.compliance();
      const Eigen::Matrix3d w = glide.between(inverse, spot, spot);
      const Eigen::Matrix3d s = m - w;
      ASSERT_LT((s - glide.coupling(g, spot, 0.002)).norm(), 1e-9 * m.norm());
      ASSERT_LT((m - m.transpose()).norm(), 1e-12 * m.norm());
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(s);
      ASSERT_GT(eigen.eigenvalues().minCoeff(), 0.002 * (1 - 1e-9));
    }
    // From either side of an edge, a millionth away from it.
    constexpr double kAside = 1e-6;
    const int across = glide.surface.neighbours(triangle)[0];
    if (!glide.contact.walk().touchable(across)) continue;
    SurfaceSpot other{across, Vector3d::Constant(kAside)};
    const SurfaceSpot own{triangle, Vector3d(0.3, 0.7 - kAside, kAside)};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 2; ++k) {
        const int node = glide.surface.triangles()[at(triangle)][at(k)];
        if (glide.surface.triangles()[at(across)][at(i)] == node) other.weight[i] = own.weight[k];
      }
    }
    // Not round the block's own edges, where the tip is nearer to the other face.
    const SurfaceWalk& walk = glide.contact.walk();
    if (walk.normal(own).dot(walk.normal(other)) < 0.99) continue;
    ASSERT_TRUE(set(own).present());
    const Eigen::Matrix3d m = glide.contact.compliance();
    ASSERT_TRUE(set(other).present());
    ASSERT_EQ(glide.contact.probes()[0].spot.triangle, across);
    ASSERT_LT((glide.contact.compliance() - m).norm(), 10 * kAside * m.norm());
    ++edges;
  }
  EXPECT_GT(edges, 50);
}

TEST(ProxyContact, SticksWithinTheCone) {
  for (const double friction : {0.3, kInfinite}) {
    Glide glide({.friction = friction, .s0 = {0.001}});
    Vector3d tip = glide.at_top(0.0262, 0.033);
    glide.begin({tip});
    glide.move(tip, glide.at_top(0.0262, 0.033, 0.002), 1e-4);
    const ProxyContact::Probe before = glide.contact.probes()[0];
    const Eigen::MatrixXd m = glide.compliance();
    EXPECT_LT((glide.contact.compliance() - m).norm(), 1e-9 * m.norm());
    const Vector3d dx(friction > 1 ? 0.006 : 1e-4, 2e-5, 0);
    const ProxyContact::Probe& after = glide.frame({tip + dx});
    EXPECT_FALSE(after.sliding);
    EXPECT_EQ(after.spot, before.spot);
    const Vector3d expected = m.inverse() * dx;
    EXPECT_LT((after.force - before.force - expected).norm(), 1e-9 * expected.norm());
    EXPECT_NEAR(after.gap.norm(),
                (glide.coupling(test::dense_inverse(glide.body.stiffness()), after.spot, 0.001) *
                 after.force)
                    .norm(),
                1e-12);
  }
}

TEST(ProxyContact, TwoProbesAreOneSystem) {
  for (const bool newmark : {false, true}) {
    double near = 0;
    // In the same triangle, in neighbouring cells, and at opposite ends of the top.
    for (const double apart : {0.001, 0.012, 0.044}) {
      const std::vector<double> s0 = {0.001, 0.003};
      Glide glide({.friction = kInfinite, .s0 = s0, .edge = 0.015, .newmark = newmark});
      const double y = 0.0331;
      const std::vector<Vector3d> start = {glide.at_top(0.0082, y),
                                           glide.at_top(0.0082 + apart, y)};
      glide.begin({start[0] + Vector3d(0, 0, 1e-3), start[1] + Vector3d(0, 0, 1e-3)});
      for (std::size_t i = 0; i < glide.free.size(); ++i) glide.free[i] = 1e-4 * fem::noise(i);
      const std::vector<Vector3d> tips = {start[0] + Vector3d(3e-4, 0, -0.003),
                                          start[1] + Vector3d(0, 4e-4, -0.0025)};
      const std::vector<double> started = glide.u;
      glide.frame(tips);
      ASSERT_TRUE(glide.contact.probes()[0].spot.present());
      ASSERT_TRUE(glide.contact.probes()[1].spot.present());
      const Eigen::MatrixXd m = glide.compliance();
      Eigen::VectorXd d(6), forces(6);
      for (int p = 0; p < 2; ++p) {
        const SurfaceSpot& spot = glide.contact.probes()[at(p)].spot;
        const std::vector<double> full = glide.body.expand(glide.free);
        d.segment<3>(3 * p) = tips[at(p)] - glide.contact.walk().rest(spot);
        for (int i = 0; i < 3; ++i) {
          const int node = glide.surface.triangles()[at(spot.triangle)][at(i)];
          d.segment<3>(3 * p) -= spot.weight[i] * Vector3d(&full[3 * at(node)]);
        }
        forces.segment<3>(3 * p) = glide.contact.probes()[at(p)].force;
      }
      const Eigen::VectorXd expected = m.partialPivLu().solve(d);
      EXPECT_LT((forces - expected).norm(), 1e-9 * expected.norm()) << newmark << " " << apart;
      EXPECT_LT((glide.contact.compliance() - m).norm(), 1e-9 * m.norm());
      // Of each alone, the other's force through what couples them.
      double coupling = 0;
      for (int p = 0; p < 2; ++p) {
        const int q = 1 - p;
        const Vector3d alone = m.block<3, 3>(3 * p, 3 * p).inverse() * d.segment<3>(3 * p);
        coupling = std::max(coupling, (alone - forces.segment<3>(3 * p)).norm() / alone.norm());
        Glide single({.friction = kInfinite, .s0 = {s0[at(p)]}, .edge = 0.015, .newmark = newmark});
        single.free = glide.free;
        single.u = started;
        single.contact.suggest(0, glide.contact.probes()[at(p)].spot);
        const Vector3d force = single.frame({tips[at(p)]}).force;
        EXPECT_LT((force - alone).norm(), 1e-9 * alone.norm());
        const Vector3d through = m.block<3, 3>(3 * p, 3 * p).inverse() *
                                 (m.block<3, 3>(3 * p, 3 * q) * forces.segment<3>(3 * q));
        EXPECT_LT((force - through - forces.segment<3>(3 * p)).norm(), 1e-9 * force.norm());
      }
      if (apart < 0.002) near = coupling;
      if (apart > 0.04) {
        EXPECT_LT(coupling, 0.25 * near);
      }
    }
  }
}

// A block whose edge stands highest: what is nearest to a tip far above it is on that edge, beside
// which the plane of the side face leans over the tip.
TEST(ProxyContact, DoesNotBeginInTheAirOverAnEdge) {
  for (const double height : {1.0, 0.1, 0.04}) {
    test::Glide glide({});
    for (std::size_t node = 0; node < glide.body.mesh().nodes.size(); ++node) {
      const int active = glide.body.active_index(static_cast<int>(node));
      const Vector3d& x = glide.body.mesh().nodes[node];
      if (active < 0 || x.x() < 0.05) continue;
      glide.u[3 * at(active)] = 0.002;
      glide.u[3 * at(active) + 2] = 0.004;
    }
    const Vector3d tip(0.0605, 0.033, height);
    glide.contact.suggest(0, glide.contact.walk().nearest_at_rest({0.06, 0.033, 0.025}));
    glide.contact.look(std::vector<Vector3d>{tip}, glide.u);
    EXPECT_FALSE(glide.contact.probes()[0].spot.present()) << height;
  }
}

TEST(ProxyContact, LetsGoAndNeverPulls) {
  Glide glide({});
  Vector3d tip = glide.at_top(0.0262, 0.033);
  glide.begin({tip + Vector3d(0, 0, 1e-3)});
  EXPECT_FALSE(glide.contact.probes()[0].spot.present());
  int pressed = 0;
  const auto check = [&](const ProxyContact::Probe& probe, const Vector3d&) {
    if (probe.spot.present()) {
      ++pressed;
      EXPECT_GT(normal_force(probe), 0);
    } else {
      EXPECT_EQ(probe.force, Vector3d(Vector3d::Zero()));
      EXPECT_TRUE(glide.contact.loads().empty());
    }
  };
  glide.move(tip, glide.at_top(0.0262, 0.033, 0.002), 1e-4, check);
  EXPECT_EQ(pressed, 20);
  // Away sideways and up, and down again elsewhere: it is found there.
  glide.move(tip, glide.at_top(0.0382, 0.023, -0.001), 1e-4, check);
  EXPECT_FALSE(glide.contact.probes()[0].spot.present());
  EXPECT_TRUE(glide.contact.applied().empty());
  EXPECT_EQ(*std::ranges::max_element(glide.u), 0);
  glide.move(tip, glide.at_top(0.0382, 0.023, 0.001), 1e-4, check);
  ASSERT_TRUE(glide.contact.probes()[0].spot.present());
  EXPECT_LT(
      (glide.contact.walk().rest(glide.contact.probes()[0].spot) - glide.at_top(0.0382, 0.023))
          .norm(),
      2e-4);
  // At once.
  check(glide.frame({glide.at_top(0.0382, 0.023, -0.02)}), tip);
  EXPECT_FALSE(glide.contact.probes()[0].spot.present());
}

// The loads that are in u1 are taken out of it, also where X slides from triangle to triangle and
// where one of two probes has left.
TEST(ProxyContact, TakesTheLastLoadsOutOfTheSolution) {
  for (const bool newmark : {false, true}) {
    Glide one({.s0 = {0.001, 0.001}, .newmark = newmark});
    Glide other({.s0 = {0.001, 0.001}, .newmark = newmark});
    one.begin({one.at_top(0.0182, 0.033), one.at_top(0.04, 0.02)});
    other.begin({one.at_top(0.0182, 0.033), one.at_top(0.04, 0.02)});
    int seen = 0;
    for (int i = 0; i < 60; ++i) {
      const std::vector<Vector3d> tips = {
          one.at_top(0.0182 + 3e-4 * i, 0.033, 1e-4 * std::min(i, 20)),
          one.at_top(0.04, 0.02 + 2e-4 * i, 2e-3 - 1e-4 * i)};
      for (std::size_t k = 0; k < one.free.size(); ++k) {
        one.free[k] = other.free[k] = 1e-5 * std::sin(0.1 * i) * fem::noise(k);
      }
      one.frame(tips);
      std::vector<double> u1(other.u.size());
      fem::add_loads(other.contact.applied(), u1);
      other.solver.solve(u1, u1);
      for (std::size_t k = 0; k < u1.size(); ++k) u1[k] += other.free[k];
      other.contact.look(tips, other.u);
      other.contact.solve(tips, u1);
      other.contact.apply();
      other.u = one.u;
      for (std::size_t p = 0; p < 2; ++p) {
        const ProxyContact::Probe& a = one.contact.probes()[p];
        const ProxyContact::Probe& b = other.contact.probes()[p];
        ASSERT_EQ(a.spot.present(), b.spot.present()) << i;
        ASSERT_LE((a.force - b.force).norm(), 1e-9 * one.contact.probes()[0].force.norm()) << i;
        if (a.spot.present()) ++seen;
      }
    }
    EXPECT_GT(seen, 70);
    EXPECT_FALSE(one.contact.probes()[1].spot.present());
  }
}

TEST(ProxyContact, AllocatesNothing) {
  for (const std::size_t table : {SurfaceCompliance::kLargestTable, std::size_t{0}}) {
    Glide glide({.s0 = {0.001, 0.001}, .table = table});
    std::vector<Vector3d> tips = {glide.at_top(0.0182, 0.033), glide.at_top(0.04, 0.02)};
    glide.begin(tips);
    const long before = test::allocations();
    for (int i = 0; i < 60; ++i) {
      tips[0] = glide.at_top(0.0182 + 3e-4 * i, 0.033, 1e-4 * std::min(i, 20));
      tips[1] = glide.at_top(0.04, 0.02 + 2e-4 * i, 1e-3 * std::cos(0.2 * i));
      glide.contact.look(tips, glide.u);
      glide.contact.solve_free(tips, glide.free);
      EXPECT_GT(glide.contact.operations(), 0);
      glide.contact.apply();
    }
    EXPECT_EQ(test::allocations(), before);
    EXPECT_TRUE(glide.contact.probes()[0].sliding);
  }
}

TEST(ProxyContact, RejectsATipThatIsNotFinite) {
  Glide glide({});
  const Vector3d tip = glide.at_top(0.0262, 0.033, 0.001);
  glide.begin({tip});
  const Vector3d force = glide.contact.probes()[0].force;
  for (const double value : {std::nan(""), kInfinite}) {
    const std::vector<Vector3d> tips = {tip + Vector3d(0, value, 0)};
    EXPECT_THROW(glide.contact.look(tips, glide.u), InputError);
    EXPECT_THROW(glide.contact.solve_free(tips, glide.free), InputError);
    EXPECT_THROW(glide.contact.solve(tips, glide.u), InputError);
  }
  EXPECT_LT((glide.frame({tip}).force - force).norm(), 1e-12 * force.norm());
}

}  // namespace
}  // namespace hvp::collision::proxy_contact_test
