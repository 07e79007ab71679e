#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"
#include "models/tissue/elastic_body.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/counted.h"
#include "tests/tissue/one_tetrahedron.h"

// Every law on elements of ten nodes, with the dilatation of each point and with its mean.
namespace hvp::tissue::quadratic_elements_test {
namespace {

using fem::Body;
using fem::Elements;
using fem::noise;

constexpr Elements kBoth[] = {Elements::quadratic, Elements::mean_dilatation};
constexpr double kForceScale = 1e4 * 0.01 * 0.01;  // E·h², N

// A box of 40 × 40 × 20 mm in cells of 20 mm, irregular, anchored below.
Body box(Elements elements, const fem::Material& material = reference_material()) {
  mesh::TetMesh mesh = fem::jittered_box({0.04, 0.04, 0.02}, {2, 2, 1});
  for (Eigen::Vector3d& x : mesh.nodes) {
    if (x.z() > 0) x += 0.001 * Eigen::Vector3d(noise(at(int(1e5 * x.x()))), 0.3, noise(7));
  }
  mesh = mesh::with_mid_edge_nodes(mesh);
  const std::vector<int> floor = fem::floor_nodes(mesh);
  return Body(std::move(mesh), material, floor, fem::AnchorTreatment::removed, {}, elements);
}

Body one_element(Elements elements) {
  mesh::TetMesh mesh = mesh::with_mid_edge_nodes(one_tetrahedron());
  return Body(std::move(mesh), reference_material(), std::vector<int>{0, 1, 2},
              fem::AnchorTreatment::removed, {}, elements);
}

double norm(std::span<const double> v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

double distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

std::vector<double> displacements(const Body& body, double size) {
  std::vector<double> u(body.load().size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = size * noise(i + 17);
  return body.expand(u);
}

// u = (F − I)·x at all nodes.
std::vector<double> affine(const mesh::TetMesh& mesh, const Eigen::Matrix3d& f) {
  std::vector<double> u;
  for (const Eigen::Vector3d& x : mesh.nodes) {
    const Eigen::Vector3d moved = f * x - x;
    u.insert(u.end(), moved.begin(), moved.end());
  }
  return u;
}

std::vector<double> forces(const ElasticBody& body, std::span<const double> u) {
  std::vector<double> f(u.size());
  EXPECT_TRUE(body.internal_forces(u, f).defined());
  return f;
}

// Homogeneous deformations: tension, compression and shear of homogeneous_test.cpp, and one with a
// rotation. Each node has V·P·(mean of ∇N), whose sums over a side are those of four nodes.
TEST(QuadraticElements, OfAHomogeneousDeformationHaveItsStress) {
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 0.5;
  const std::vector<Eigen::Matrix3d> deformations = {
      Eigen::Vector3d(0.7, 1.17, 1.17).asDiagonal(), Eigen::Vector3d(1.5, 0.83, 0.83).asDiagonal(),
      shear, reference_deformation(), reference_rotation() * reference_deformation()};
  for (const Elements elements : kBoth) {
    const Body body = one_element(elements);
    const fem::ElementGeometry geometry = fem::element_geometry(body.mesh(), 0);
    const auto mean = fem::mean_gradients(geometry);
    const std::array<int, 10> node = body.mesh().ten_nodes(0);
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      const Law law(kind, reference_material());
      for (const Eigen::Matrix3d& f : deformations) {
        const std::vector<double> u = affine(body.mesh(), f);
        const std::vector<double> all = forces(elastic, u);
        const Eigen::Matrix3d stress = law.stress(f).value();
        const double scale = geometry.volume() * stress.norm() * mean[4].norm();
        for (std::size_t a = 0; a < 10; ++a) {
          const Eigen::Vector3d expected = geometry.volume() * stress * mean[a];
          const Eigen::Vector3d one = Eigen::Map<const Eigen::Vector3d>(&all[3 * at(node[a])]);
          EXPECT_LT((one - expected).norm(), 1e-10 * scale) << name(kind) << " " << a;
        }
        double energy = 0;
        ASSERT_TRUE(elastic.energy(u, energy).defined());
        EXPECT_NEAR(energy, geometry.volume() * law.energy(f).value(), 1e-12 * std::abs(energy));
      }
    }
  }
}

TEST(QuadraticElements, ARigidMotionMakesNoForce) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    std::vector<double> u = affine(body.mesh(), reference_rotation());
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += i % 3 == 0 ? 0.02 : -0.03;
    for (const LawKind kind : kLaws) {
      if (kind == LawKind::linear) continue;
      EXPECT_LT(norm(forces(ElasticBody(body, kind), u)), 1e-10 * kForceScale) << name(kind);
    }
  }
}

// At rest every law has the stiffness of the linear element, that of mean dilatation too.
TEST(QuadraticElements, OfSmallStrainAreTheLinearElements) {
  for (const Elements elements : kBoth) {
    for (const double nu : {0.0, 0.3, 0.45, 0.499}) {
      fem::Material material = reference_material();
      material.poisson_ratio = nu;
      const Body body = box(elements, material);
      const std::vector<double> u = displacements(body, 1e-9);
      const sparse::BlockMatrix whole =
          fem::assemble_quadratic_stiffness(body.mesh(), body.materials(), elements);
      std::vector<double> linear(u.size());
      whole.multiply(u, linear);
      for (const LawKind kind : kLaws) {
        const ElasticBody elastic(body, kind);
        EXPECT_LT(distance(forces(elastic, u), linear), 1e-6 * norm(linear)) << name(kind) << nu;
        for (const Linearisation one :
             {Linearisation::exact, Linearisation::warped, Linearisation::semidefinite}) {
          sparse::BlockMatrix k = body.stiffness();
          const std::vector<double> rest(u.size(), 0.0);
          ASSERT_TRUE(elastic.tangent(rest, one, k).defined());
          EXPECT_LT(distance(k.value, body.stiffness().value), 1e-12 * norm(body.stiffness().value))
              << name(kind) << nu;
        }
      }
    }
  }
}

// However far, the linear law's forces are K·u.
TEST(QuadraticElements, OfTheLinearLawAreLinear) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const ElasticBody elastic(body, LawKind::linear);
    const std::vector<double> u = displacements(body, 1e-3);
    std::vector<double> product(u.size());
    fem::assemble_quadratic_stiffness(body.mesh(), body.materials(), elements).multiply(u, product);
    EXPECT_LT(distance(forces(elastic, u), product), 1e-12 * norm(product));
  }
}

