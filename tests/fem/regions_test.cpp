#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/locking.h"
#include "models/fem/region.h"
#include "models/fem/strain.h"
#include "models/index.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::regions_test {
namespace {

using Eigen::Vector3d;
using Shape = mesh::Volume::Shape;

Vector3d centroid(const mesh::TetMesh& mesh, std::size_t element) {
  Vector3d sum = Vector3d::Zero();
  for (const int node : mesh.tetrahedra[element]) sum += mesh.nodes[at(node)];
  return sum / 4;
}

// The second material where `second` says so of the centroid.
Materials two_parts(const mesh::TetMesh& mesh, const Material& first, const Material& second,
                    const std::function<bool(const Vector3d&)>& is_second) {
  std::vector<int> of_element;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    of_element.push_back(is_second(centroid(mesh, e)) ? 1 : 0);
  }
  return {{first, second}, of_element};
}

// Materials that differ from element to element, ten of them.
Materials mixed(const mesh::TetMesh& mesh) {
  std::vector<Material> table;
  for (std::uint64_t i = 0; i < 10; ++i) {
    table.push_back({.young_modulus_pa = 1e4 * std::exp(5 * noise(i)),
                     .poisson_ratio = 0.24 + 0.2 * noise(100 + i),
                     .density_kg_m3 = 1000 + 500 * noise(200 + i)});
  }
  std::vector<int> of_element;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    of_element.push_back(static_cast<int>(7 * e % 10));
  }
  return {table, of_element};
}

mesh::Region top(double z) {
  return {.kind = mesh::Region::Kind::half_space, .point = {0, 0, z}, .normal = {0, 0, -1}};
}

std::vector<double> static_displacement(const Body& body) {
  std::vector<double> u(body.load().size());
  DirectSolver(body.stiffness()).solve(body.load(), u);
  return body.expand(u);
}

// Two layers one on the other are springs in series: with ν = 0 nothing moves across, and a
// pressure p takes the top down by p·(h₁/E₁ + h₂/E₂).
TEST(Regions, LayersAreSpringsInSeries) {
  const mesh::TetMesh mesh = structured_box({1, 1, 3}, {2, 2, 6});
  for (const double contrast : {1.0, 7.0, 1e-3, 1e6}) {
    const Material soft{.young_modulus_pa = 1e4, .poisson_ratio = 0};
    Material other = soft;
    other.young_modulus_pa *= contrast;
    const Materials materials =
        two_parts(mesh, soft, other, [](const Vector3d& x) { return x.z() > 1; });
    Loads loads;
    loads.pressures.push_back({.region = top(3), .pressure = 25});
    const Body body(mesh, materials, floor_nodes(mesh), AnchorTreatment::removed, loads);
    const std::vector<double> u = static_displacement(body);
    const double expected = 25 / soft.young_modulus_pa * (1 + 2 / contrast);
    // A contrast costs the solution as many digits as it has.
    const double rounding = 1e-10 + 1e-13 * contrast;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      if (mesh.nodes[i].z() < 3) continue;
      EXPECT_NEAR(-u[3 * i + 2], expected, rounding * expected);
    }
    // The stress is the same in both, the strain is not.
    const std::vector<ElementStress> elements = element_stress(mesh, materials, u);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      EXPECT_NEAR(elements[e].stress[2], -25, 25 * 1e-9 * std::max(1.0, contrast));
      EXPECT_NEAR(elements[e].strain[2], -25 / materials.of(e).young_modulus_pa,
                  rounding * expected);
    }
  }
}

// Side by side they are springs in parallel: a plate that goes down by d takes d/h·(E₁A₁ + E₂A₂).
TEST(Regions, ColumnsAreSpringsInParallel) {
  const mesh::TetMesh mesh = structured_box({3, 1, 2}, {3, 2, 4});
  const Material soft{.young_modulus_pa = 1e4, .poisson_ratio = 0};
  const Material stiff{.young_modulus_pa = 3e6, .poisson_ratio = 0};
  const Materials materials =
      two_parts(mesh, soft, stiff, [](const Vector3d& x) { return x.x() > 1; });
  Loads loads;
  loads.prescribed.push_back({.region = top(2), .displacement = {0, 0, -0.02}});
  const Body body(mesh, materials, floor_nodes(mesh), AnchorTreatment::removed, loads);
  const std::vector<double> u = static_displacement(body);
  std::vector<double> f(u.size());
  assemble_stiffness(mesh, materials).multiply(u, f);
  double force = 0;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i].z() == 2) force -= f[3 * i + 2];
  }
  const double expected = 0.02 / 2 * (soft.young_modulus_pa * 1 + stiff.young_modulus_pa * 2);
  EXPECT_NEAR(force, expected, 1e-10 * expected);
}

