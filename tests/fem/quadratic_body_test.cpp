#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/locking.h"
#include "models/fem/strain.h"
#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"
#include "tests/fem/quadratic_truth.h"

namespace hvp::fem::quadratic_body_test {
namespace {

const Material kTissue{.young_modulus_pa = 1e4, .poisson_ratio = 0.3, .density_kg_m3 = 1000};
const Eigen::Vector3d kSize(1, 0.8, 1.2);
constexpr Elements kBoth[] = {Elements::quadratic, Elements::mean_dilatation};

mesh::TetMesh quadratic_box(const std::array<int, 3>& cells) {
  return mesh::with_mid_edge_nodes(jittered_box(kSize, cells));
}

using Field = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

std::vector<double> at_nodes(const mesh::TetMesh& mesh, const Field& field) {
  std::vector<double> u;
  for (const Eigen::Vector3d& x : mesh.nodes) {
    const Eigen::Vector3d v = field(x);
    u.insert(u.end(), v.begin(), v.end());
  }
  return u;
}

// f of a body force, by the test's own interpolation and integration.
std::vector<double> body_force(const mesh::TetMesh& mesh, const Field& force) {
  std::vector<double> f(3 * mesh.nodes.size(), 0.0);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const truth::Element element(mesh, e);
    const std::array<int, 10> node = mesh.ten_nodes(e);
    element.integrate([&](const Eigen::Vector3d& x, double weight) {
      const truth::Monomials n = element.shape(x);
      const Eigen::Vector3d b = force(x);
      for (std::size_t a = 0; a < 10; ++a) {
        for (int r = 0; r < 3; ++r) {
          f[3 * at(node[a]) + at(r)] += weight * n[static_cast<Eigen::Index>(a)] * b[r];
        }
      }
    });
  }
  return f;
}

// Solves inside with the field prescribed on the whole boundary.
std::vector<double> solve_inside(const mesh::TetMesh& mesh, const Material& material,
                                 Elements elements, const Field& boundary,
                                 const std::vector<double>& f) {
  const sparse::BlockMatrix k = assemble_quadratic_stiffness(mesh, material, elements);
  std::vector<double> u = at_nodes(mesh, boundary);
  std::vector<int> free;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!inside(mesh.nodes[i], kSize)) continue;
    free.push_back(static_cast<int>(i));
    for (std::size_t r = 0; r < 3; ++r) u[3 * i + r] = 0;
  }
  std::vector<double> elastic(u.size());
  k.multiply(u, elastic);
  std::vector<double> b;
  for (const int i : free) {
    for (std::size_t r = 0; r < 3; ++r) b.push_back(f[3 * at(i) + r] - elastic[3 * at(i) + r]);
  }
  std::vector<double> inner(b.size());
  DirectSolver(k.submatrix(free)).solve(b, inner);
  for (std::size_t i = 0; i < free.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) u[3 * at(free[i]) + r] = inner[3 * i + r];
  }
  return u;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(MidEdgeNodes, AreInTheMiddleAndShared) {
  const mesh::TetMesh linear = jittered_box(kSize, {2, 2, 2});
  const mesh::TetMesh mesh = mesh::with_mid_edge_nodes(linear);
  // Euler: V − E + F − T = 1 for a ball, 2F = 4T + boundary.
  const std::size_t faces = (4 * linear.tetrahedra.size() + linear.boundary.size()) / 2;
  const std::size_t edges = linear.nodes.size() + faces - linear.tetrahedra.size() - 1;
  EXPECT_EQ(mesh.nodes.size(), linear.nodes.size() + edges);
  EXPECT_EQ(mesh.boundary.size(), 4 * linear.boundary.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const std::array<int, 10> node = mesh.ten_nodes(e);
    for (std::size_t k = 0; k < 6; ++k) {
      const Eigen::Vector3d middle = 0.5 * (mesh.nodes[at(node[mesh::kTetEdges[k][0]])] +
                                            mesh.nodes[at(node[mesh::kTetEdges[k][1]])]);
      EXPECT_EQ(mesh.nodes[at(node[4 + k])], middle);
    }
  }
  for (std::size_t t = 0; t < mesh.boundary.size(); ++t) {
    const auto normal = [](const mesh::TetMesh& m, std::size_t i) -> Eigen::Vector3d {
      const auto& [a, b, c] = m.boundary[i];
      return (m.nodes[at(b)] - m.nodes[at(a)]).cross(m.nodes[at(c)] - m.nodes[at(a)]);
    };
    EXPECT_LT((4 * normal(mesh, t) - normal(linear, t / 4)).norm(), 1e-14);
  }
}