// Central differences with two steps, whose error falls to a quarter.
template <class Call>
void expect_derivative(const Call& call, std::span<const double> slope, const char* what) {
  const auto error = [&](double h) {
    const std::vector<double> plus = call(h);
    const std::vector<double> minus = call(-h);
    std::vector<double> difference(slope.size());
    for (std::size_t i = 0; i < slope.size(); ++i) difference[i] = (plus[i] - minus[i]) / (2 * h);
    return distance(difference, slope) / norm(slope);
  };
  const double coarse = error(0.02);
  const double fine = error(0.01);
  EXPECT_LT(coarse, 0.05) << what;
  // Of a linear law nothing is left but rounding.
  if (coarse > 1e-9) {
    EXPECT_NEAR(coarse / fine, 4, 0.1) << what;
  }
}

TEST(QuadraticElements, ForcesAndTangentAreDerivatives) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const std::vector<double> u = displacements(body, 8e-4);
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
      const std::vector<double> f = forces(elastic, u);
      double power = 0;
      for (std::size_t i = 0; i < f.size(); ++i) power += f[i] * way_of_all[i];
      expect_derivative(
          [&](double h) {
            double energy = 0;
            EXPECT_TRUE(elastic.energy(moved(h), energy).defined());
            return std::vector<double>{energy};
          },
          std::vector<double>{power}, "energy");

      sparse::BlockMatrix k = body.stiffness();
      ASSERT_TRUE(elastic.tangent(u, Linearisation::exact, k).defined());
      EXPECT_EQ((k.to_eigen().toDense() - k.to_eigen().toDense().transpose()).norm(), 0);
      std::vector<double> slope(way.size());
      k.multiply(way, slope);
      expect_derivative(
          [&](double h) {
            const std::vector<double> all = forces(elastic, moved(h));
            std::vector<double> active(way.size());
            for (int a = 0; a < body.active_nodes(); ++a) {
              std::copy_n(&all[3 * at(body.node_of_active()[at(a)])], 3, &active[3 * at(a)]);
            }
            return active;
          },
          slope, std::string(name(kind)).c_str());
    }
  }
}