// K against a dense sum of BᵀDB·V, and the mass matrices against ρV/20·(1 + δ) and ρV/4.
TEST(Regions, AssembleEachElementWithItsOwnMaterial) {
  const mesh::TetMesh mesh = jittered_cube(2);
  const Materials materials = mixed(mesh);
  const auto rows = static_cast<Eigen::Index>(3 * mesh.nodes.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::MatrixXd consistent = Eigen::MatrixXd::Zero(rows, rows);
  Eigen::MatrixXd lumped = Eigen::MatrixXd::Zero(rows, rows);
  double mass = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    const Material& material = materials.table()[7 * e % 10];
    const StrainDisplacementMatrix b = strain_displacement(geometry);
    const ElementMatrix own = geometry.volume() * b.transpose() * material.stress_strain() * b;
    const double m = material.density_kg_m3 * geometry.volume();
    mass += m;
    for (int p = 0; p < 4; ++p) {
      for (int q = 0; q < 4; ++q) {
        const int row = 3 * mesh.tetrahedra[e][at(p)];
        const int column = 3 * mesh.tetrahedra[e][at(q)];
        k.block<3, 3>(row, column) += own.block<3, 3>(3 * p, 3 * q);
        consistent.block<3, 3>(row, column) +=
            m / 20 * (p == q ? 2 : 1) * Eigen::Matrix3d::Identity();
        if (p == q) lumped.block<3, 3>(row, column) += m / 4 * Eigen::Matrix3d::Identity();
      }
    }
  }
  const auto expect_equal = [&](const sparse::BlockMatrix& found, const Eigen::MatrixXd& expected) {
    double sum = 0;
    for (int i = 0; i < found.block_rows(); ++i) {
      for (int n = found.row_begin[at(i)]; n < found.row_begin[at(i) + 1]; ++n) {
        const int j = found.column[at(n)];
        for (int r = 0; r < 9; ++r) {
          const double entry = found.block(at(n))[r];
          EXPECT_NEAR(entry, expected(3 * i + r / 3, 3 * j + r % 3),
                      1e-13 * expected.cwiseAbs().maxCoeff());
          sum += std::abs(entry);
        }
      }
    }
    EXPECT_NEAR(sum, expected.cwiseAbs().sum(), 1e-12 * sum);
  };
  expect_equal(assemble_stiffness(mesh, materials), k);
  expect_equal(assemble_mass(mesh, materials, MassKind::consistent), consistent);
  expect_equal(assemble_mass(mesh, materials, MassKind::lumped), lumped);

  Loads loads;
  loads.gravity.emplace();
  loads.gravity->acceleration = {0, 0, -9.81};
  const std::vector<double> f = assemble_loads(mesh, materials, loads);
  double weight = 0;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) weight -= f[3 * i + 2];
  EXPECT_NEAR(weight, 9.81 * mass, 1e-12 * weight);
}

// What is the same everywhere is the same to the last bit, however many materials say it.
TEST(Regions, OfEqualMaterialsAreNone) {
  const mesh::TetMesh mesh = jittered_cube(3);
  const Material one{.young_modulus_pa = 7331, .poisson_ratio = 0.37, .density_kg_m3 = 1041};
  std::vector<int> of_element;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    of_element.push_back(static_cast<int>(e % 3));
  }
  const Materials several(std::vector<Material>(3, one), of_element);
  Loads loads;
  loads.gravity.emplace();
  const Body a(mesh, one, floor_nodes(mesh), AnchorTreatment::kept, loads);
  const Body b(mesh, several, floor_nodes(mesh), AnchorTreatment::kept, loads);
  EXPECT_EQ(a.stiffness().value, b.stiffness().value);
  EXPECT_EQ(a.mass(MassKind::lumped).value, b.mass(MassKind::lumped).value);
  EXPECT_EQ(a.mass(MassKind::consistent).value, b.mass(MassKind::consistent).value);
  EXPECT_EQ(a.load(), b.load());
  EXPECT_EQ(a.material().young_modulus_pa, 7331);
  EXPECT_THROW(static_cast<void>(b.material()), std::logic_error);
}

