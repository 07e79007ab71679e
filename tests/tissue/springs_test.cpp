#include "models/tissue/springs.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"
#include "models/tissue/central_differences.h"
#include "models/tissue/chainmail.h"
#include "models/tissue/stable_step.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/counted.h"
#include "tests/tissue/falling_beam.h"
#include "tests/tissue/one_tetrahedron.h"
#include "tests/tissue/pressed_sphere.h"

namespace hvp::tissue::springs_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kYoung = 1e4;  // Pa

fem::Body box(fem::CellCut cut) {
  mesh::TetMesh mesh = fem::structured_box({0.06, 0.06, 0.06}, {6, 6, 6}, cut);
  const std::vector<int> floor = fem::floor_nodes(mesh);
  return fem::Body(std::move(mesh), reference_material(), floor, fem::AnchorTreatment::removed);
}

double volume_of(const fem::Body& body) {
  double volume = 0;
  for (std::size_t e = 0; e < body.mesh().tetrahedra.size(); ++e) {
    volume += fem::element_geometry(body.mesh(), static_cast<int>(e)).volume();
  }
  return volume;
}

// C of ψ = ½·ε:C:ε under an affine strain: 81 entries, Σ k·l²·n n n n / V, Pa.
using Stiffness = Eigen::Matrix<double, 9, 9>;
Stiffness affine_stiffness(const SpringBody& body) {
  Stiffness c = Stiffness::Zero();
  for (const SpringBody::Spring& spring : body.springs()) {
    const Vector3d n = Eigen::Map<const Vector3d>(spring.rest.data()) / spring.length;
    const Matrix3d nn = n * n.transpose();
    const Eigen::Map<const Eigen::Matrix<double, 9, 1>> m(nn.data());
    c += spring.stiffness * spring.length * spring.length * m * m.transpose();
  }
  return c / volume_of(body.body());
}

// λ·δδ + μ·(δδ + δδ)
Stiffness isotropic(double lambda, double mu) {
  Stiffness c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          c(3 * i + j, 3 * k + l) =
              lambda * (i == j && k == l) + mu * ((i == k && j == l) + (i == l && j == k));
        }
      }
    }
  }
  return c;
}

// Section 12 of the reference values. The isotropic part of C has C_iijj and C_ijij of C, which are
// equal for springs, so that λ = μ, ν = ¼ and E = 5μ/2.
TEST(Springs, HaveTheYoungModulusInTheMean) {
  const fem::Body same = box(fem::CellCut::same);
  const fem::Body mirrored = box(fem::CellCut::mirrored);
  const fem::Body sphere = thesis_sphere();
  const struct {
    const fem::Body& body;
    std::size_t springs;
    double anisotropy;
  } kRows[] = {{same, 1854, 0.617}, {mirrored, 1854, 0.249}, {sphere, 3004, 0.019}};
  for (const auto& row : kRows) {
    const SpringBody springs(row.body);
    EXPECT_EQ(springs.springs().size(), row.springs);
    const Stiffness c = affine_stiffness(springs);
    double iijj = 0;
    double ijij = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        iijj += c(4 * i, 4 * j);
        ijij += c(3 * i + j, 3 * i + j);
      }
    }
    EXPECT_NEAR(iijj, ijij, 1e-9 * iijj);
    // 9λ + 6μ and 3λ + 12μ
    const double mu = (3 * ijij - iijj) / 30;
    const double lambda = (iijj - 6 * mu) / 9;
    EXPECT_NEAR(lambda / (2 * (lambda + mu)), 0.25, 1e-12);
    EXPECT_NEAR(mu * (3 * lambda + 2 * mu) / (lambda + mu), kYoung, 1e-8 * kYoung);
    EXPECT_NEAR(lambda + 2 * mu / 3, 2 * kYoung / 3, 1e-8 * kYoung);
    const Stiffness even = isotropic(lambda, mu);
    EXPECT_NEAR((c - even).norm() / even.norm(), row.anisotropy, 0.0006);
  }
}