double least_eigenvalue(const sparse::BlockMatrix& k) {
  const Eigen::MatrixXd dense = k.to_eigen().toDense();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(dense);
  return eigenvalues[0] / eigenvalues[eigenvalues.size() - 1];
}

// Pressed to where the exact tangent is indefinite, the projected one is not; with the support of
// inertia the sum with inertia is not.
TEST(QuadraticElements, HaveASemidefiniteTangent) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const std::vector<double> u = affine(body.mesh(), Eigen::Vector3d(1, 1, 0.5).asDiagonal());
    const double weight = 1e6;  // 1/s²
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      sparse::BlockMatrix k = body.stiffness();
      const Deformation found = elastic.tangent(u, Linearisation::semidefinite, k);
      ASSERT_TRUE(found.defined());
      EXPECT_GT(least_eigenvalue(k), -1e-7) << name(kind);
      const bool projects = kind > LawKind::corotational;
      EXPECT_EQ(found.projected, projects ? int(body.mesh().tetrahedra.size()) : 0) << name(kind);
      for (const fem::MassKind mass : {fem::MassKind::lumped, fem::MassKind::consistent}) {
        ASSERT_TRUE(elastic.supported_tangent(u, weight * least_inertia_share(elements, mass), k)
                        .defined());
        const sparse::BlockMatrix m = body.mass(mass);
        for (int i = 0; i < m.block_rows(); ++i) {
          for (int n = m.row_begin[at(i)]; n < m.row_begin[at(i) + 1]; ++n) {
            double* block = k.block(static_cast<std::size_t>(k.find(i, m.column[at(n)])));
            for (std::size_t r = 0; r < 9; ++r) block[r] += weight * m.block(at(n))[r];
          }
        }
        EXPECT_GT(least_eigenvalue(k), -1e-7) << name(kind);
      }
    }
  }
}

// Of linear elements it is a fourth of the lumped mass, and a twentieth of the consistent one. The
// share of ten nodes is the largest one: a little more of it leaves a negative eigenvalue.
TEST(QuadraticElements, SupportIsTheLeastShareOfInertia) {
  EXPECT_EQ(least_inertia_share(Elements::linear, fem::MassKind::lumped), 0.25);
  EXPECT_EQ(least_inertia_share(Elements::linear, fem::MassKind::consistent), 0.05);
  // By another program.
  EXPECT_NEAR(least_inertia_share(Elements::quadratic, fem::MassKind::lumped), 0.03883391570334,
              1e-13);
  EXPECT_NEAR(least_inertia_share(Elements::quadratic, fem::MassKind::consistent), 0.01165260547291,
              1e-13);
}

