#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/index.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/springs.h"
#include "models/tissue/stable_step.h"
#include "models/tissue/static_equilibrium.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::regions_test {
namespace {

using Eigen::Vector3d;

// A box of 40 × 40 × 20 mm in cells of 10 mm, irregular, anchored below, with these materials in
// turn.
fem::Body box(const std::vector<fem::Material>& table) {
  mesh::TetMesh mesh = fem::jittered_box({0.04, 0.04, 0.02}, {4, 4, 2});
  const std::vector<int> floor = fem::floor_nodes(mesh);
  std::vector<int> of_element;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    of_element.push_back(static_cast<int>(e % table.size()));
  }
  return {std::move(mesh), fem::Materials(table, of_element), floor, fem::AnchorTreatment::removed};
}

const std::vector<fem::Material> kDifferent = {
    {.young_modulus_pa = 1e4, .poisson_ratio = 0.45, .density_kg_m3 = 1000},
    {.young_modulus_pa = 7e4, .poisson_ratio = 0.3, .density_kg_m3 = 1100},
    {.young_modulus_pa = 2e3, .poisson_ratio = 0.1, .density_kg_m3 = 900}};

std::vector<double> displacements(const fem::Body& body, double size) {
  std::vector<double> u(body.load().size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = size * fem::noise(i + 17);
  return body.expand(u);
}

double largest(std::span<const double> v) {
  double size = 0;
  for (const double x : v) size = std::max(size, std::abs(x));
  return size;
}

// An element's forces are those of its own law: what each adds, by itself, sums up to the body's.
TEST(RegionsOfTissue, EachElementHasItsOwnLaw) {
  const fem::Body body = box(kDifferent);
  const std::vector<double> u = displacements(body, 2e-3);
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    std::vector<double> f(u.size());
    ASSERT_TRUE(elastic.internal_forces(u, f).defined());
    std::vector<double> sum(u.size(), 0.0);
    double energy = 0;
    for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
      const Law law(kind, kDifferent[e % 3]);
      const fem::ElementGeometry geometry = fem::element_geometry(body.mesh(), static_cast<int>(e));
      Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
      for (std::size_t a = 0; a < 4; ++a) {
        gradient += Eigen::Map<const Vector3d>(&u[3 * at(body.mesh().tetrahedra[e][a])]) *
                    geometry.gradient[a].transpose();
      }
      energy += geometry.volume() * law.energy(gradient).value();
      for (std::size_t a = 0; a < 4; ++a) {
        const Vector3d force =
            geometry.volume() * law.stress(gradient).value() * geometry.gradient[a];
        for (int i = 0; i < 3; ++i) sum[3 * at(body.mesh().tetrahedra[e][a]) + at(i)] += force[i];
      }
    }
    const double scale = largest(sum);
    for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], sum[i], 1e-12 * scale);
    double found = 0;
    ASSERT_TRUE(elastic.energy(u, found).defined());
    EXPECT_NEAR(found, energy, 1e-12 * energy);
  }
}

TEST(RegionsOfTissue, OfEqualMaterialsAreNone) {
  const fem::Material one{.young_modulus_pa = 7331, .poisson_ratio = 0.37, .density_kg_m3 = 1041};
  const fem::Body uniform = box({one});
  const fem::Body several = box({one, one, one});
  const std::vector<double> u = displacements(uniform, 2e-3);
  const std::vector<double> v = displacements(uniform, 0.1);
  for (const LawKind kind : kLaws) {
    const ElasticBody a(uniform, kind);
    const ElasticBody b(several, kind);
    std::vector<double> fa(u.size());
    std::vector<double> fb(u.size());
    const Motion motion{.u = u, .v = v, .damping_s = 1e-3};
    const Deformation of_a = a.forces(motion, fa, {});
    const Deformation of_b = b.forces(motion, fb, {});
    EXPECT_EQ(fa, fb);
    EXPECT_EQ(of_a.operations, of_b.operations);
    sparse::BlockMatrix ka = uniform.stiffness();
    sparse::BlockMatrix kb = ka;
    ASSERT_TRUE(a.tangent(u, Linearisation::exact, ka).defined());
    ASSERT_TRUE(b.tangent(u, Linearisation::exact, kb).defined());
    EXPECT_EQ(ka.value, kb.value);
  }
  std::vector<double> fa(u.size());
  std::vector<double> fb(u.size());
  ASSERT_TRUE(SpringBody(uniform).internal_forces(u, fa).defined());
  ASSERT_TRUE(SpringBody(several).internal_forces(u, fb).defined());
  EXPECT_EQ(fa, fb);
}

