#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/collision/proxy_contact.h"
#include "tests/collision/glide_block.h"

namespace hvp::collision::proxy_glide_test {
namespace {

using Eigen::Vector3d;
using test::Glide;
using test::normal_force;
using test::tangential_force;

// What glides as docs/collision.md says: 2 mm deep, 25 mm at 50 mm/s and 500 Hz, 3 mm beside the
// middle, on which the mesh has nodes.
TEST(ProxyGlide, GlidesEvenly) {
  Glide glide({});
  Vector3d tip = glide.at_top(0.0175, 0.033);
  glide.begin({tip});
  glide.move(tip, glide.at_top(0.0175, 0.033, 0.002), 1e-4);
  std::vector<double> force;
  glide.move(tip, glide.at_top(0.0425, 0.033, 0.002), 1e-4, [&](const auto& probe, const auto&) {
    if (!probe.sliding) return;
    force.push_back(probe.force.norm());
    const double ratio = tangential_force(probe) / normal_force(probe);
    EXPECT_LT(std::abs(ratio - 0.3), 1e-12);
    EXPECT_FALSE(probe.off_cone);
    EXPECT_FALSE(probe.at_rim);
  });
  ASSERT_GT(force.size(), 200u);
  double mean = 0;
  for (const double f : force) mean += f / static_cast<double>(force.size());
  const auto range = [&](std::size_t window) {
    double widest = 0;
    for (std::size_t i = 0; i + window <= force.size(); ++i) {
      const auto [low, high] = std::minmax_element(force.begin() + static_cast<long>(i),
                                                   force.begin() + static_cast<long>(i + window));
      widest = std::max(widest, *high - *low);
    }
    return widest / mean;
  };
  EXPECT_LT(range(16), 1.3 * 0.02);
  EXPECT_LT(range(force.size()), 1.3 * 0.04);
}

// A tip that presses on a side face and rises above the top is behind the face's plane, and in the
// air.
TEST(ProxyGlide, LetsGoOfATipThatIsOutsideOfTheBody) {
  for (const double friction : {0.0, 0.3, 1e6}) {
    Glide glide({.friction = friction});
    Vector3d tip(0.06, 0.033, 0.02);
    glide.begin({tip});
    glide.move(tip, {0.05, 0.033, 0.02}, 1e-4);
    EXPECT_GT(glide.contact.probes()[0].force.norm(), 0.1);
    glide.move(tip, {0.05, 0.033, 0.035}, 1e-4);
    EXPECT_FALSE(glide.contact.probes()[0].spot.present()) << friction;
    EXPECT_EQ(glide.contact.probes()[0].force, Vector3d::Zero());
  }
}

// The force does not step where X goes into another triangle.
TEST(ProxyGlide, DoesNotStepBetweenTriangles) {
  double at_changes[2] = {};
  for (const int slower : {1, 10}) {
    Glide glide({});
    Vector3d tip = glide.at_top(0.0175, 0.033);
    glide.begin({tip});
    glide.move(tip, glide.at_top(0.0175, 0.033, 0.002), 1e-4);
    glide.move(tip, glide.at_top(0.025, 0.033, 0.002), 1e-4);
    Vector3d last = glide.contact.probes()[0].force;
    int triangle = glide.contact.probes()[0].spot.triangle;
    int changes = 0;
    double elsewhere = 0;
    double& largest = at_changes[slower == 1 ? 0 : 1];
    glide.move(tip, glide.at_top(0.0425, 0.033, 0.002), 1e-4 / slower,
               [&](const auto& probe, const auto&) {
                 const double step = (probe.force - last).norm() / last.norm();
                 if (probe.spot.triangle != triangle) {
                   ++changes;
                   largest = std::max(largest, step);
                 } else {
                   elsewhere = std::max(elsewhere, step);
                 }
                 last = probe.force;
                 triangle = probe.spot.triangle;
               });
    EXPECT_GE(changes, 3);
    EXPECT_LE(largest, 1.2 * elsewhere);
  }
  EXPECT_LT(at_changes[0], 0.0015);
  EXPECT_LT(at_changes[1], 0.2 * at_changes[0]);
}

// The surface is where the last frame has pressed it when the tip lifts by more than its gap: the
// body follows, as it is pressed there on the way down.
TEST(ProxyGlide, FollowsATipThatLiftsByMoreThanItsGap) {
  Glide glide({});
  Vector3d tip = glide.at_top(0.031, 0.032);
  glide.begin({tip});
  glide.move(tip, glide.at_top(0.031, 0.032, 0.001), 1e-4);
  const Vector3d pressed = glide.contact.probes()[0].force;
  glide.move(tip, glide.at_top(0.031, 0.032, 0.004), 1e-4);
  ASSERT_LT(glide.contact.probes()[0].gap.norm(), 0.003);
  glide.move(tip, glide.at_top(0.031, 0.032, 0.001), 0.003);
  EXPECT_TRUE(glide.contact.probes()[0].spot.present());
  EXPECT_LT((glide.contact.probes()[0].force - pressed).norm(), 1e-9 * pressed.norm());
}

// Without friction the hand gets back what it gave. A point that is hard makes energy between its
// node and the middle of a triangle; in the middle of the block the proxy does not.
TEST(ProxyGlide, MakesNoEnergyWithoutFriction) {
  Glide glide({.friction = 0});
  Vector3d tip = glide.at_top(0.03, 0.03);
  glide.begin({tip});
  double work = 0;
  Vector3d last_tip = tip;
  Vector3d last = glide.contact.probes()[0].force;
  const auto add = [&](const ProxyContact::Probe& probe, const Vector3d& to) {
    work += 0.5 * (probe.force + last).dot(to - last_tip);
    last = probe.force;
    last_tip = to;
    EXPECT_LT(tangential_force(probe), 1e-12);
  };
  glide.move(tip, glide.at_top(0.03, 0.03, 0.002), 2e-5, add);
  const double pressed = work;
  EXPECT_GT(pressed, 2e-4);
  glide.move(tip, glide.at_top(0.0333, 0.0317, 0.002), 2e-5, add);
  glide.move(tip, glide.at_top(0.0333, 0.0317, -1e-4), 2e-5, add);
  EXPECT_FALSE(glide.contact.probes()[0].spot.present());
  EXPECT_LT(std::abs(work), 0.01 * pressed);
}

// Round a square with friction: the second lap begins and ends with the same forces, so that its
// work is ∮λ·dX of friction and, as the compliance changes on the way, ½∮λᵀ·dM·λ. The former is a
// little less than µ∮λₙ·ds, because X does not move quite as the friction points; the latter is
// small, but not zero: a load beside the middle of the block tilts it.
TEST(ProxyGlide, WorkOfALapIsThatOfFriction) {
  Glide glide({});
  const std::vector<Vector3d> square = {
      glide.at_top(0.025, 0.025, 0.002), glide.at_top(0.035, 0.025, 0.002),
      glide.at_top(0.035, 0.035, 0.002), glide.at_top(0.025, 0.035, 0.002)};
  Vector3d tip = glide.at_top(0.025, 0.025);
  glide.begin({tip});
  glide.move(tip, square[0], 1e-4);
  double work = 0, friction = 0, slip = 0, changes = 0;
  Vector3d last_tip = tip;
  Vector3d last = glide.contact.probes()[0].force;
  Vector3d last_place = glide.contact.walk().rest(glide.contact.probes()[0].spot);
  Eigen::Matrix3d last_m = glide.contact.compliance();
  const auto add = [&](const ProxyContact::Probe& probe, const Vector3d& to) {
    const Vector3d mean = 0.5 * (probe.force + last);
    const Vector3d place = glide.contact.walk().rest(probe.spot);
    const Eigen::Matrix3d m = glide.contact.compliance();
    work += mean.dot(to - last_tip);
    friction += 0.3 * -mean.z() * (place - last_place).norm();
    slip += mean.dot(place - last_place);
    changes += 0.5 * mean.dot((m - last_m) * mean);
    last = probe.force;
    last_tip = to;
    last_place = place;
    last_m = m;
  };
  for (int lap = 0; lap < 2; ++lap) {
    work = friction = slip = changes = 0;
    for (std::size_t i = 1; i <= 4; ++i) glide.move(tip, square[i % 4], 5e-5, add);
  }
  EXPECT_NEAR(work, friction, 0.01 * friction);
  EXPECT_NEAR(work, slip + changes, 0.001 * friction);
  EXPECT_LE(slip, friction * (1 + 1e-6));
}

// The mesh is mirrored at x = 30 mm: so is a slide.
TEST(ProxyGlide, IsMirrored) {
  const auto slide = [](bool mirrored) {
    Glide glide({.cut = fem::CellCut::mirrored});
    const auto place = [&](double x, double depth) {
      return glide.at_top(mirrored ? 0.06 - x : x, 0.0341, depth);
    };
    Vector3d tip = place(0.0181, 0);
    glide.begin({tip});
    std::vector<Vector3d> forces;
    const auto keep = [&](const ProxyContact::Probe& probe, const Vector3d&) {
      forces.push_back(probe.force);
    };
    glide.move(tip, place(0.0181, 0.002), 2e-4, keep);
    glide.move(tip, place(0.0343, 0.002), 2e-4, keep);
    return forces;
  };
  const std::vector<Vector3d> one = slide(false);
  const std::vector<Vector3d> other = slide(true);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_LT((one[i] - Vector3d(-other[i].x(), other[i].y(), other[i].z())).norm(), 1e-9) << i;
  }
}

// A tip that jumps leaves X on the cone, not before it and not beyond: when the tip then rests, so
// does X, and the friction is still whole.
TEST(ProxyGlide, StaysOnTheConeWhenTheTipJumps) {
  for (const double jump : {0.001, 0.003}) {
    for (const double friction : {0.1, 0.3}) {
      Glide glide({.friction = friction});
      Vector3d tip = glide.at_top(0.0162, 0.033);
      glide.begin({tip});
      glide.move(tip, glide.at_top(0.0162, 0.033, 0.002), 1e-4);
      const ProxyContact::Probe jumped = glide.frame({tip + Vector3d(jump, 0, 0)});
      EXPECT_TRUE(jumped.sliding);
      EXPECT_FALSE(jumped.off_cone);
      EXPECT_NEAR(tangential_force(jumped), friction * normal_force(jumped), 1e-12);
      EXPECT_GT(jumped.force.x(), 0);
      const ProxyContact::Probe& rests = glide.frame({tip + Vector3d(jump, 0, 0)});
      EXPECT_NEAR(tangential_force(rests) / normal_force(rests) / friction, 1, 0.015)
          << jump << " " << friction;
    }
  }
}

}  // namespace
}  // namespace hvp::collision::proxy_glide_test