// β·K·v at rest, of mean dilatation too; the derivative by v is the damping's tangent anywhere.
TEST(QuadraticElements, DampAsTheyResist) {
  constexpr double kDamping = 1e-3;
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const std::vector<double> v = displacements(body, 0.1);
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      ASSERT_EQ(elastic.points(), 4 * body.mesh().tetrahedra.size());
      std::vector<Tensor<double>> frames(elastic.points());
      const std::vector<double> rest(v.size(), 0.0);
      std::vector<double> f(v.size());
      ASSERT_TRUE(elastic.forces({rest, v, kDamping}, f, frames).defined());
      std::vector<double> expected(v.size());
      fem::assemble_quadratic_stiffness(body.mesh(), body.materials(), elements)
          .multiply(v, expected);
      for (double& x : expected) x *= kDamping;
      EXPECT_LT(distance(f, expected), 1e-12 * norm(expected)) << name(kind);

      const std::vector<double> u = displacements(body, 8e-4);
      ASSERT_TRUE(elastic.forces({u, v, kDamping}, f, frames).defined());
      const std::vector<double> elastic_alone = forces(elastic, u);
      for (std::size_t i = 0; i < f.size(); ++i) f[i] -= elastic_alone[i];
      std::vector<double> damping(v.size(), 0.0);
      elastic.add_damping(frames, {u, v, kDamping}, damping);
      EXPECT_LT(distance(damping, f), 1e-11 * norm(f)) << name(kind);
      sparse::BlockMatrix c = body.stiffness();
      std::ranges::fill(c.value, 0.0);
      elastic.add_damping_tangent(frames, kDamping, 1, c);
      std::vector<double> active(body.load().size());
      std::vector<double> product(active.size());
      for (int a = 0; a < body.active_nodes(); ++a) {
        std::copy_n(&v[3 * at(body.node_of_active()[at(a)])], 3, &active[3 * at(a)]);
      }
      c.multiply(active, product);
      for (int a = 0; a < body.active_nodes(); ++a) {
        std::copy_n(&damping[3 * at(body.node_of_active()[at(a)])], 3, &active[3 * at(a)]);
      }
      EXPECT_LT(distance(active, product), 1e-11 * norm(product)) << name(kind);
    }
  }
}

// A middle is pushed through the element: where det F falls below zero at a point, neo-Hookean laws
// are not defined, and the element adds nothing.
TEST(QuadraticElements, SayWhichAreInverted) {
  for (const Elements elements : kBoth) {
    const Body body = one_element(elements);
    std::vector<double> u(30, 0.0);
    // The middle of the edge from the apex to the first corner, so far past the opposite side.
    const auto node = at(body.mesh().ten_nodes(0)[7]);
    u[3 * node + 2] = -0.02;
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      std::vector<double> f(u.size());
      double energy = 0;
      sparse::BlockMatrix k = body.stiffness();
      for (const Deformation& found : {elastic.internal_forces(u, f), elastic.energy(u, energy),
                                       elastic.tangent(u, Linearisation::exact, k)}) {
        EXPECT_EQ(found.inverted, 1) << name(kind);
        EXPECT_LT(found.smallest_determinant, 0);
        EXPECT_EQ(found.undefined, elastic.needs_positive_determinant() ? 1 : 0);
      }
      if (elastic.needs_positive_determinant()) {
        EXPECT_EQ(norm(f), 0);
        EXPECT_EQ(energy, 0);
      }
    }
  }
}

TEST(QuadraticElements, AllocateNothing) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const std::vector<double> u = displacements(body, 8e-4);
    std::vector<double> f(u.size());
    double energy = 0;
    sparse::BlockMatrix k = body.stiffness();
    for (const LawKind kind : kLaws) {
      const ElasticBody elastic(body, kind);
      std::vector<Tensor<double>> frames(elastic.points());
      const std::size_t before = test::allocation_count();
      const bool defined = elastic.forces({u, u, 1e-3}, f, frames).defined() &&
                           elastic.energy(u, energy).defined() &&
                           elastic.tangent(u, Linearisation::exact, k).defined() &&
                           elastic.tangent(u, Linearisation::semidefinite, k).defined();
      elastic.add_damping_tangent(frames, 1e-3, 1, k);
      EXPECT_EQ(test::allocation_count(), before);
      EXPECT_TRUE(defined);
    }
  }
}

template <class Call>
Operations count(const Call& call) {
  Counted::count = {};
  call();
  return Counted::count;
}

