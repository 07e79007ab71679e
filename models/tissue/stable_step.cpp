#include "models/tissue/stable_step.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"
#include "models/tissue/noise.h"

namespace hvp::tissue {
namespace {

// Lanczos' iteration ends when the residual is below this share of the eigenvalue, or after so many
// steps; the factorisation judges the result either way.
constexpr double kResidual = 1e-9;
constexpr int kMostSteps = 400;

// The largest eigenvalue of M^(−½)·K·M^(−½), from below.
double lanczos(const sparse::BlockMatrix& k, std::span<const double> mass) {
  const int rows = k.rows();
  Eigen::VectorXd root(rows);  // M^(−½)
  for (int i = 0; i < rows; ++i) root[i] = 1 / std::sqrt(mass[at(i / 3)]);
  const int most = std::min(rows, kMostSteps);
  Eigen::MatrixXd basis(rows, most);
  Eigen::VectorXd diagonal(most);
  Eigen::VectorXd beside(most);
  Eigen::VectorXd scaled(rows);
  Eigen::VectorXd product(rows);
  std::uint32_t noise = kFirstNoise;
  Eigen::VectorXd q(rows);
  for (double& entry : q) entry = next_noise(noise);
  q.normalize();
  double largest = 0;
  for (int step = 0; step < most; ++step) {
    basis.col(step) = q;
    scaled = root.cwiseProduct(q);
    k.multiply({scaled.data(), at(rows)}, {product.data(), at(rows)});
    product = root.cwiseProduct(product);
    diagonal[step] = q.dot(product);
    const auto so_far = basis.leftCols(step + 1);
    for (int twice = 0; twice < 2; ++twice) {
      product -= so_far * (so_far.transpose() * product).eval();
    }
    beside[step] = product.norm();
    const bool last = step + 1 == most || !(beside[step] > 0);
    if (last || step % 8 == 7) {
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> small;
      small.computeFromTridiagonal(diagonal.head(step + 1), beside.head(step));
      largest = small.eigenvalues()[step];
      const double residual = beside[step] * std::abs(small.eigenvectors()(step, step));
      if (last || residual < kResidual * largest) break;
    }
    q = product / beside[step];
  }
  return largest;
}

bool all_below(const sparse::BlockMatrix& k, std::span<const double> mass, double square) {
  sparse::BlockMatrix shifted = k;
  for (double& entry : shifted.value) entry = -entry;
  for (int i = 0; i < k.block_rows(); ++i) {
    double* own = shifted.block(static_cast<std::size_t>(shifted.find(i, i)));
    for (std::size_t r = 0; r < 3; ++r) own[4 * r] += square * mass[at(i)];
  }
  return fem::DirectSolver(shifted).positive_definite();
}

[[noreturn]] void refuse_undefined(int elements) {
  throw InputError(fmt::format(
      "the tangents of {} elements are not defined for these displacements; expected all",
      elements));
}

// Σ|∇Λ_a|², 1/m²
double sum_of_squares(const fem::ElementGeometry& geometry) {
  double sum = 0;
  for (const Eigen::Vector3d& g : geometry.gradient) sum += g.squaredNorm();
  return sum;
}

void expect_linear(const mesh::TetMesh& mesh) {
  if (mesh.quadratic()) throw std::invalid_argument("a bound of linear elements");
}

}  // namespace

FrequencyBounds largest_frequency(const sparse::BlockMatrix& k, std::span<const double> mass) {
  assert(mass.size() == at(k.block_rows()));
  if (!std::all_of(k.value.begin(), k.value.end(), [](double x) { return std::isfinite(x); })) {
    throw InputError("the stiffness has an entry that is not finite");
  }
  const double below = lanczos(k, mass);
  if (!(below > 0)) {
    throw InputError(
        fmt::format("the largest eigenvalue of M⁻¹K is {}; expected one above 0", below));
  }
  double margin = 1e-10;
  while (!all_below(k, mass, (1 + margin) * below)) margin *= 4;
  return {.at_least = std::sqrt(below), .at_most = std::sqrt((1 + margin) * below)};
}

FrequencyBounds largest_frequency(const PotentialBody& body, std::span<const double> u,
                                  std::span<const int> contact) {
  const fem::Body& of = body.body();
  sparse::BlockMatrix k = of.stiffness();
  const Deformation found = body.tangent(of.expand(u), Linearisation::exact, k);
  if (!found.defined()) refuse_undefined(found.undefined);
  const sparse::BlockMatrix all_mass = of.mass(fem::MassKind::lumped);
  std::vector<int> free;
  std::vector<double> mass;
  for (int a = 0; a < of.active_nodes(); ++a) {
    if (of.held(of.node_of_active()[at(a)]) ||
        std::binary_search(contact.begin(), contact.end(), a)) {
      continue;
    }
    free.push_back(a);
    mass.push_back(all_mass.block(static_cast<std::size_t>(all_mass.find(a, a)))[0]);
  }
  return largest_frequency(k.submatrix(free), mass);
}

double element_step(const ElasticBody& body, std::span<const double> u) {
  const mesh::TetMesh& mesh = body.body().mesh();
  expect_linear(mesh);
  assert(u.size() == 3 * mesh.nodes.size());
  double largest = 0;  // eigenvalue of K_e over the mass of a node
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const fem::ElementGeometry geometry = fem::element_geometry(mesh, static_cast<int>(e));
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
    for (std::size_t a = 0; a < 4; ++a) {
      f += Eigen::Map<const Eigen::Vector3d>(&u[3 * at(mesh.tetrahedra[e][a])]) *
           geometry.gradient[a].transpose();
    }
    const auto k = body.law(e).tangent(f, geometry, Linearisation::exact);
    if (!k || !k->allFinite()) refuse_undefined(1);
    const Eigen::SelfAdjointEigenSolver<fem::ElementMatrix> modes(*k, Eigen::EigenvaluesOnly);
    const double mass = body.body().materials().of(e).density_kg_m3 * geometry.volume() / 4;
    largest = std::max(largest, modes.eigenvalues()[11] / mass);
  }
  return 2 / std::sqrt(largest);
}

double closed_form_step(const mesh::TetMesh& mesh, const fem::Materials& materials) {
  expect_linear(mesh);
  double largest = 0;  // (λ + 2μ)/ρ·Σ|∇Λ_a|², 1/s²
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const fem::Material& material = materials.of(e);
    const double wave = (material.lame_lambda() + 2 * material.lame_mu()) / material.density_kg_m3;
    largest =
        std::max(largest, wave * sum_of_squares(fem::element_geometry(mesh, static_cast<int>(e))));
  }
  return 2 / std::sqrt(4 * largest);
}

double lagged_damping_step(double largest_frequency_rad_s, double rayleigh_stiffness_s) {
  const double xi = rayleigh_stiffness_s * largest_frequency_rad_s / 2;
  // √(1 + ξ²) − ξ without cancellation
  return 2 / (largest_frequency_rad_s * (std::sqrt(1 + xi * xi) + xi));
}

}  // namespace hvp::tissue
