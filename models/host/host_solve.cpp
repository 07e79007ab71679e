#include "models/host/host_solve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "models/config/input_error.h"

namespace hvp::host {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

constexpr double kEntry = sizeof(double);
constexpr double kIndex = sizeof(int);

}  // namespace

SolveWork product_work(const sparse::BlockMatrix& a) {
  const auto blocks = static_cast<double>(a.blocks());
  // A, its block columns and rows, x and y.
  return {.sparse = 18 * blocks,
          .bytes = blocks * (9 * kEntry + kIndex) + a.block_rows() * kIndex + 2 * a.rows() * kEntry,
          .barriers = 1};
}

SolveWork triangular_work(const fem::DirectSolver& solver) {
  const auto entries = static_cast<double>(solver.factor_nonzeros());
  // L and its transpose, an addition and a multiplication an entry each; D between them. L is read
  // twice, and the vector there and back: permuted, twice substituted, divided.
  return {.triangular = 4 * entries + solver.rows(),
          .bytes = 2 * entries * (kEntry + kIndex) + solver.rows() * (8 * kEntry + 2 * kIndex),
          .barriers = 2};
}

double factor_bytes(const fem::DirectSolver& solver) {
  return static_cast<double>(solver.factor_nonzeros()) * (kEntry + kIndex) +
         3 * solver.rows() * kEntry;
}

SolveWork factor_work(const fem::DirectSolver& solver) {
  const auto entries = static_cast<double>(solver.factor_nonzeros());
  return {.triangular = solver.factor_operations(), .bytes = entries * (kEntry + kIndex)};
}

SolveWork prescribed_work(double m, double n, double entry_bytes) {
  if (m == 0) return {};
  SolveWork work{.dense = 2 * m * m, .bytes = m * m * kEntry + m * n * entry_bytes};
  (entry_bytes < kEntry ? work.dense_single : work.dense) += 2 * m * n;
  return work;
}

SolveWork small_factor_work(double m) {
  return {.dense = 2.0 / 3.0 * m * m * m, .bytes = m * m * kEntry};
}

const char* name(Precision precision) {
  return precision == Precision::single_precision ? "single" : "double";
}

bool is_exact(SolvedBy solver, Precision precision) {
  const bool direct = solver == SolvedBy::cholesky || solver == SolvedBy::inverse ||
                      solver == SolvedBy::superposition || solver == SolvedBy::condensed;
  return direct && precision == Precision::double_precision;
}

const char* name(SolvedBy solver) {
  switch (solver) {
    case SolvedBy::board:
      return "board";
    case SolvedBy::cg:
      return "cg";
    case SolvedBy::cholesky:
      return "cholesky";
    case SolvedBy::inverse:
      return "inverse";
    case SolvedBy::superposition:
      return "superposition";
    case SolvedBy::condensed:
      return "condensed";
    case SolvedBy::steps:
      return "explicit";
  }
  return "";
}

ConjugateGradients::ConjugateGradients(const sparse::BlockMatrix& a, int iterations,
                                       double stop_residual, bool warm_start)
    : a_(a),
      most_iterations_(iterations),
      stop_residual_(stop_residual),
      warm_start_(warm_start),
      r_(static_cast<std::size_t>(a.rows())),
      d_(r_.size()),
      q_(r_.size()) {}

void ConjugateGradients::move_contact(std::span<const int> nodes) {
  contact_.assign(nodes.begin(), nodes.end());
}

void ConjugateGradients::clear_contact(std::span<double> v) const {
  for (const int node : contact_) std::fill_n(v.begin() + 3 * node, 3, 0.0);
}

// The first residual, its norm, and what the stop test needs.
SolveWork ConjugateGradients::first_residual_work() const {
  const auto n = static_cast<double>(r_.size());
  SolveWork work = product_work(a_) + SolveWork{.dense = 3 * n, .bytes = 7 * n * kEntry};
  if (stop_residual_ > 0) {
    work += product_work(a_) + SolveWork{.dense = 3 * n, .bytes = 6 * n * kEntry};
  }
  return work;
}

// A product, two inner products and three vector updates, and the two quotients between them.
SolveWork ConjugateGradients::iteration_work() const {
  const auto n = static_cast<double>(r_.size());
  return product_work(a_) + SolveWork{.dense = 10 * n + 2, .bytes = 12 * n * kEntry, .barriers = 3};
}

SolveWork ConjugateGradients::most_work() const {
  return first_residual_work() + most_iterations_ * iteration_work();
}