TEST(QuadraticElements, KernelsSayWhatTheyTake) {
  Gradients<Counted> g{};
  const TenNodes::Displaced<Counted> displaced(OfNodes<Counted, 10>{});
  EXPECT_EQ(count([] { TenNodes::Displaced<Counted>(OfNodes<Counted, 10>{}); }),
            TenNodes::kDisplaced);
  EXPECT_EQ(count([&] { displaced.at(2); }), TenNodes::kDisplacedAt);
  TenNodes::Forces<Counted> forces;
  EXPECT_EQ(count([&] { forces.add(1, Tensor<Counted>{}, g); }), TenNodes::kForcesAt);
  EXPECT_EQ(count([&] { forces.of_nodes(); }), TenNodes::kForces);
  TenNodes::Tangents<Counted> tangents;
  EXPECT_EQ(count([&] { tangents.add(3, Blocks<Counted>{}); }), TenNodes::kTangentsAt);
  EXPECT_EQ(count([&] { tangents.of_nodes(); }), TenNodes::kTangents);
  BlocksOf<Counted, 10> blocks{};
  EXPECT_EQ(count([&] { TenNodes::add_outer(Counted(1), OfNodes<Counted, 10>{}, blocks); }),
            TenNodes::kOuter);
}

TEST(QuadraticElements, MeasuresOfVolumeSayWhatTheyTake) {
  Tensor<Counted> f;
  const Eigen::Matrix3d deformed = reference_deformation();
  for (std::size_t i = 0; i < 9; ++i) {
    f[i] = Counted(deformed(static_cast<int>(i / 3), static_cast<int>(i % 3)));
  }
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    std::visit(
        [&](const auto& form) {
          using Measure = MeanDilatation<std::decay_t<decltype(form)>>;
          Dilatation<Counted> at;
          EXPECT_EQ(count([&] { at = Measure::template measure<Counted>(f); }), at.operations)
              << name(kind);
          EXPECT_EQ(count([&] { Measure::energy(1.0, Counted(1.1)); }), Measure::kEnergy)
              << name(kind);
          for (const Linearisation one : {Linearisation::exact, Linearisation::warped}) {
            Operations said;
            Blocks<Counted> k{};
            const Gradients<Counted> g{};
            EXPECT_EQ(count([&] { said = Measure::add_hessian(f, at, g, Counted(2), one, k); }),
                      said)
                << name(kind);
          }
        },
        law.form());
  }
}

// What the host is charged for the forces of an element.
TEST(QuadraticElements, CountTheirOperations) {
  for (const Elements elements : kBoth) {
    const Body body = box(elements);
    const std::vector<double> u = displacements(body, 1e-4);
    std::vector<double> f(u.size());
    const ElasticBody iso(body, LawKind::neo_hookean_isochoric);
    using Measure = MeanDilatation<NeoHookeanIsochoric>;
    Operations expected = TenNodes::kDisplaced +
                          4 * (TenNodes::kDisplacedAt + kDeformationGradient +
                               NeoHookeanIsochoric::kStress + TenNodes::kForcesAt) +
                          TenNodes::kForces + Operations{.add_multiply = 30};
    // Four measures, their mean, and p·∂s/∂F.
    if (elements == Elements::mean_dilatation) {
      expected += 4 * Measure::kMeasure + Measure::kEnergy + Operations{.add_multiply = 4 + 4 * 18};
    }
    EXPECT_EQ(iso.internal_forces(u, f).operations,
              static_cast<double>(body.mesh().tetrahedra.size()) * expected);
    for (const int node : {0, body.mesh().mid_edge[0][0]}) {
      int having = 0;
      for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
        having += static_cast<int>(std::ranges::count(body.mesh().ten_nodes(e), node));
      }
      EXPECT_EQ(iso.elements_at(node).size(), at(having));
    }
  }
}

}  // namespace
}  // namespace hvp::tissue::quadratic_elements_test
