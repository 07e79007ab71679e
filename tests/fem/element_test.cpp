#include <Eigen/Core>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/strain.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::element_test {
namespace {

const Material kTissue{.young_modulus_pa = 7e3, .poisson_ratio = 0.37, .density_kg_m3 = 1050};

mesh::TetMesh one_tetrahedron() {
  mesh::TetMesh mesh;
  mesh.nodes = {{0.1, 0.2, -0.1}, {1.3, 0.1, 0.2}, {0.2, 0.9, 0.1}, {0.3, 0.4, 1.1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  return mesh;
}

TEST(Element, StiffnessIsVolumeTimesBtDB) {
  const ElementGeometry geometry = element_geometry(one_tetrahedron(), 0);
  const StrainDisplacementMatrix b = strain_displacement(geometry);
  const ElementMatrix expected = geometry.volume() * b.transpose() * kTissue.stress_strain() * b;
  const ElementMatrix k = element_stiffness(geometry, kTissue);
  EXPECT_LT((k - expected).norm(), 1e-14 * expected.norm());
}

TEST(Element, StiffnessIsSymmetricToTheLastBit) {
  const ElementMatrix k = element_stiffness(element_geometry(one_tetrahedron(), 0), kTissue);
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) EXPECT_EQ(k(i, j), k(j, i));
  }
}

// The strain order is xx yy zz xy xz yz with engineering shear strains: each component alone.
TEST(Element, StrainOrder) {
  const mesh::TetMesh mesh = one_tetrahedron();
  const StrainDisplacementMatrix b = strain_displacement(element_geometry(mesh, 0));
  const int component[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int s = 0; s < 6; ++s) {
    Eigen::Matrix<double, 12, 1> u;
    for (int a = 0; a < 4; ++a) {
      Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
      // u_i = x_j: γ_ij = 1, or ε_ii = 1.
      displacement[component[s][0]] = mesh.nodes[static_cast<std::size_t>(a)][component[s][1]];
      u.segment<3>(3 * a) = displacement;
    }
    const StrainVector strain = b * u;
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(strain[i], i == s ? 1.0 : 0.0, 1e-14);
  }
}

TEST(Element, MassIsPreservedByBothKinds) {
  const ElementGeometry geometry = element_geometry(one_tetrahedron(), 0);
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const ElementMatrix m = element_mass(geometry, kTissue, kind);
    EXPECT_NEAR(m.sum(), 3 * kTissue.density_kg_m3 * geometry.volume(), 1e-11);
  }
}

// Wathen 1987: the consistent mass of a linear tetrahedron, scaled by its diagonal, has the
// eigenvalues 1/2 (nine times here) and 5/2 (three times).
TEST(Element, JacobiScaledConsistentMass) {
  const ElementMatrix m =
      element_mass(element_geometry(one_tetrahedron(), 0), kTissue, MassKind::consistent);
  const Eigen::Matrix<double, 12, 1> scale = m.diagonal().cwiseSqrt().cwiseInverse();
  const ElementMatrix scaled = scale.asDiagonal() * m * scale.asDiagonal();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(scaled);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(eigenvalues[i], 0.5, 1e-14);
  for (int i = 9; i < 12; ++i) EXPECT_NEAR(eigenvalues[i], 2.5, 1e-14);
}

TEST(Element, InvertedAndFlatElementsAreNamed) {
  mesh::TetMesh mesh = one_tetrahedron();
  mesh.tetrahedra.push_back({0, 2, 1, 3});
  try {
    element_geometry(mesh, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("tetrahedron 1 (nodes 0, 2, 1, 3) is inverted"),
              std::string::npos)
        << error.what();
  }
  mesh.nodes[3] =
      mesh.nodes[0] + 0.3 * (mesh.nodes[1] - mesh.nodes[0]) + 0.4 * (mesh.nodes[2] - mesh.nodes[0]);
  EXPECT_THROW(element_geometry(mesh, 0), InputError);
  mesh.nodes[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(element_geometry(mesh, 0), InputError);
}

TEST(Stress, UniaxialTension) {
  const mesh::TetMesh mesh = jittered_cube(2);
  std::vector<double> u;
  for (const Eigen::Vector3d& x : mesh.nodes) {
    u.insert(u.end(), {-0.37 * 0.01 * x.x(), -0.37 * 0.01 * x.y(), 0.01 * x.z()});
  }
  for (const ElementStress& element : element_stress(mesh, kTissue, u)) {
    EXPECT_NEAR(element.stress[2], 70, 1e-10);
    EXPECT_NEAR(element.von_mises_pa, 70, 1e-10);
    EXPECT_NEAR(element.stress[0], 0, 1e-10);
  }
}

// Pure shear τ: von Mises √3·τ.
TEST(Stress, PureShear) {
  StressVector stress = StressVector::Zero();
  stress[4] = 2;
  EXPECT_NEAR(von_mises(stress), 2 * std::sqrt(3.0), 1e-15);
}

// ε = B·û and σ = D·ε, (3.13) and (3.3), for any displacement.
TEST(Stress, FollowsFromBAndD) {
  const mesh::TetMesh mesh = one_tetrahedron();
  const std::vector<double> u = noise_vector(12);
  const ElementStress element = element_stress(mesh, kTissue, u).front();
  const StrainVector strain = strain_displacement(element_geometry(mesh, 0)) *
                              Eigen::Map<const Eigen::Matrix<double, 12, 1>>(u.data());
  EXPECT_LT((element.strain - strain).norm(), 1e-14 * strain.norm());
  const StressVector stress = kTissue.stress_strain() * strain;
  EXPECT_LT((element.stress - stress).norm(), 1e-14 * stress.norm());
}

TEST(Material, RefusesWhatIsOutOfRange) {
  EXPECT_THROW(Material{.poisson_ratio = 0.5}.check(), InputError);
  EXPECT_THROW(Material{.poisson_ratio = -0.1}.check(), InputError);
  EXPECT_THROW(Material{.young_modulus_pa = 0}.check(), InputError);
  EXPECT_THROW(Material{.density_kg_m3 = -1}.check(), InputError);
  EXPECT_NO_THROW(Material{}.check());
}

}  // namespace
}  // namespace hvp::fem::element_test
