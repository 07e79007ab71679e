#include "models/tissue/elastic_body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/index.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::elastic_body_test {
namespace {

using fem::AnchorTreatment;
using fem::Body;
using fem::floor_nodes;
using fem::jittered_box;
using fem::noise;

// A box of 40 × 40 × 20 mm in cells of 10 mm, irregular, anchored below.
Body box(AnchorTreatment treatment = AnchorTreatment::removed) {
  mesh::TetMesh mesh = jittered_box({0.04, 0.04, 0.02}, {4, 4, 2});
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), reference_material(), floor, treatment);
}

constexpr double kForceScale = 1e4 * 0.01 * 0.01;  // E·h², N

double norm(std::span<const double> v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

// Displacements of all mesh nodes of up to `size` m in every direction; none where held.
std::vector<double> displacements(const Body& body, double size) {
  std::vector<double> u(body.load().size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = size * noise(i + 17);
  return body.expand(u);
}

std::vector<double> forces(const ElasticBody& body, std::span<const double> u) {
  std::vector<double> f(u.size());
  EXPECT_TRUE(body.internal_forces(u, f).defined());
  return f;
}

TEST(ElasticBody, OfTheLinearLawIsTheStiffness) {
  for (const AnchorTreatment treatment : {AnchorTreatment::removed, AnchorTreatment::kept}) {
    const Body body = box(treatment);
    const ElasticBody elastic(body, LawKind::linear);
    sparse::BlockMatrix k = body.stiffness();
    const std::vector<double> u = displacements(body, 1e-3);
    ASSERT_TRUE(elastic.tangent(u, Linearisation::exact, k).defined());
    EXPECT_EQ(k.value, body.stiffness().value);

    const std::vector<double> f = forces(elastic, u);
    std::vector<double> ku(u.size());
    fem::assemble_stiffness(body.mesh(), body.material()).multiply(u, ku);
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], ku[i], 1e-14 * kForceScale * 10);
  }
}

// Turned as a whole, and moved, a body has no forces; linear elasticity has.
TEST(ElasticBody, ARigidMotionMakesNoForce) {
  const Body body = box();
  const Eigen::Matrix3d turn = reference_rotation();
  std::vector<double> u(3 * body.mesh().nodes.size());
  for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
    const Eigen::Vector3d& x = body.mesh().nodes[n];
    const Eigen::Vector3d move = turn * x - x + Eigen::Vector3d(0.02, -0.03, 0.05);
    std::copy_n(move.data(), 3, &u[3 * n]);
  }
  for (const LawKind kind : kLaws) {
    const double force = norm(forces(ElasticBody(body, kind), u));
    if (kind == LawKind::linear) {
      EXPECT_GT(force, kForceScale);
    } else {
      EXPECT_LT(force, 1e-10 * kForceScale);
    }
  }
}

// What is inside a body moves and turns it nowhere.
TEST(ElasticBody, ForcesAreInEquilibrium) {
  const Body body = box();
  const std::vector<double> u = displacements(body, 1e-3);
  for (const LawKind kind : kLaws) {
    const std::vector<double> f = forces(ElasticBody(body, kind), u);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
      const Eigen::Vector3d one = Eigen::Map<const Eigen::Vector3d>(&f[3 * n]);
      const Eigen::Vector3d place =
          body.mesh().nodes[n] + Eigen::Map<const Eigen::Vector3d>(&u[3 * n]);
      force += one;
      moment += place.cross(one);
    }
    EXPECT_GT(norm(f), kForceScale);
    EXPECT_LT(force.norm(), 1e-12 * kForceScale);
    // Those of the linear law are in equilibrium on the body at rest.
    if (kind != LawKind::linear) {
      EXPECT_LT(moment.norm(), 1e-12 * kForceScale * 0.04);
    }
  }
}