SolveMemory ConjugateGradients::memory() const {
  const double matrix = product_work(a_).bytes;
  const auto n = static_cast<double>(r_.size());
  const double all = matrix + 3 * n * kEntry;
  return {all, all, n * kEntry, n * kEntry};
}

void ConjugateGradients::place_contact(std::span<const Eigen::Vector3d> held,
                                       std::span<double> u) const {
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    for (int i = 0; i < 3; ++i) u[static_cast<std::size_t>(3 * contact_[n] + i)] = held[n][i];
  }
}

void ConjugateGradients::solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                               std::span<double> u) {
  if (!warm_start_) std::fill(u.begin(), u.end(), 0.0);
  place_contact(held, u);
  a_.multiply(u, q_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = f[i] - q_[i];
  clear_contact(r_);

  double limit = 0;
  if (stop_residual_ > 0) {
    // b: the rest of f where only the contact is displaced.
    std::fill(d_.begin(), d_.end(), 0.0);
    place_contact(held, d_);
    a_.multiply(d_, q_);
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = f[i] - q_[i];
    clear_contact(q_);
    limit = stop_residual_ * stop_residual_ * dot(q_, q_);
  }
  d_ = r_;
  double rr = dot(r_, r_);
  for (made_ = 0; made_ < most_iterations_ && rr > limit; ++made_) {
    a_.multiply(d_, q_);
    clear_contact(q_);
    const double curvature = dot(d_, q_);
    if (!(curvature > 0)) break;  // r is zero to rounding, or A is not positive definite
    const double alpha = rr / curvature;
    for (std::size_t i = 0; i < r_.size(); ++i) {
      u[i] += alpha * d_[i];
      r_[i] -= alpha * q_[i];
    }
    const double next = dot(r_, r_);
    const double beta = next / rr;
    for (std::size_t i = 0; i < r_.size(); ++i) d_[i] = r_[i] + beta * d_[i];
    rr = next;
  }
  work_ = first_residual_work() + made_ * iteration_work();
}

Prefactored::Prefactored(const sparse::BlockMatrix& a)
    : solver_(a), right_hand_side_(static_cast<std::size_t>(a.rows())) {
  if (!solver_.positive_definite()) {
    throw InputError("the matrix is not positive definite; host.solver = \"cholesky\" needs one");
  }
}

SolveMemory Prefactored::memory() const {
  const double vector = solver_.rows() * kEntry;
  const double factors = factor_bytes(solver_);
  const double all = factors + 3.0 * static_cast<double>(contact_.size()) * vector;
  return {all, all, vector, vector, factors};
}

void Prefactored::move_contact(std::span<const int> nodes) {
  contact_.assign(nodes.begin(), nodes.end());
  // A⁻¹'s columns, and the factors of the small dense matrix.
  const int m = 3 * static_cast<int>(nodes.size());
  contact_work_ = m * triangular_work(solver_) + small_factor_work(m);
}

void Prefactored::solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                        std::span<double> u) {
  std::copy(f.begin(), f.end(), right_hand_side_.begin());
  const auto m = 3.0 * static_cast<double>(contact_.size());
  if (contact_.empty()) {
    solver_.solve(right_hand_side_, u);
  } else {
    solver_.solve_with_contact(right_hand_side_, contact_, held, u);
  }
  work_ = triangular_work(solver_) + prescribed_work(m, solver_.rows(), kEntry);
}

HostMethod::HostMethod(SolvedBy solver, std::unique_ptr<HostSolve> solve,
                       std::span<const double> initial)
    : solver_(solver), solve_(std::move(solve)), u_(initial.begin(), initial.end()) {}

void HostMethod::begin(std::span<const double> f, const fem::Hold& hold) {
  f_ = f;
  hold_ = hold;
}

bool HostMethod::next(std::span<std::int32_t> /*b*/) {
  solve_->solve(f_, hold_.displacement, u_);
  return false;
}

std::vector<Step> HostMethod::steps() const {
  std::vector<Step> all = {{std::string("solve on the host (") + name(solver_) + ")",
                            Step::Where::solver, 0, 1, false, solve_->most_work(),
                            solve_->memory()}};
  if (const SolveWork rest = solve_->rest_work(); rest.operations() > 0) {
    all.push_back({"the other nodes", Step::Where::core, 0, 1, true, rest, solve_->memory()});
  }
  return all;
}

}  // namespace hvp::host