Region sphere(const Vector3d& centre, double radius, const Material& material) {
  Region region;
  region.volume.region.centre = centre;
  region.volume.region.radius = radius;
  region.material = material;
  return region;
}

std::string refused(const mesh::TetMesh& mesh, const std::vector<Region>& regions) {
  try {
    materials_of(mesh, Material{}, regions, std::vector<mesh::Surface>(regions.size()));
  } catch (const InputError& e) {
    return e.key() + ": " + e.what();
  }
  return "";
}

TEST(Regions, AnElementIsOfTheLastThatHasItsCentroid) {
  const mesh::TetMesh mesh = structured_box({2, 2, 2}, {4, 4, 4});
  const std::vector<Region> regions = {sphere({1, 1, 1}, 0.9, {.density_kg_m3 = 2000}),
                                       sphere({1.4, 1, 1}, 0.5, {.density_kg_m3 = 3000})};
  const Materials materials =
      materials_of(mesh, Material{}, regions, std::vector<mesh::Surface>(2));
  int of_both = 0;
  double mass = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const bool first = (centroid(mesh, e) - Vector3d(1, 1, 1)).norm() <= 0.9;
    const bool second = (centroid(mesh, e) - Vector3d(1.4, 1, 1)).norm() <= 0.5;
    of_both += first && second;
    const double density = second ? 3000 : first ? 2000 : 1000;
    EXPECT_EQ(materials.of(e).density_kg_m3, density);
    mass += density * element_geometry(mesh, static_cast<int>(e)).volume();
  }
  EXPECT_GT(of_both, 0);
  double elements = 0;
  double volume = 0;
  double of_shares = 0;
  for (const Share& share : shares_of(mesh, materials)) {
    elements += share.elements;
    volume += share.volume_m3;
    of_shares += share.mass_kg;
  }
  EXPECT_EQ(elements, static_cast<double>(mesh.tetrahedra.size()));
  EXPECT_NEAR(volume, 8, 1e-12);
  EXPECT_NEAR(of_shares, mass, 1e-9);
}

TEST(Regions, WithoutAnElementAreRefused) {
  const mesh::TetMesh mesh = structured_box({2, 2, 2}, {4, 4, 4});
  const Region lump = sphere({1, 1, 1}, 0.5, {});
  EXPECT_EQ(refused(mesh, {lump}), "");
  EXPECT_EQ(
      refused(mesh, {lump, sphere({9, 9, 9}, 0.5, {})}).find("region[1]: the centroid of none"),
      0U);
  EXPECT_EQ(refused(mesh, {lump, sphere({1, 1, 1}, 5, {})}).find("region[0]: all its elements"),
            0U);
  // One that covers all is not.
  EXPECT_EQ(refused(mesh, {sphere({1, 1, 1}, 5, {})}), "");
}

TEST(Regions, HaveNamesOfTheirOwn) {
  std::vector<Region> regions(3);
  EXPECT_NO_THROW(check_names(regions));
  EXPECT_EQ(name_of(regions, 2), "region[2]");
  regions[0].name = regions[2].name = "lump";
  try {
    check_names(regions);
    FAIL() << "two lumps";
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "region[2].name");
  }
}

TEST(Regions, LockByTheirOwnMesh) {
  const mesh::TetMesh mesh = jittered_box({0.1, 0.1, 0.1}, {8, 8, 8});
  const Material body{.poisson_ratio = 0.4};
  const Material layer{.poisson_ratio = 0.49};
  const auto in_layer = [](const Vector3d& x) { return x.z() > 0.05; };
  const auto locking = measure_locking(mesh, two_parts(mesh, body, layer, in_layer));
  ASSERT_TRUE(locking);
  // Four cells across a layer of half the body.
  EXPECT_EQ(locking->cells, 4);
  EXPECT_EQ(locking->stiffness_ratio, cantilever_ratio(0.49, 4));
  EXPECT_FALSE(
      measure_locking(mesh, two_parts(mesh, layer, body, [](const Vector3d&) { return true; })));
}

TEST(Regions, OfAnotherMeshAreAMistakeOfTheProgram) {
  const mesh::TetMesh mesh = jittered_cube(2);
  EXPECT_THROW(Materials({Material{}}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(Materials({}, {}), std::invalid_argument);
  EXPECT_THROW(assemble_stiffness(mesh, {{Material{}}, {0, 0}}), std::invalid_argument);
}

}  // namespace
}  // namespace hvp::fem::regions_test