// A small affine displacement has the energy of that stiffness.
TEST(Springs, EnergyOfAnAffineStrain) {
  const fem::Body body = box(fem::CellCut::same);
  const SpringBody springs(body);
  const Stiffness c = affine_stiffness(springs);
  Matrix3d strain;
  strain << 3, -1, 2, -1, 1, 0.5, 2, 0.5, -2;
  strain *= 1e-6;
  std::vector<double> u(3 * body.mesh().nodes.size());
  for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
    const Vector3d moved = strain * body.mesh().nodes[n];
    std::copy_n(moved.data(), 3, &u[3 * n]);
  }
  double energy = 0;
  ASSERT_TRUE(springs.energy(u, energy).defined());
  const Eigen::Map<const Eigen::Matrix<double, 9, 1>> e(strain.data());
  EXPECT_NEAR(energy, volume_of(body) / 2 * e.dot(c * e), 1e-5 * energy);
}

// A block of 60 × 60 × 30 mm, clamped below, pressed 1 mm by a patch of 10 mm.
struct Pressed {
  double stiffness = 0;  // N/m
  std::vector<double> u;
  double bulge = 0;  // m, the largest u_z
};

Pressed press(double poisson_ratio, bool with_springs) {
  mesh::TetMesh mesh = fem::structured_box({0.06, 0.06, 0.03}, {12, 12, 6});
  const std::vector<int> floor = fem::floor_nodes(mesh);
  fem::Material material;
  material.poisson_ratio = poisson_ratio;
  const fem::Body body(std::move(mesh), material, floor, fem::AnchorTreatment::removed);
  sparse::BlockMatrix k = body.stiffness();
  const std::vector<double> rest(3 * body.mesh().nodes.size());
  if (with_springs) {
    EXPECT_TRUE(SpringBody(body).tangent(rest, Linearisation::exact, k).defined());
  }
  std::vector<int> patch;
  for (int a = 0; a < body.active_nodes(); ++a) {
    const Vector3d& x = body.mesh().nodes[at(body.node_of_active()[at(a)])];
    if (x.z() > 0.0299 && (x - Vector3d(0.03, 0.03, 0.03)).norm() < 0.010 + 1e-9) {
      patch.push_back(a);
    }
  }
  const std::vector<double> none(body.load().size());
  Pressed result{.u = none};
  fem::DirectSolver solver(k);
  EXPECT_TRUE(solver.positive_definite());
  solver.solve_with_contact(none, patch, Vector3d(0, 0, -1e-3), result.u);
  const fem::ContactConstraint contact(k, fem::ContactDiagonal::one);
  result.stiffness = -contact.reaction(result.u, none, patch).z() / 1e-3;
  for (std::size_t i = 2; i < result.u.size(); i += 3) {
    result.bulge = std::max(result.bulge, result.u[i]);
  }
  return result;
}

double difference(const Pressed& one, const Pressed& of) {
  const Eigen::Map<const Eigen::VectorXd> a(one.u.data(), static_cast<int>(one.u.size()));
  const Eigen::Map<const Eigen::VectorXd> b(of.u.data(), static_cast<int>(of.u.size()));
  return (a - b).norm() / b.norm();
}

// They are 8 % softer than finite elements of the only Poisson's ratio that they can have, and 29 %
// softer than those of soft tissue, whose surface they raise twice as high.
TEST(Springs, AgreeWithTheReferenceUnderAnIndenter) {
  const Pressed springs = press(0.3, true);
  const Pressed quarter = press(0.25, false);
  const Pressed tissue = press(0.45, false);
  EXPECT_NEAR(springs.stiffness, 279.036532, 2e-6);
  EXPECT_NEAR(quarter.stiffness, 303.123060, 2e-6);
  EXPECT_NEAR(press(0.3, false).stiffness, 310.930163, 2e-6);
  EXPECT_NEAR(tissue.stiffness, 390.506015, 2e-6);
  EXPECT_NEAR(difference(springs, quarter), 0.3790, 6e-5);
  EXPECT_NEAR(difference(springs, tissue), 0.5554, 6e-5);
  EXPECT_NEAR(springs.bulge, 2.483e-05, 6e-9);
  EXPECT_NEAR(quarter.bulge, 2.846e-05, 6e-9);
  EXPECT_NEAR(tissue.bulge, 1.178e-05, 6e-9);
}

