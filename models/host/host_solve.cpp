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

double product_operations(const sparse::BlockMatrix& a) {
  return 18.0 * static_cast<double>(a.blocks());
}

}  // namespace

const char* name(SolvedBy solver) {
  switch (solver) {
    case SolvedBy::board:
      return "board";
    case SolvedBy::cg:
      return "cg";
    case SolvedBy::cholesky:
      return "cholesky";
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

// The first residual and what the stop test needs, and the iterations; as solve() counts them.
double ConjugateGradients::most_operations() const {
  const auto n = static_cast<double>(r_.size());
  const double product = product_operations(a_);
  const double begin = product + 3 * n + (stop_residual_ > 0 ? product + 3 * n : 0);
  return begin + most_iterations_ * (product + 10 * n + 2);
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
  const auto n = static_cast<double>(r_.size());
  a_.multiply(u, q_);
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = f[i] - q_[i];
  clear_contact(r_);
  operations_ = product_operations(a_) + n;

  double limit = 0;
  if (stop_residual_ > 0) {
    // b: the rest of f where only the contact is displaced.
    std::fill(d_.begin(), d_.end(), 0.0);
    place_contact(held, d_);
    a_.multiply(d_, q_);
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = f[i] - q_[i];
    clear_contact(q_);
    limit = stop_residual_ * stop_residual_ * dot(q_, q_);
    operations_ += product_operations(a_) + 3 * n;
  }
  d_ = r_;
  double rr = dot(r_, r_);
  operations_ += 2 * n;
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
    // A product, two inner products and three vector updates.
    operations_ += product_operations(a_) + 10 * n + 2;
  }
}

Prefactored::Prefactored(const sparse::BlockMatrix& a)
    : solver_(a), right_hand_side_(static_cast<std::size_t>(a.rows())) {
  if (!solver_.positive_definite()) {
    throw InputError("the matrix is not positive definite; host.solver = \"cholesky\" needs one");
  }
}

// L and its transpose, an addition and a multiplication an entry each; D between them.
double Prefactored::triangular_operations() const {
  return 4.0 * static_cast<double>(solver_.factor_nonzeros()) + solver_.rows();
}

void Prefactored::move_contact(std::span<const int> nodes) {
  contact_.assign(nodes.begin(), nodes.end());
  const auto m = 3.0 * static_cast<double>(nodes.size());
  // A⁻¹'s columns, and the factors of the small dense matrix.
  contact_operations_ = m * triangular_operations() + 2.0 / 3.0 * m * m * m;
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
  // The small system, and its force's share of every unknown.
  operations_ = triangular_operations() + 2 * m * m + 2 * m * solver_.rows();
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
  return {{std::string("solve on the host (") + name(solver_) + ")", Step::Where::solver,
           solve_->most_operations()}};
}

}  // namespace hvp::host
