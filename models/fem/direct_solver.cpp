#include "models/fem/direct_solver.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/dense_lu.h"
#include "models/index.h"

namespace hvp::fem {

namespace {

std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }

}  // namespace

DirectSolver::DirectSolver(const sparse::BlockMatrix& a) : rows_(a.rows()) {
  for (const double entry : a.value) {
    if (!std::isfinite(entry)) {
      throw InputError(
          fmt::format("the matrix has an entry that is {}; expected finite entries", entry));
    }
  }
  scratch_.assign(index(rows_), 0.0);
  if (rows_ == 0) return;
  factorisation_.compute(a.to_eigen());
  // A pivot that cancellation has left with fewer than two digits is zero as far as double
  // precision can tell.
  double largest = 0;
  if (factorisation_.info() == Eigen::Success) {
    const Eigen::VectorXd d = factorisation_.vectorD();
    pivot_.assign(d.data(), d.data() + d.size());
    substitution_ = Substitution(factor(), rows_);
    for (const double pivot : pivot_) largest = std::max(largest, std::abs(pivot));
  } else {
    singular_ = true;
  }
  for (const double pivot : pivot_) {
    if (!std::isfinite(pivot) || std::abs(pivot) <= 1e-14 * largest) singular_ = true;
    if (pivot < 0) ++negative_pivots_;
  }
}

double DirectSolver::factor_operations() const {
  if (pivot_.empty()) return 0;
  const auto& l = factorisation_.matrixL().nestedExpression();
  double sum = 0;
  for (int column = 0; column < rows_; ++column) {
    const double below = l.outerIndexPtr()[column + 1] - l.outerIndexPtr()[column];
    sum += below * (below + 2);
  }
  return sum;
}

std::size_t DirectSolver::factor_nonzeros() const {
  if (pivot_.empty()) return 0;
  return index(factorisation_.matrixL().nestedExpression().nonZeros());
}

TriangularFactor DirectSolver::factor() const {
  const auto& l = factorisation_.matrixL().nestedExpression();
  return {l.outerIndexPtr(), l.innerIndexPtr(), l.valuePtr()};
}

void DirectSolver::require_regular() const {
  if (!singular_) return;
  throw InputError(fmt::format(
      "the system of {} unknowns is singular to double precision; expected a body that is held "
      "and a matrix without empty rows",
      rows_));
}

void DirectSolver::solve(std::span<const double> b, std::span<double> x) const {
  assert(b.size() == index(rows_) && x.size() == b.size());
  require_regular();
  if (rows_ == 0) return;
  const int* place = permutation();
  for (int i = 0; i < rows_; ++i) scratch_[index(place[i])] = b[index(i)];
  substitution_.forward(factor(), scratch_.data());
  for (std::size_t i = 0; i < scratch_.size(); ++i) scratch_[i] /= pivot_[i];
  substitution_.backward(factor(), scratch_.data());
  for (int i = 0; i < rows_; ++i) x[index(i)] = scratch_[index(place[i])];
}

void DirectSolver::prepare_contact(std::span<const int> patch) {
  if (std::equal(patch.begin(), patch.end(), contact_.begin(), contact_.end())) return;
  for (const int node : patch) {
    if (node < 0 || 3 * node >= rows_) {
      throw InputError(
          fmt::format("the contact node is {}; expected 0 to {}", node, rows_ / 3 - 1));
    }
  }
  contact_.clear();
  const std::size_t n = index(rows_);
  const std::size_t m = 3 * patch.size();
  contact_columns_.assign(m * n, 0.0);
  contact_schur_.resize(m);
  contact_force_.assign(m, 0.0);
  for (std::size_t c = 0; c < m; ++c) {
    const std::span<double> column(&contact_columns_[c * n], n);
    column[3 * index(patch[c / 3]) + c % 3] = 1;
    solve(column, column);
    for (std::size_t r = 0; r < m; ++r) {
      contact_schur_(r, c) = column[3 * index(patch[r / 3]) + r % 3];
    }
  }
  contact_schur_.factorise();
  contact_.assign(patch.begin(), patch.end());
}

void DirectSolver::solve_with_contact(std::span<const double> f, int node,
                                      const Eigen::Vector3d& u_c, std::span<double> x) {
  solve_with_contact(f, std::span<const int>(&node, 1), u_c, x);
}

void DirectSolver::solve_with_contact(std::span<const double> f, std::span<const int> patch,
                                      const Eigen::Vector3d& u_c, std::span<double> x) {
  solve_with_contact(f, patch, std::span<const Eigen::Vector3d>(&u_c, 1), x);
}

void DirectSolver::solve_with_contact(std::span<const double> f, std::span<const int> patch,
                                      std::span<const Eigen::Vector3d> u, std::span<double> x) {
  prepare_contact(patch);
  solve(f, x);
  impose_contact(u, x);
}