// Turned, moved and mirrored as a whole they are at rest.
TEST(Springs, DoNotSeeAMirror) {
  const fem::Body body = box(fem::CellCut::mirrored);
  const SpringBody springs(body);
  for (const Matrix3d& turn : {reference_rotation(), Matrix3d(-reference_rotation())}) {
    std::vector<double> u(3 * body.mesh().nodes.size());
    for (std::size_t n = 0; n < body.mesh().nodes.size(); ++n) {
      const Vector3d& x = body.mesh().nodes[n];
      const Vector3d moved = turn * x - x + Vector3d(0.01, 0.02, 0.03);
      std::copy_n(moved.data(), 3, &u[3 * n]);
    }
    std::vector<double> f(u.size());
    double energy = 0;
    const Deformation found = springs.internal_forces(u, f);
    EXPECT_TRUE(found.defined());
    EXPECT_EQ(found.inverted, 0);
    ASSERT_TRUE(springs.energy(u, energy).defined());
    EXPECT_LT(energy, 1e-25);
    for (const double force : f) EXPECT_LT(std::abs(force), 1e-12);
  }
}

std::vector<double> displaced(const fem::Body& body, double size) {
  std::vector<double> u(body.load().size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = size * fem::noise(i + 3);
  return body.expand(u);
}

TEST(Springs, ForcesAndTangentAreDerivatives) {
  for (const fem::AnchorTreatment treatment :
       {fem::AnchorTreatment::removed, fem::AnchorTreatment::kept}) {
    mesh::TetMesh mesh = fem::jittered_box({0.03, 0.03, 0.02}, {3, 3, 2});
    const std::vector<int> floor = fem::floor_nodes(mesh);
    const fem::Body body(std::move(mesh), reference_material(), floor, treatment);
    const SpringBody springs(body);
    const std::vector<double> u = displaced(body, 2e-3);
    const std::vector<double> way = displaced(body, 1);  // zero where held
    std::vector<double> way_active;
    for (const int node : body.node_of_active()) {
      for (std::size_t i = 0; i < 3; ++i) way_active.push_back(way[3 * at(node) + i]);
    }
    std::vector<double> f(u.size());
    ASSERT_TRUE(springs.internal_forces(u, f).defined());
    sparse::BlockMatrix k = body.stiffness();
    ASSERT_TRUE(springs.tangent(u, Linearisation::exact, k).defined());
    std::vector<double> slope(way_active.size());
    k.multiply(way_active, slope);
    double power = 0;
    for (std::size_t i = 0; i < u.size(); ++i) power += f[i] * way[i];
    const auto errors = [&](double h) {
      std::array<double, 2> energy{};
      std::array<std::vector<double>, 2> forces{std::vector<double>(u.size()),
                                                std::vector<double>(u.size())};
      for (std::size_t side = 0; side < 2; ++side) {
        std::vector<double> moved = u;
        for (std::size_t i = 0; i < u.size(); ++i) moved[i] += (side == 0 ? h : -h) * way[i];
        EXPECT_TRUE(springs.energy(moved, energy[side]).defined());
        EXPECT_TRUE(springs.internal_forces(moved, forces[side]).defined());
      }
      double worst = 0;
      for (int a = 0; a < body.active_nodes(); ++a) {
        const int node = body.node_of_active()[at(a)];
        if (body.held(node)) continue;
        for (std::size_t i = 0; i < 3; ++i) {
          const std::size_t m = 3 * at(node) + i;
          worst = std::max(
              worst, std::abs((forces[0][m] - forces[1][m]) / (2 * h) - slope[3 * at(a) + i]));
        }
      }
      return std::pair(std::abs((energy[0] - energy[1]) / (2 * h) - power), worst);
    };
    const auto coarse = errors(1e-4);
    const auto fine = errors(5e-5);
    EXPECT_NEAR(coarse.first / fine.first, 4, 0.1);
    EXPECT_NEAR(coarse.second / fine.second, 4, 0.1);

    for (int a = 0; a < body.active_nodes(); ++a) {
      for (int b = k.row_begin[at(a)]; b < k.row_begin[at(a) + 1]; ++b) {
        const int column = k.column[at(b)];
        const double* back = k.block(static_cast<std::size_t>(k.find(column, a)));
        for (std::size_t i = 0; i < 9; ++i) {
          EXPECT_EQ(k.block(at(b))[i], back[3 * (i % 3) + i / 3]);
        }
        if (body.held(body.node_of_active()[at(a)])) {
          EXPECT_EQ(k.block(at(b))[0], column == a ? body.stiffness().block(at(b))[0] : 0.0);
        }
      }
    }
  }
}

// Pressed to half its height, every spring gives way to the side.
TEST(Springs, ExactTangentIsIndefiniteWhenPressed) {
  const fem::Body body = box(fem::CellCut::same);
  const SpringBody springs(body);
  std::vector<double> u(3 * body.mesh().nodes.size());
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = -0.5 * body.mesh().nodes[i / 3][int(i % 3)];
  sparse::BlockMatrix k = body.stiffness();
  ASSERT_TRUE(springs.tangent(u, Linearisation::exact, k).defined());
  EXPECT_GT(fem::DirectSolver(k).negative_eigenvalues(), 0);
  ASSERT_TRUE(springs.tangent(u, Linearisation::warped, k).defined());
  EXPECT_TRUE(fem::DirectSolver(k).positive_definite());
}

TEST(Springs, OfNoLengthAreCounted) {
  const fem::Body body = box(fem::CellCut::same);
  const SpringBody springs(body);
  std::vector<double> u(3 * body.mesh().nodes.size());
  const SpringBody::Spring& flat = springs.springs().back();
  for (std::size_t i = 0; i < 3; ++i) {
    // The ends meet at the second one's place; both are multiples of the cell and no bit is left.
    u[3 * at(flat.node[0]) + i] = flat.rest[i];
  }
  std::vector<double> f(u.size());
  double energy = 0;
  sparse::BlockMatrix k = body.stiffness();
  EXPECT_EQ(springs.internal_forces(u, f).undefined, 1);
  EXPECT_EQ(springs.energy(u, energy).undefined, 1);
  EXPECT_EQ(springs.tangent(u, Linearisation::exact, k).undefined, 1);
  for (const double force : f) EXPECT_TRUE(std::isfinite(force));
  for (const double entry : k.value) EXPECT_TRUE(std::isfinite(entry));
  u[0] = HUGE_VAL;
  EXPECT_GT(springs.internal_forces(u, f).undefined, 1);
}

// Section 17: 19 operations, a root and a division; here the ends are given by displacements, which
// takes three more, and k·l₀ is known, which takes one less.
TEST(Springs, CountOperations) {
  const Vector<Counted> d = {Counted(1), Counted(2), Counted(3)};
  Counted::count = {};
  spring_force(d, Counted(2), Counted(3));
  EXPECT_EQ(Counted::count, kSpringForce);
  const fem::Body body = box(fem::CellCut::same);
  const SpringBody springs(body);
  std::vector<double> f(3 * body.mesh().nodes.size());
  EXPECT_EQ(springs.internal_forces(std::vector<double>(f.size()), f).operations,
            1854 * (Operations{19 + 3 - 1, 1, 1}));
}

// They move as elements do, with a limit of their own, and the error of their energy is of second
// order.
TEST(Springs, MoveByCentralDifferences) {
  const fem::Body body = falling_beam();
  const SpringBody springs(body);
  const double limit =
      largest_frequency(springs, std::vector<double>(body.load().size())).stable_step_s();
  const auto drift = [&](int substeps) {
    CentralDifferences dynamics(springs, its_weight(body), 0, 200 * limit / substeps);
    double total = 0;
    double kinetic = 0;
    for (int step = 0; step < substeps; ++step) {
      EXPECT_TRUE(dynamics.step(1).complete());
      kinetic = std::max(kinetic, dynamics.kinetic_energy());
      total = std::max(total, std::abs(dynamics.kinetic_energy() + dynamics.strain_energy() -
                                       dynamics.work_of_load()));
    }
    EXPECT_LT(tip(dynamics).norm(), 0.1);
    return total / kinetic;
  };
  const double fine = drift(1600);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(drift(800) / fine, 4, 0.3);
}

TEST(Springs, DoNotAllocate) {
  const fem::Body body = box(fem::CellCut::same);
  const SpringBody springs(body);
  const std::vector<double> u = displaced(body, 1e-3);
  std::vector<double> f(u.size());
  double energy = 0;
  sparse::BlockMatrix k = body.stiffness();
  const std::size_t before = test::allocation_count();
  const bool defined = springs.internal_forces(u, f).defined() &&
                       springs.energy(u, energy).defined() &&
                       springs.tangent(u, Linearisation::exact, k).defined();
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_TRUE(defined);
}

// A chain of 20 links of h = 5 mm and slack s·h; its first node pulled by d.
TEST(ChainMail, LinkKMovesWhatTheSlackLeaves) {
  constexpr double kSlack = 0.1 * 0.005;
  std::vector<Link> links;
  for (int k = 0; k < 20; ++k) links.push_back({k, k + 1, kSlack});
  for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0.6, 0, -0.8)}) {
    for (const double d : {0.0, 0.0003, 0.0005, 0.004, 0.02}) {
      ChainMail chain(links, std::vector<char>(21));
      std::vector<Vector3d> u(21, Vector3d::Zero());
      const std::size_t before = test::allocation_count();
      const ChainMail::Moved moved = chain.move(0, d * way, u);
      EXPECT_EQ(test::allocation_count(), before);
      int expected = 1;
      for (int k = 0; k <= 20; ++k) {
        const double goes = std::max(0.0, d - k * kSlack);
        if (k > 0 && goes > 1e-12) ++expected;
        EXPECT_LT((u[at(k)] - goes * way).norm(), 1e-15);
      }
      EXPECT_NEAR(moved.nodes, expected, 1);  // a link just taut may move by a rounding
      EXPECT_EQ(moved.stretched, 0);
      // Back again, the slack holds the others where they are.
      const std::vector<Vector3d> pulled = u;
      chain.move(0, d * way - std::min(d, kSlack) * way, u);
      EXPECT_LT((u[1] - pulled[1]).norm(), 1e-15);
    }
  }
}