// Turned as a whole it has no forces, however much its parts differ.
TEST(RegionsOfTissue, ARigidMotionMakesNoForce) {
  std::vector<fem::Material> table = kDifferent;
  table[1].young_modulus_pa = 1e10;
  const fem::Body body = box(table);
  const Eigen::Matrix3d turn = reference_rotation();
  std::vector<double> u(3 * body.mesh().nodes.size());
  for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
    const Vector3d move = turn * body.mesh().nodes[n] - body.mesh().nodes[n];
    std::copy_n(move.data(), 3, &u[3 * n]);
  }
  for (const LawKind kind : kLaws) {
    if (kind == LawKind::linear) continue;
    std::vector<double> f(u.size());
    ASSERT_TRUE(ElasticBody(body, kind).internal_forces(u, f).defined());
    EXPECT_LT(largest(f), 1e10 * 0.01 * 0.01 * 1e-14) << name(kind);
  }
}

// Of small strains every law is linear elasticity with each element's constants.
TEST(RegionsOfTissue, SmallStrainsAreLinear) {
  const fem::Body body = box(kDifferent);
  const std::vector<double> u = displacements(body, 1e-10);
  std::vector<double> linear(u.size());
  fem::assemble_stiffness(body.mesh(), body.materials()).multiply(u, linear);
  for (const LawKind kind : kLaws) {
    std::vector<double> f(u.size());
    ASSERT_TRUE(ElasticBody(body, kind).internal_forces(u, f).defined());
    for (std::size_t i = 0; i < f.size(); ++i) {
      EXPECT_NEAR(f[i], linear[i], 1e-6 * largest(linear)) << name(kind);
    }
  }
}

// The tangent against differences of forces.
TEST(RegionsOfTissue, TheTangentIsTheForcesDerivative) {
  const fem::Body body = box(kDifferent);
  const std::vector<double> u = displacements(body, 1e-3);
  std::vector<double> direction(body.load().size());
  for (std::size_t i = 0; i < direction.size(); ++i) direction[i] = fem::noise(i + 991);
  const std::vector<double> way = body.expand(direction);
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    sparse::BlockMatrix k = body.stiffness();
    ASSERT_TRUE(elastic.tangent(u, Linearisation::exact, k).defined());
    std::vector<double> predicted(direction.size());
    k.multiply(direction, predicted);
    constexpr double kStep = 1e-8;
    std::vector<double> ahead = u;
    std::vector<double> behind = u;
    for (std::size_t i = 0; i < u.size(); ++i) {
      ahead[i] += kStep * way[i];
      behind[i] -= kStep * way[i];
    }
    std::vector<double> fa(u.size());
    std::vector<double> fb(u.size());
    ASSERT_TRUE(elastic.internal_forces(ahead, fa).defined());
    ASSERT_TRUE(elastic.internal_forces(behind, fb).defined());
    for (int a = 0; a < body.active_nodes(); ++a) {
      const std::size_t node = at(body.node_of_active()[at(a)]);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR((fa[3 * node + i] - fb[3 * node + i]) / (2 * kStep), predicted[3 * at(a) + i],
                    1e-5 * largest(predicted))
            << name(kind);
      }
    }
  }
}

// Damping is β times the stiffness of each element: for the linear law β·K·v.
TEST(RegionsOfTissue, DampingIsOfEachMaterial) {
  const fem::Body body = box(kDifferent);
  const std::vector<double> u(3 * body.mesh().nodes.size(), 0.0);
  const std::vector<double> v = displacements(body, 0.1);
  std::vector<double> f(u.size());
  ASSERT_TRUE(ElasticBody(body, LawKind::linear)
                  .forces({.u = u, .v = v, .damping_s = 2e-3}, f, {})
                  .defined());
  std::vector<double> kv(u.size());
  fem::assemble_stiffness(body.mesh(), body.materials()).multiply(v, kv);
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(f[i], 2e-3 * kv[i], 2e-3 * 1e-12 * largest(kv));
  }
}

// An edge has E·V of every tetrahedron round it.
TEST(RegionsOfTissue, SpringsAddUpWhatIsRoundThem) {
  const fem::Body body = box(kDifferent);
  const SpringBody springs(body);
  for (const SpringBody::Spring& spring : springs.springs()) {
    double expected = 0;
    for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
      const auto& t = body.mesh().tetrahedra[e];
      if (std::ranges::find(t, spring.node[0]) == t.end()) continue;
      if (std::ranges::find(t, spring.node[1]) == t.end()) continue;
      expected += kDifferent[e % 3].young_modulus_pa *
                  fem::element_geometry(body.mesh(), static_cast<int>(e)).volume();
    }
    expected /= spring.length * spring.length;
    EXPECT_NEAR(spring.stiffness, expected, 1e-12 * expected);
  }
}