// One step of a central difference of `call` along `way`, over all entries, and its error against
// `slope`: it falls to a quarter with half the step.
template <class Call>
void expect_derivative(const Call& call, std::span<const double> slope, double tolerance) {
  const auto error = [&](double h) {
    const std::vector<double> plus = call(h);
    const std::vector<double> minus = call(-h);
    std::vector<double> difference(slope.size());
    for (std::size_t i = 0; i < slope.size(); ++i) {
      difference[i] = (plus[i] - minus[i]) / (2 * h) - slope[i];
    }
    return norm(difference) / norm(slope);
  };
  const double coarse = error(0.02);
  if (tolerance > 0) {
    EXPECT_LT(coarse, tolerance);
  } else {
    EXPECT_NEAR(coarse / error(0.01), 4, 0.1);
  }
}

TEST(ElasticBody, ForcesAndTangentAreDerivatives) {
  const Body body = box();
  const std::vector<double> u = displacements(body, 1e-3);
  std::vector<double> way(body.load().size());  // m
  for (std::size_t i = 0; i < way.size(); ++i) way[i] = 1e-3 * noise(i + 3000);
  const std::vector<double> way_of_all = body.expand(way);
  const auto moved = [&](double h) {
    std::vector<double> there = u;
    for (std::size_t i = 0; i < there.size(); ++i) there[i] += h * way_of_all[i];
    return there;
  };
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    const double exact = kind == LawKind::linear ? 1e-9 : 0;
    const std::vector<double> f = forces(elastic, u);
    double power = 0;
    for (std::size_t i = 0; i < f.size(); ++i) power += f[i] * way_of_all[i];
    const auto energy_at = [&](double h) {
      double energy = 0;
      EXPECT_TRUE(elastic.energy(moved(h), energy).defined());
      return std::vector<double>{energy};
    };
    expect_derivative(energy_at, std::vector<double>{power}, exact);

    sparse::BlockMatrix k = body.stiffness();
    ASSERT_TRUE(elastic.tangent(u, Linearisation::exact, k).defined());
    std::vector<double> slope(way.size());
    k.multiply(way, slope);
    const auto forces_at = [&](double h) {
      const std::vector<double> all = forces(elastic, moved(h));
      std::vector<double> active(way.size());
      for (int a = 0; a < body.active_nodes(); ++a) {
        std::copy_n(&all[3 * at(body.node_of_active()[at(a)])], 3, &active[3 * at(a)]);
      }
      return active;
    };
    expect_derivative(forces_at, slope, exact);
  }
}

// A system whose held nodes are kept has theirs decoupled, with the stiffness' own diagonal.
TEST(ElasticBody, KeptNodesAreDecoupled) {
  const Body removed = box();
  const Body kept = box(AnchorTreatment::kept);
  for (const LawKind kind : kLaws) {
    sparse::BlockMatrix small = removed.stiffness();
    sparse::BlockMatrix whole = kept.stiffness();
    const std::vector<double> u = displacements(removed, 1e-3);
    ASSERT_TRUE(ElasticBody(removed, kind).tangent(u, Linearisation::exact, small).defined());
    ASSERT_TRUE(ElasticBody(kept, kind).tangent(u, Linearisation::exact, whole).defined());
    EXPECT_EQ(whole.submatrix(removed.node_of_active()).value, small.value);
    for (const int node : kept.anchored()) {
      for (int k = whole.row_begin[at(node)]; k < whole.row_begin[at(node) + 1]; ++k) {
        const double expected =
            whole.column[at(k)] == node ? kept.stiffness().block(at(k))[0] : 0.0;
        for (std::size_t i = 0; i < 9; ++i) {
          EXPECT_EQ(whole.block(at(k))[i], i % 4 == 0 ? expected : 0.0);
        }
      }
    }
  }
}

// F of an element from the displacements of all mesh nodes.
Eigen::Matrix3d gradient_of(const Body& body, std::size_t element, std::span<const double> u) {
  const fem::ElementGeometry geometry =
      fem::element_geometry(body.mesh(), static_cast<int>(element));
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  for (std::size_t a = 0; a < 4; ++a) {
    f += Eigen::Map<const Eigen::Vector3d>(&u[3 * at(body.mesh().tetrahedra[element][a])]) *
         geometry.gradient[a].transpose();
  }
  return f;
}