TEST(QuadraticBody, KeepsExactlySixRigidBodyModes) {
  const mesh::TetMesh mesh = quadratic_box({2, 1, 1});
  for (const Elements elements : kBoth) {
    const Eigen::MatrixXd k =
        assemble_quadratic_stiffness(mesh, kTissue, elements).to_eigen().toDense();
    const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(k);
    const Eigen::VectorXd relative = eigenvalues / eigenvalues.maxCoeff();
    for (Eigen::Index i = 0; i < 6; ++i) EXPECT_LT(std::abs(relative[i]), 1e-12);
    EXPECT_GT(relative[6], 1e-5);
    for (int mode = 0; mode < 6; ++mode) {
      const std::vector<double> u = at_nodes(mesh, [&](const Eigen::Vector3d& x) {
        return mode < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(mode))
                        : Eigen::Vector3d(Eigen::Vector3d::Unit(mode - 3).cross(x));
      });
      EXPECT_LT((k * Eigen::Map<const Eigen::VectorXd>(u.data(), k.rows())).norm(), 1e-10 * 1e4);
    }
  }
}

// Irons' patch test.
TEST(QuadraticBody, ReproducesEveryLinearField) {
  const mesh::TetMesh mesh = quadratic_box({2, 2, 2});
  Eigen::Matrix3d gradient;
  gradient << 0.01, -0.02, 0.005, 0.03, -0.01, 0.02, -0.015, 0.01, 0.02;
  const Field field = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(gradient * x); };
  for (const Elements elements : kBoth) {
    const std::vector<double> u = solve_inside(mesh, kTissue, elements, field,
                                               std::vector<double>(3 * mesh.nodes.size(), 0.0));
    EXPECT_LT(largest_difference(u, at_nodes(mesh, field)), 1e-14);
    for (const ElementStress& e : element_stress(mesh, kTissue, u)) {
      EXPECT_NEAR(e.strain[0], gradient(0, 0), 1e-13);
      EXPECT_NEAR(e.strain[3], gradient(0, 1) + gradient(1, 0), 1e-13);
      EXPECT_NEAR(e.strain[4], gradient(0, 2) + gradient(2, 0), 1e-13);
      EXPECT_NEAR(e.strain[5], gradient(1, 2) + gradient(2, 1), 1e-13);
    }
    const Strains strains = StrainMeter(mesh, 0.01).measure(u);
    const Eigen::VectorXd principal =
        test::symmetric_eigenvalues(0.5 * (gradient + gradient.transpose()));
    EXPECT_NEAR(strains.largest, principal.cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(strains.beyond_share, 1, 1e-12);
    EXPECT_EQ(strains.inverted, 0);
  }
}

// A quadratic field has a constant −div σ, and ten nodes reproduce it. The mean dilatation does so
// where the field has a dilatation that is constant.
TEST(QuadraticBody, ReproducesQuadraticFields) {
  const mesh::TetMesh mesh = quadratic_box({2, 2, 2});
  struct Case {
    Field field;
    Eigen::Vector3d laplacian;
    Eigen::Vector3d gradient_of_dilatation;
    std::vector<Elements> exact;
  };
  const Case cases[] = {{[](const Eigen::Vector3d& x) {
                           return Eigen::Vector3d(0.01 * x.x() * x.x(), 0.02 * x.y() * x.z(),
                                                  0.03 * x.x() * x.z());
                         },
                         {0.02, 0, 0},
                         {0.02 + 0.03, 0, 0.02},
                         {Elements::quadratic}},
                        {[](const Eigen::Vector3d& x) {
                           return Eigen::Vector3d(0.01 * x.y() * x.y(), 0.02 * x.z() * x.z(),
                                                  0.03 * x.x() * x.y() + 0.01 * x.z());
                         },
                         {0.02, 0.04, 0},
                         {0, 0, 0},
                         {Elements::quadratic, Elements::mean_dilatation}}};
  const double mu = kTissue.lame_mu();
  for (const Case& c : cases) {
    // −div σ = −(λ + μ)∇(div u) − μΔu.
    const Eigen::Vector3d force =
        -(kTissue.lame_lambda() + mu) * c.gradient_of_dilatation - mu * c.laplacian;
    const std::vector<double> f =
        body_force(mesh, [&](const Eigen::Vector3d& /*x*/) { return force; });
    for (const Elements elements : c.exact) {
      const std::vector<double> u = solve_inside(mesh, kTissue, elements, c.field, f);
      EXPECT_LT(largest_difference(u, at_nodes(mesh, c.field)), 1e-13);
    }
  }
}