// In three dimensions no link is left beyond its slack round a node that moved, but for those to
// fixed nodes, which are counted.
TEST(ChainMail, MovesABodyAndNotItsAnchors) {
  const fem::Body body = box(fem::CellCut::same);
  std::vector<Link> links;
  for (const Edge& edge : edges_of(body.mesh(), body.materials())) {
    links.push_back({edge.node[0], edge.node[1], 0.001});
  }
  std::vector<char> fixed(body.mesh().nodes.size());
  for (const int node : body.anchored()) fixed[at(node)] = 1;
  ChainMail mail(links, fixed);
  const int top = static_cast<int>(fixed.size()) - 1;
  std::vector<Vector3d> u(fixed.size(), Vector3d::Zero());
  const ChainMail::Moved near = mail.move(top, Vector3d(0, 0, 0.0035), u);
  EXPECT_EQ(near.stretched, 0);
  // Those within three links: a corner of the box has 4³ nodes there, body diagonals included.
  EXPECT_EQ(near.nodes, 64);
  for (const Link& link : links) EXPECT_LT((u[at(link.a)] - u[at(link.b)]).norm(), 0.001 + 1e-12);
  EXPECT_GT(mail.move(top, Vector3d(0, 0, 0.02), u).stretched, 0);
  for (const int node : body.anchored()) EXPECT_EQ(u[at(node)], Vector3d::Zero());
}

}  // namespace
}  // namespace hvp::tissue::springs_test