// One node of the upper face is pushed down: until its flattest element has a hundredth of its
// volume, a little further, and through the whole body.
TEST(ElasticBody, SaysWhichElementsAreInverted) {
  const Body body = box();
  const auto top = static_cast<std::size_t>(
      std::find_if(body.mesh().nodes.begin(), body.mesh().nodes.end(),
                   [](const auto& x) { return x.z() > 0.0199 && x.x() > 0.015 && x.y() > 0.015; }) -
      body.mesh().nodes.begin());
  std::vector<double> u = displacements(body, 0);
  const auto smallest_at = [&](double depth, int& inverted) {
    u[3 * top + 2] = -depth;
    double smallest = 1;
    inverted = 0;
    for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
      const double determinant = gradient_of(body, e, u).determinant();
      if (determinant <= 0) ++inverted;
      smallest = std::min(smallest, determinant);
    }
    return smallest;
  };
  int expected = 0;
  const double flat = 0.001 / (1 - smallest_at(0.001, expected));  // det F falls evenly
  for (const double depth : {0.99 * flat, 1.01 * flat, 0.03}) {
    const double smallest = smallest_at(depth, expected);
    EXPECT_EQ(expected > 0, depth > flat);
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      std::vector<double> f(u.size());
      double energy = 0;
      sparse::BlockMatrix k = body.stiffness();
      for (const Deformation& found : {elastic.internal_forces(u, f), elastic.energy(u, energy),
                                       elastic.tangent(u, Linearisation::exact, k)}) {
        EXPECT_EQ(found.inverted, expected);
        EXPECT_NEAR(found.smallest_determinant, smallest, 1e-13);
        EXPECT_EQ(found.undefined, elastic.needs_positive_determinant() ? expected : 0);
      }
    }
  }
}

TEST(ElasticBody, WhatIsNoNumberIsNotDefined) {
  const Body body = box();
  std::vector<double> u = displacements(body, 0);
  u.back() = std::nan("");
  std::vector<double> f(u.size());
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    const Deformation found = elastic.internal_forces(u, f);
    EXPECT_TRUE(std::isnan(found.smallest_determinant));
    EXPECT_GT(found.inverted, 0);
    EXPECT_FALSE(found.defined());
  }
}

TEST(ElasticBody, CountsItsOperations) {
  const Body body = box();
  const auto elements = static_cast<double>(body.mesh().tetrahedra.size());
  const std::vector<double> u = displacements(body, 1e-4);
  std::vector<double> f(u.size());
  const ElasticBody iso(body, LawKind::neo_hookean_isochoric);
  EXPECT_EQ(iso.internal_forces(u, f).operations,
            elements * (kDeformationGradient + NeoHookeanIsochoric::kStress + kAddForces));
  double energy = 0;
  EXPECT_EQ(iso.energy(u, energy).operations,
            elements * (kDeformationGradient + NeoHookeanIsochoric::kEnergy + Operations{2, 0, 0}));
  // The blocks of pairs of free nodes are added, no others.
  double added = 0;
  for (const auto& nodes : body.mesh().tetrahedra) {
    for (const int a : nodes) {
      for (const int b : nodes) added += body.held(a) || body.held(b) ? 0 : 9;
    }
  }
  sparse::BlockMatrix k = body.stiffness();
  EXPECT_EQ(iso.tangent(u, Linearisation::exact, k).operations,
            elements * (kDeformationGradient + NeoHookeanIsochoric::kTangent) +
                (Operations{added, 0, 0}));
}

TEST(ElasticBody, CallsDoNotAllocate) {
  const Body body = box();
  std::vector<double> u = displacements(body, 1e-3);
  std::vector<double> f(u.size());
  double energy = 0;
  sparse::BlockMatrix k = body.stiffness();
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    const std::size_t before = test::allocation_count();
    const bool defined = elastic.internal_forces(u, f).defined() &&
                         elastic.energy(u, energy).defined() &&
                         elastic.tangent(u, Linearisation::exact, k).defined() &&
                         elastic.tangent(u, Linearisation::warped, k).defined();
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_TRUE(defined);
  }
}

}  // namespace
}  // namespace hvp::tissue::elastic_body_test