struct Errors {
  double displacement = 0;  // L2
  double gradient = 0;      // L2 of ∇u
};

Errors errors_with(int cells, const Material& material, Elements elements) {
  constexpr double kPi = std::numbers::pi;
  const auto field = [](const Eigen::Vector3d& x) {
    const double s = std::sin(kPi * (x.x() + 0.5 * x.y() - 0.3 * x.z()));
    return Eigen::Vector3d(s, -0.7 * s, 0.4 * s);
  };
  const Eigen::Vector3d k = kPi * Eigen::Vector3d(1, 0.5, -0.3);
  const Eigen::Vector3d a(1, -0.7, 0.4);
  const double mu = material.lame_mu();
  const double lambda = material.lame_lambda();
  const mesh::TetMesh mesh = quadratic_box({cells, cells, cells});
  // u = a·sin(k·x): −div σ = ((λ + μ)(a·k)·k + μ|k|²·a)·sin(k·x).
  const std::vector<double> f = body_force(mesh, [&](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(((lambda + mu) * a.dot(k) * k + mu * k.squaredNorm() * a) *
                           std::sin(k.dot(x)));
  });
  const std::vector<double> u = solve_inside(mesh, material, elements, field, f);
  Errors errors;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const truth::Element element(mesh, e);
    const std::array<int, 10> node = mesh.ten_nodes(e);
    element.integrate([&](const Eigen::Vector3d& x, double weight) {
      const truth::Monomials n = element.shape(x);
      const auto g = element.gradients(x);
      Eigen::Vector3d difference = -field(x);
      Eigen::Matrix3d of_gradient = -std::cos(k.dot(x)) * a * k.transpose();
      for (std::size_t i = 0; i < 10; ++i) {
        const Eigen::Map<const Eigen::Vector3d> of_node(&u[3 * at(node[i])]);
        difference += n[static_cast<Eigen::Index>(i)] * of_node;
        of_gradient += of_node * g.row(static_cast<Eigen::Index>(i));
      }
      errors.displacement += weight * difference.squaredNorm();
      errors.gradient += weight * of_gradient.squaredNorm();
    });
  }
  return {std::sqrt(errors.displacement), std::sqrt(errors.gradient)};
}

struct Orders {
  double displacement = 0;
  double gradient = 0;
};

Orders orders_of(double nu, Elements elements) {
  const Material material{.young_modulus_pa = 1, .poisson_ratio = nu};
  const Errors coarse = errors_with(3, material, elements);
  const Errors fine = errors_with(6, material, elements);
  return {std::log2(coarse.displacement / fine.displacement),
          std::log2(coarse.gradient / fine.gradient)};
}

TEST(QuadraticBody, ConvergesWithOrdersThreeAndTwo) {
  for (const double nu : {0.3, 0.49}) {
    const Orders orders = orders_of(nu, Elements::quadratic);
    EXPECT_GT(orders.displacement, 2.7) << nu;
    EXPECT_GT(orders.gradient, 1.8) << nu;
  }
}

// A pressure that is constant over an element is not better than that of linear elements: P2/P0
// (Boffi, Brezzi and Fortin, Mixed Finite Element Methods and Applications, 2013, §8.4).
TEST(QuadraticBody, ConvergesWithOrdersTwoAndOneWithMeanDilatation) {
  for (const double nu : {0.3, 0.49}) {
    const Orders orders = orders_of(nu, Elements::mean_dilatation);
    EXPECT_NEAR(orders.displacement, 2, 0.4) << nu;
    EXPECT_NEAR(orders.gradient, 1, 0.25) << nu;
  }
}

