#include "models/host/host_solve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::host {

namespace {

template <class Real>
double dot(const std::vector<Real>& a, const std::vector<Real>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  }
  return sum;
}

template <class Real>
constexpr bool kSingle = sizeof(Real) == sizeof(float);

constexpr double kEntry = sizeof(double);
constexpr double kIndex = sizeof(int);

}  // namespace

SolveWork product_work(const sparse::BlockMatrix& a, double entry_bytes) {
  const auto blocks = static_cast<double>(a.blocks());
  // A, its block columns and rows, x and y.
  return {.sparse = 18 * blocks,
          .bytes = blocks * (9 * entry_bytes + kIndex) + a.block_rows() * kIndex +
                   2 * a.rows() * entry_bytes,
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

template <class Real>
ConjugateGradients<Real>::ConjugateGradients(const sparse::BlockMatrix& a, int iterations,
                                             double stop_residual, bool warm_start)
    : a_(a),
      most_iterations_(iterations),
      stop_residual_(stop_residual),
      warm_start_(warm_start),
      x_(static_cast<std::size_t>(a.rows())),
      r_(x_.size()),
      d_(x_.size()),
      q_(x_.size()) {
  if constexpr (kSingle<Real>) {
    entries_.resize(a.value.size());
    std::ranges::transform(a.value, entries_.begin(),
                           [](double entry) { return static_cast<Real>(entry); });
  }
}

template <class Real>
void ConjugateGradients<Real>::move_contact(std::span<const int> nodes) {
  contact_.assign(nodes.begin(), nodes.end());
}

template <class Real>
void ConjugateGradients<Real>::clear_contact(std::vector<Real>& v) const {
  for (const int node : contact_) std::fill_n(v.begin() + 3 * node, 3, Real{0});
}

template <class Real>
void ConjugateGradients<Real>::multiply(const std::vector<Real>& x, std::vector<Real>& y) const {
  if constexpr (kSingle<Real>) {
    const Real* a = entries_.data();
    for (std::size_t row = 0; row + 1 < a_.row_begin.size(); ++row) {
      Real sum[3] = {0, 0, 0};
      for (int k = a_.row_begin[row]; k < a_.row_begin[row + 1]; ++k) {
        const Real* const v = x.data() + 3 * at(a_.column[at(k)]);
        for (std::size_t i = 0; i < 3; ++i) {
          sum[i] += a[3 * i] * v[0] + a[3 * i + 1] * v[1] + a[3 * i + 2] * v[2];
        }
        a += 9;
      }
      std::copy_n(sum, 3, y.begin() + static_cast<std::ptrdiff_t>(3 * row));
    }
  } else {
    a_.multiply(x, y);
  }
}

// So many operations on vectors of so many of which are read or written.
template <class Real>
SolveWork ConjugateGradients<Real>::vectors_work(double operations, double vectors) const {
  SolveWork work{.bytes = vectors * vector_bytes()};
  (kSingle<Real> ? work.dense_single : work.dense) = operations;
  return work;
}

// The first residual, its norm, and what the stop test needs.
template <class Real>
SolveWork ConjugateGradients<Real>::first_residual_work() const {
  const auto n = static_cast<double>(r_.size());
  SolveWork work = product_work(a_, sizeof(Real)) + vectors_work(3 * n, 7);
  if (stop_residual_ > 0) work += product_work(a_, sizeof(Real)) + vectors_work(3 * n, 6);
  return work;
}

// A product, two inner products and three vector updates, and the two quotients between them.
template <class Real>
SolveWork ConjugateGradients<Real>::iteration_work() const {
  const auto n = static_cast<double>(r_.size());
  SolveWork work = product_work(a_, sizeof(Real)) + vectors_work(10 * n + 2, 12);
  work.barriers += 3;
  return work;
}

// Loads to single precision and displacements back.
template <class Real>
SolveWork ConjugateGradients<Real>::conversion_work() const {
  const auto n = static_cast<double>(r_.size());
  return kSingle<Real> ? SolveWork{.sparse = 2 * n, .bytes = 2 * n * (kEntry + sizeof(Real))}
                       : SolveWork{};
}

template <class Real>
SolveWork ConjugateGradients<Real>::most_work() const {
  return first_residual_work() + most_iterations_ * iteration_work() + conversion_work();
}

template <class Real>
SolveWork ConjugateGradients<Real>::set_up_work() const {
  const auto entries = static_cast<double>(entries_.size());
  return {.sparse = entries, .bytes = entries * (kEntry + sizeof(Real))};
}

template <class Real>
SolveMemory ConjugateGradients<Real>::memory() const {
  const double matrix = product_work(a_, sizeof(Real)).bytes;
  const double all = matrix + 3 * vector_bytes();
  return {all, all, vector_bytes(), vector_bytes(), matrix};
}

template <class Real>
void ConjugateGradients<Real>::place_contact(std::span<const Eigen::Vector3d> held,
                                             std::vector<Real>& u) const {
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    for (int i = 0; i < 3; ++i) u[at(3 * contact_[n] + i)] = static_cast<Real>(held[n][i]);
  }
}

template <class Real>
void ConjugateGradients<Real>::solve(std::span<const double> f,
                                     std::span<const Eigen::Vector3d> held, std::span<double> u) {
  const auto to_real = [](double value) { return static_cast<Real>(value); };
  if (warm_start_) {
    std::ranges::transform(u, x_.begin(), to_real);
  } else {
    std::ranges::fill(x_, Real{0});
  }
  place_contact(held, x_);
  multiply(x_, q_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = to_real(f[i]) - q_[i];
  clear_contact(r_);

  double limit = 0;
  if (stop_residual_ > 0) {
    // b: the rest of f where only the contact is displaced.
    std::ranges::fill(d_, Real{0});
    place_contact(held, d_);
    multiply(d_, q_);
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = to_real(f[i]) - q_[i];
    clear_contact(q_);
    limit = stop_residual_ * stop_residual_ * dot(q_, q_);
  }
  d_ = r_;
  double rr = dot(r_, r_);
  for (made_ = 0; made_ < most_iterations_ && rr > limit; ++made_) {
    multiply(d_, q_);
    clear_contact(q_);
    const double curvature = dot(d_, q_);
    if (!(curvature > 0)) break;  // r is zero to rounding, or A is not positive definite
    const auto alpha = to_real(rr / curvature);
    for (std::size_t i = 0; i < r_.size(); ++i) {
      x_[i] += alpha * d_[i];
      r_[i] -= alpha * q_[i];
    }
    const double next = dot(r_, r_);
    const auto beta = to_real(next / rr);
    for (std::size_t i = 0; i < r_.size(); ++i) d_[i] = r_[i] + beta * d_[i];
    rr = next;
  }
  std::ranges::transform(x_, u.begin(), [](Real x) { return static_cast<double>(x); });
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    for (int i = 0; i < 3; ++i) u[at(3 * contact_[n] + i)] = held[n][i];
  }
  work_ = first_residual_work() + made_ * iteration_work() + conversion_work();
}

template class ConjugateGradients<float>;
template class ConjugateGradients<double>;

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