// The stable step is that of the stiffest and lightest: bounds by elements hold, and a region of
// a hundredth of the density has a tenth of the step.
TEST(RegionsOfTissue, TheStableStepIsThatOfTheFastestPart) {
  std::vector<fem::Material> table = {{}, {}, {}};
  const fem::Body same = box(table);
  table[1].young_modulus_pa *= 100;
  const fem::Body body = box(table);
  const ElasticBody elastic(body, LawKind::linear);
  const std::vector<double> rest(body.load().size(), 0.0);
  const double exact = largest_frequency(elastic, rest).stable_step_s();
  const double element = element_step(elastic, body.expand(rest));
  EXPECT_LT(element, exact);
  EXPECT_LE(closed_form_step(body.mesh(), body.materials()), element);
  const ElasticBody of_same(same, LawKind::linear);
  EXPECT_LT(exact, 0.3 * largest_frequency(of_same, rest).stable_step_s());
  EXPECT_GE(exact, 0.1 * largest_frequency(of_same, rest).stable_step_s());
}

// The force on a plate over a stack of two layers, for a law that is not linear: with ν = 0 each
// layer is a column by itself, and St Venant-Kirchhoff's stress P = E·F·(F² − 1)/2 is the same in
// both.
TEST(RegionsOfTissue, LayersCarryTheSameStressAtLargeStrain) {
  mesh::TetMesh mesh = fem::structured_box({0.01, 0.01, 0.02}, {2, 2, 4});
  const fem::Material soft{.young_modulus_pa = 1e4, .poisson_ratio = 0};
  const fem::Material stiff{.young_modulus_pa = 4e4, .poisson_ratio = 0};
  std::vector<int> of_element;
  std::vector<int> top;
  for (const auto& t : mesh.tetrahedra) {
    double z = 0;
    for (const int node : t) z += mesh.nodes[at(node)].z() / 4;
    of_element.push_back(z > 0.01 ? 1 : 0);
  }
  const std::vector<int> floor = fem::floor_nodes(mesh);
  const fem::Body body(mesh, fem::Materials({soft, stiff}, of_element), floor,
                       fem::AnchorTreatment::removed);
  std::vector<Vector3d> down;
  for (int a = 0; a < body.active_nodes(); ++a) {
    if (mesh.nodes[at(body.node_of_active()[at(a)])].z() < 0.0199999) continue;
    top.push_back(a);
    down.emplace_back(0, 0, -0.002);
  }
  const ElasticBody elastic(body, LawKind::st_venant_kirchhoff);
  StaticEquilibrium equilibrium(elastic);
  std::vector<double> u(body.load().size());
  fem::Hold hold;
  hold.nodes = top;
  hold.displacement = down;
  ASSERT_TRUE(equilibrium.solve(body.load(), hold, u).converged());
  double force = 0;
  for (const int a : top) {
    force -= equilibrium.internal_forces()[3 * at(body.node_of_active()[at(a)]) + 2];
  }
  // The stretches F₁ + F₂ = 2 − 0.2 of equal stress, by bisection.
  const auto stress = [](double e, double f) { return e * f * (f * f - 1) / 2; };
  double low = 0.8;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double f = (low + high) / 2;
    (stress(1e4, f) < stress(4e4, 1.8 - f) ? low : high) = f;
  }
  EXPECT_NEAR(force, -stress(1e4, low) * 1e-4, 1e-8 * force);
}

// Inertia keeps an element's tangent definite: that of its own region, and of no other.
TEST(RegionsOfTissue, SupportEachElementByItsOwnDensity) {
  fem::Material light{.young_modulus_pa = 1e4, .poisson_ratio = 0.45, .density_kg_m3 = 1};
  fem::Material heavy = light;
  heavy.density_kg_m3 = 1e9;
  const auto projected = [](const fem::Body& body) {
    std::vector<double> squeezed(3 * body.mesh().nodes.size());
    for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
      const Vector3d& x = body.mesh().nodes[n];
      for (int i = 0; i < 3; ++i) squeezed[3 * n + at(i)] = (i == 2 ? -0.1 : -0.2) * x[i];
    }
    const ElasticBody elastic(body, LawKind::neo_hookean_isochoric);
    sparse::BlockMatrix k = body.stiffness();
    return elastic.supported_tangent(squeezed, 1e6, k).projected;
  };
  const int all = projected(box({light}));
  EXPECT_GT(all, 100);
  EXPECT_EQ(projected(box({heavy})), 0);
  EXPECT_EQ(projected(box({light, heavy})), all / 2);
  EXPECT_EQ(projected(box({heavy, light})), all / 2);
}

}  // namespace
}  // namespace hvp::tissue::regions_test