TEST(QuadraticBody, TakesWeightAndPressureAsTheIntegralsSay) {
  const mesh::TetMesh mesh = quadratic_box({2, 2, 2});
  const double volume = kSize.prod();
  Loads loads;
  loads.gravity = Gravity{{1, 2, -9}};
  const std::vector<double> weight = assemble_loads(mesh, kTissue, loads);
  const std::vector<double> expected = body_force(mesh, [](const Eigen::Vector3d& /*x*/) {
    return Eigen::Vector3d(1000 * Eigen::Vector3d(1, 2, -9));
  });
  EXPECT_LT(largest_difference(weight, expected), 1e-11 * 9000 * volume);

  SurfacePressure top;
  top.region.kind = mesh::Region::Kind::half_space;
  top.region.point = {0, 0, kSize.z()};
  top.region.normal = {0, 0, -1};
  top.pressure = 100;
  loads = {};
  loads.pressures = {top};
  const std::vector<double> f = assemble_loads(mesh, kTissue, loads);
  const std::size_t corners = jittered_box(kSize, {2, 2, 2}).nodes.size();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Eigen::Vector3d force(&f[3 * i]);
    sum += force;
    moment += mesh.nodes[i].cross(force);
    // A corner of the mesh has no share of a face that is loaded whole.
    if (i < corners) {
      EXPECT_LT(force.norm(), 1e-12) << i;
    }
  }
  const Eigen::Vector3d whole(0, 0, -100 * kSize.x() * kSize.y());
  EXPECT_LT((sum - whole).norm(), 1e-10);
  EXPECT_LT((moment - (0.5 * kSize).cwiseProduct(Eigen::Vector3d(1, 1, 2)).cross(whole)).norm(),
            1e-10);
}

TEST(QuadraticBody, HasTheBodysMassAndAPositiveLumpedOne) {
  const mesh::TetMesh mesh = quadratic_box({2, 2, 2});
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const sparse::BlockMatrix m = assemble_quadratic_mass(mesh, kTissue, kind);
    std::vector<double> f(3 * mesh.nodes.size());
    m.multiply(at_nodes(mesh, [](const auto&) { return Eigen::Vector3d(1, 0, 0); }), f);
    double mass = 0;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) mass += f[3 * i];
    EXPECT_NEAR(mass, 1000 * kSize.prod(), 1e-9);
    if (kind == MassKind::lumped) {
      for (int i = 0; i < m.block_rows(); ++i) EXPECT_GT(m.block(at(i))[0], 0);
    }
  }
}

TEST(QuadraticBody, IsAnchoredMidEdgeNodesIncluded) {
  const mesh::TetMesh mesh = quadratic_box({2, 2, 2});
  const std::vector<int> floor = floor_nodes(mesh);
  EXPECT_EQ(floor.size(), 25u);
  const Body body(mesh, kTissue, floor, AnchorTreatment::removed, {}, Elements::quadratic);
  EXPECT_EQ(body.active_nodes(), 100);
  EXPECT_FALSE(measure_locking(mesh, Material{.poisson_ratio = 0.49}, Elements::mean_dilatation)
                   .has_value());
  EXPECT_THROW(
      Body(mesh, kTissue, std::vector<int>{0}, AnchorTreatment::removed, {}, Elements::quadratic),
      InputError);
  EXPECT_THROW(Body(mesh, kTissue, floor, AnchorTreatment::removed), std::invalid_argument);
  EXPECT_THROW(Body(jittered_cube(2), kTissue, floor, AnchorTreatment::removed, {},
                    Elements::mean_dilatation),
               std::invalid_argument);
}

// An element whose corner passes through the face opposite, and one whose mid-edge node does.
TEST(QuadraticBody, StrainMeterSeesWhatIsInsideOut) {
  const mesh::TetMesh mesh = quadratic_box({1, 1, 1});
  const StrainMeter meter(mesh, 0.1);
  std::vector<double> u(3 * mesh.nodes.size(), 0.0);
  EXPECT_EQ(meter.measure(u).inverted, 0);
  const std::size_t node = at(mesh.mid_edge[0][0]);
  const Eigen::Vector3d along = mesh.nodes[at(mesh.tetrahedra[0][1])] - mesh.nodes[node];
  for (int r = 0; r < 3; ++r) u[3 * node + at(r)] = 0.6 * along[r];
  const Strains strains = meter.measure(u);
  EXPECT_GE(strains.inverted, 1);
  EXPECT_GT(strains.largest, 1);
  EXPECT_LT(strains.beyond_share, 1);
}

}  // namespace
}  // namespace hvp::fem::quadratic_body_test
