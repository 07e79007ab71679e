#include "models/fem/contact.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fem {
const std::vector<std::pair<std::string_view, ContactDiagonal>>& contact_diagonal_names() {
  static const std::vector<std::pair<std::string_view, ContactDiagonal>> names = {
      {"average", ContactDiagonal::average}, {"one", ContactDiagonal::one}};
  return names;
}

double mean_diagonal(const sparse::BlockMatrix& a) {
  double sum = 0;
  for (int i = 0; i < a.block_rows(); ++i) {
    const std::ptrdiff_t k = a.find(i, i);
    if (k < 0) continue;
    const double* block = a.block(static_cast<std::size_t>(k));
    sum += block[0] + block[4] + block[8];
  }
  return a.rows() > 0 ? sum / a.rows() : 0.0;
}

ContactConstraint::ContactConstraint(const sparse::BlockMatrix& a, ContactDiagonal diagonal)
    : a_(a), diagonal_(diagonal == ContactDiagonal::one ? 1.0 : mean_diagonal(a)) {}

void ContactConstraint::check(std::span<const int> patch) const {
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (patch[i] < 0 || patch[i] >= a_.block_rows()) {
      throw InputError(
          fmt::format("the contact node is {}; expected 0 to {}", patch[i], a_.block_rows() - 1));
    }
    if (i > 0 && patch[i] <= patch[i - 1]) {
      throw InputError(
          fmt::format("the contact patch names node {} after node {}; expected "
                      "ascending nodes, each once",
                      patch[i], patch[i - 1]));
    }
  }
}

void ContactConstraint::modified_rhs(std::span<const double> f, int node,
                                     const Eigen::Vector3d& u_c, std::span<double> b) const {
  modified_rhs(f, std::span<const int>(&node, 1), u_c, b);
}

void ContactConstraint::modified_rhs(std::span<const double> f, std::span<const int> patch,
                                     const Eigen::Vector3d& u_c, std::span<double> b) const {
  move_columns(
      f, patch, [&](std::size_t) -> const Eigen::Vector3d& { return u_c; }, b);
}

void ContactConstraint::modified_rhs(std::span<const double> f, std::span<const int> patch,
                                     std::span<const Eigen::Vector3d> u,
                                     std::span<double> b) const {
  assert(u.size() == patch.size());
  move_columns(
      f, patch, [&](std::size_t i) -> const Eigen::Vector3d& { return u[i]; }, b);
}

template <class Displacement>
void ContactConstraint::move_columns(std::span<const double> f, std::span<const int> patch,
                                     const Displacement& displacement, std::span<double> b) const {
  check(patch);
  assert(f.size() == at(a_.rows()) && b.size() == f.size());
  std::copy(f.begin(), f.end(), b.begin());
  for (std::size_t i = 0; i < patch.size(); ++i) {
    a_.subtract_column(patch[i], displacement(i), b);
  }
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const Eigen::Vector3d& u = displacement(i);
    for (int r = 0; r < 3; ++r) b[3 * at(patch[i]) + at(r)] = diagonal_ * u[r];
  }
}

sparse::BlockMatrix ContactConstraint::modified_matrix(int node) const {
  return modified_matrix(std::span<const int>(&node, 1));
}

sparse::BlockMatrix ContactConstraint::modified_matrix(std::span<const int> patch) const {
  check(patch);
  sparse::BlockMatrix result = a_;
  for (const int node : patch) {
    for (int k = a_.row_begin[at(node)]; k < a_.row_begin[at(node) + 1]; ++k) {
      const int neighbour = a_.column[at(k)];
      const std::ptrdiff_t mirror = result.find(neighbour, node);
      std::fill_n(result.block(at(k)), 9, 0.0);
      if (mirror >= 0) std::fill_n(result.block(static_cast<std::size_t>(mirror)), 9, 0.0);
    }
    double* block = result.block(static_cast<std::size_t>(result.find(node, node)));
    for (std::size_t r = 0; r < 3; ++r) block[4 * r] = diagonal_;
  }
  return result;
}

Eigen::Vector3d ContactConstraint::reaction_of(std::span<const double> u, std::span<const double> f,
                                               int node) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (int k = a_.row_begin[at(node)]; k < a_.row_begin[at(node) + 1]; ++k) {
    const double* block = a_.block(at(k));
    const double* v = &u[3 * at(a_.column[at(k)])];
    for (int r = 0; r < 3; ++r) {
      const double* row = block + 3 * r;
      force[r] += row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
    }
  }
  for (int r = 0; r < 3; ++r) force[r] -= f[3 * at(node) + at(r)];
  return force;
}

Eigen::Vector3d ContactConstraint::reaction(std::span<const double> u, std::span<const double> f,
                                            int node) const {
  return reaction(u, f, std::span<const int>(&node, 1));
}

Eigen::Vector3d ContactConstraint::reaction(std::span<const double> u, std::span<const double> f,
                                            std::span<const int> patch) const {
  check(patch);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const int node : patch) force += reaction_of(u, f, node);
  return force;
}

Eigen::Vector3d ContactConstraint::reaction(std::span<const double> u, std::span<const double> f,
                                            std::span<const int> patch, HeldForces& forces) const {
  check(patch);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int node : patch) {
    const Eigen::Vector3d force = reaction_of(u, f, node);
    forces.set(node, force);
    sum += force;
  }
  return sum;
}

double ContactConstraint::blocks_of(std::span<const int> patch) const {
  check(patch);
  double blocks = 0;
  for (const int node : patch) {
    blocks += a_.row_begin[at(node) + 1] - a_.row_begin[at(node)];
  }
  return blocks;
}

double ContactConstraint::modified_rhs_flops(int node) const {
  return modified_rhs_flops(std::span<const int>(&node, 1));
}

double ContactConstraint::modified_rhs_flops(std::span<const int> patch) const {
  return 18 * blocks_of(patch) + 3 * static_cast<double>(patch.size());
}

double ContactConstraint::reaction_flops(int node) const {
  return reaction_flops(std::span<const int>(&node, 1));
}

double ContactConstraint::reaction_flops(std::span<const int> patch) const {
  return 18 * blocks_of(patch) + 3 * static_cast<double>(patch.size());
}

std::vector<int> contact_patch(const mesh::TetMesh& mesh, int node, double radius) {
  if (node < 0 || at(node) >= mesh.nodes.size()) {
    throw InputError(fmt::format("the contact node is {}; expected 0 to {}", node,
                                 static_cast<std::ptrdiff_t>(mesh.nodes.size()) - 1));
  }
  const Eigen::Vector3d& centre = mesh.nodes[at(node)];
  // A node on the rim belongs to the patch whatever the last bit of its coordinates.
  const double reach = radius * (1 + 1e-9);
  std::vector<int> patch = {node};
  for (const auto& triangle : mesh.boundary) {
    for (const int corner : triangle) {
      if ((mesh.nodes[at(corner)] - centre).norm() <= reach) patch.push_back(corner);
    }
  }
  std::sort(patch.begin(), patch.end());
  patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
  return patch;
}

}  // namespace hvp::fem