// Adds to x = A⁻¹f what the contact's forces do.
void DirectSolver::impose_contact(std::span<const Eigen::Vector3d> u, std::span<double> x) {
  assert(u.size() == 1 || u.size() == contact_.size());
  const std::size_t n = index(rows_);
  const std::size_t m = contact_force_.size();
  const auto held = [&](std::size_t c) {
    return u[u.size() == 1 ? 0 : c / 3][static_cast<Eigen::Index>(c % 3)];
  };
  for (std::size_t c = 0; c < m; ++c) {
    contact_force_[c] = held(c) - x[3 * index(contact_[c / 3]) + c % 3];
  }
  contact_schur_.solve(contact_force_);
  for (std::size_t c = 0; c < m; ++c) {
    const double* column = &contact_columns_[c * n];
    for (std::size_t i = 0; i < n; ++i) x[i] += contact_force_[c] * column[i];
  }
  for (std::size_t c = 0; c < m; ++c) x[3 * index(contact_[c / 3]) + c % 3] = held(c);
}

ReferencePair::ReferencePair(DirectSolver& one, DirectSolver& other) : one_(one), other_(other) {
  one.require_regular();
  other.require_regular();
  const int rows = one.rows();
  if (rows == 0 || other.rows() != rows) return;
  const TriangularFactor l = one.factor();
  const TriangularFactor m = other.factor();
  alike_ = std::equal(l.begin, l.begin + rows + 1, m.begin) &&
           std::equal(l.row, l.row + l.begin[rows], m.row) &&
           std::equal(one.permutation(), one.permutation() + rows, other.permutation());
  if (!alike_) return;
  factor_.reserve(2 * at(l.begin[rows]));
  static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= 16);  // as Substitution asks
  for (int k = 0; k < l.begin[rows]; ++k) {
    factor_.push_back(l.value[k]);
    factor_.push_back(m.value[k]);
  }
  scratch_.resize(2 * at(rows));
}

void ReferencePair::solve(const System& one, const System& other) {
  if (!alike_) {
    one_.solve(one.f, one.x);
    other_.solve(other.f, other.x);
    return;
  }
  const std::size_t rows = scratch_.size() / 2;
  assert(one.f.size() == rows && other.f.size() == rows);
  assert(one.x.size() == rows && other.x.size() == rows);
  const int* place = one_.permutation();
  for (std::size_t i = 0; i < rows; ++i) {
    double* const entry = &scratch_[2 * at(place[i])];
    entry[0] = one.f[i];
    entry[1] = other.f[i];
  }
  TriangularFactor both = one_.factor();
  both.value = factor_.data();
  one_.substitution_.forward_both(both, scratch_.data());
  for (std::size_t i = 0; i < rows; ++i) {
    scratch_[2 * i] /= one_.pivot_[i];
    scratch_[2 * i + 1] /= other_.pivot_[i];
  }
  one_.substitution_.backward_both(both, scratch_.data());
  for (std::size_t i = 0; i < rows; ++i) {
    const double* const entry = &scratch_[2 * at(place[i])];
    one.x[i] = entry[0];
    other.x[i] = entry[1];
  }
}

void ReferencePair::solve_with_contact(const System& one, const System& other,
                                       std::span<const int> patch,
                                       std::span<const Eigen::Vector3d> u) {
  one_.prepare_contact(patch);
  other_.prepare_contact(patch);
  solve(one, other);
  one_.impose_contact(u, one.x);
  other_.impose_contact(u, other.x);
}

namespace {

constexpr int kMostSteps = 1000;

// Entries in [-1, 1) from a fixed linear congruential sequence (Knuth's MMIX constants): no
// eigenvector of a real body is orthogonal to it.
std::vector<double> start_vector(std::size_t size) {
  std::vector<double> x(size);
  std::uint64_t state = 1;
  for (double& entry : x) {
    state = 6364136223846793005u * state + 1442695040888963407u;
    entry = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
  return x;
}

double dot(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

// The largest eigenvalue of the operator `apply(x, y)`: y = A·x.
template <class Apply>
double power_iteration(std::size_t size, double tolerance, const Apply& apply) {
  std::vector<double> x = start_vector(size);
  std::vector<double> y(size);
  double value = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const double scale = 1 / std::sqrt(dot(x, x));
    for (double& entry : x) entry *= scale;
    apply(x, y);
    const double previous = value;
    value = dot(x, y);
    if (std::abs(value - previous) <= tolerance * std::abs(value)) break;
    x.swap(y);
  }
  return value;
}

}  // namespace

Spectrum extreme_eigenvalues(const sparse::BlockMatrix& a, const DirectSolver& solver,
                             double tolerance) {
  if (!solver.positive_definite()) {
    throw InputError(fmt::format("the matrix is not positive definite ({} negative eigenvalues)",
                                 solver.negative_eigenvalues()));
  }
  const auto size = static_cast<std::size_t>(a.rows());
  Spectrum result;
  result.largest =
      power_iteration(size, tolerance, [&a](const auto& x, auto& y) { a.multiply(x, y); });
  result.smallest = 1 / power_iteration(size, tolerance,
                                        [&solver](const auto& x, auto& y) { solver.solve(x, y); });
  return result;
}

}  // namespace hvp::fem
