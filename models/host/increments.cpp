#include "models/host/increments.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::host {

namespace {

double square(double v) { return v * v; }

// A residual of so many times the largest right-hand side is on its way out of double precision.
constexpr double kBeyond = 1e3;
// Nor is any body displaced by so much, m: squares and cubes of it are far within double precision.
constexpr double kFarthest = 1e9;
// How often an increment is halved after which the residual has grown, a pass.
constexpr int kMostHalvings = 3;

}  // namespace

Increments::Increments(fem::InternalForces& forces, const sparse::BlockMatrix& a,
                       std::span<const double> initial, fixed::Start start,
                       double displacement_unit, double force_unit)
    : forces_(forces),
      a_(a),
      start_(start),
      length_(std::ldexp(1.0, -std::ilogb(displacement_unit))),
      force_(std::ldexp(1.0, -std::ilogb(force_unit))),
      noise_(forces.rounding_n()),
      u_(initial.begin(), initial.end()),
      product_(u_.size()),
      before_(u_),
      gone_on_from_(u_),
      solution_(u_),
      f_(u_.size()),
      b_(u_.size()),
      r_(u_.size()) {
  contact_.reserve(at(a.block_rows()));
  moved_.reserve(at(a.block_rows()));
  forces_.evaluate(u_, product_);
  solution_product_ = product_;
  guess_ = u_;
  guess_product_ = product_;
  if (start_ == fixed::Start::zero) {
    std::fill(guess_.begin(), guess_.end(), 0.0);
    std::fill(guess_product_.begin(), guess_product_.end(), 0.0);
  }
}

// Notes what an evaluation found; false where the sums are of no use: elements without forces, or
// forces that are beyond all bounds.
bool Increments::look(const fem::ElementsFound& found) {
  inverted_ = std::max(inverted_, found.inverted);
  overflown_ = std::max(overflown_, found.overflown);
  if (forces_.linear()) return true;
  if (!found.defined()) return false;
  form_difference();
  present_ = weighed(r_);
  if (!bounded()) return false;
  // A right-hand side that is rounding alone bounds nothing.
  const double rounding = force_ * noise_ * std::sqrt(static_cast<double>(r_.size()));
  return present_ <= square(kBeyond * largest_rhs_) || largest_rhs_ <= rounding;
}

// The loads of a body in motion grow with what has grown: their size alone bounds nothing.
bool Increments::bounded() const {
  return std::isfinite(present_) &&
         std::ranges::all_of(u_, [](double u) { return std::abs(u) <= kFarthest; });
}

void Increments::require_finite(std::span<const double> f) const {
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (std::isfinite(f[i])) continue;
    throw InputError("right-hand side entry " + std::to_string(i) + " is not a finite number");
  }
}

void Increments::go_on(std::span<const double> f) {
  require_finite(f);
  std::copy(f.begin(), f.end(), f_.begin());
  b_ = f_;
  gone_on_from_ = u_;
  went_on_ = true;
  first_ = true;
  refused_ = false;
  if (forces_.linear() || no_start_) return;
  largest_rhs_ = std::max(largest_rhs_, std::sqrt(weighed(b_)));
  // The next increment is measured by this load, too.
  if (current_) present_ = (form_difference(), weighed(r_));
}

void Increments::begin(std::span<const double> f, const fem::Hold& hold) {
  require_finite(f);
  went_on_ = false;
  std::copy(f.begin(), f.end(), f_.begin());
  contact_.assign(hold.nodes.begin(), hold.nodes.end());
  first_ = true;
  diverged_ = false;
  inverted_ = 0;
  overflown_ = 0;
  b_ = f_;
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    a_.subtract_column(contact_[n], hold.displacement[n], b_);
  }
  for (const int node : contact_) std::fill_n(&b_[3 * at(node)], 3, 0.0);
  if (!forces_.linear()) largest_rhs_ = std::max(largest_rhs_, std::sqrt(weighed(b_)));
  evaluations_ = 0;
  refused_ = false;
  no_start_ = !place_contact(hold, guess_, guess_product_);
  // The way that the last frames went on may lead where the solution itself did not.
  if (no_start_ && start_ == fixed::Start::extrapolated) {
    no_start_ = !place_contact(hold, solution_, solution_product_);
  }
  if (no_start_) u_ = solution_;
}

// Starts from a displacement and its q, with the contact where it is prescribed. False where
// elements have no forces there.
bool Increments::place_contact(const fem::Hold& hold, const std::vector<double>& from,
                               const std::vector<double>& product) {
  u_ = from;
  product_ = product;
  current_ = true;
  moved_.clear();
  for (std::size_t n = 0; n < contact_.size(); ++n) {
    const Eigen::Vector3d& u_c = hold.displacement[n];
    double* u = &u_[3 * at(contact_[n])];
    moved_.emplace_back(u_c[0] - u[0], u_c[1] - u[1], u_c[2] - u[2]);
    for (int i = 0; i < 3; ++i) u[i] = u_c[i];
  }
  return look(forces_.follow(contact_, moved_, u_, product_));
}

// The last increment led where elements have no forces.
void Increments::take_back() {
  u_ = before_;
  refused_ = true;
  current_ = true;
  ++evaluations_;
  look(forces_.evaluate(u_, product_));
}

void Increments::form_difference() {
  for (std::size_t i = 0; i < r_.size(); ++i) r_[i] = f_[i] - product_[i];
  for (const int node : contact_) std::fill_n(&r_[3 * at(node)], 3, 0.0);
}

// Forces that cancel at rest leave their rounding, which no solver can take away. Never true of
// A·u, whose forces at rest are zero.
bool Increments::rounding_alone() const {
  return noise_ > 0 && std::ranges::all_of(r_, [this](double r) { return std::abs(r) <= noise_; });
}

// ‖v‖², in units in which no square leaves the range of double precision, whatever the load's size.
double Increments::weighed(std::span<const double> v) const {
  double sum = 0;
  for (const double x : v) sum += square(force_ * x);
  return sum;
}

// Where the residual has grown the last increment was too long for this matrix, and is halved.
bool Increments::evaluate_increment() {
  current_ = true;
  ++evaluations_;
  bool found = look(forces_.evaluate(u_, product_));
  for (int i = 0; i < kMostHalvings && !(found && present_ <= before_residual_); ++i) {
    for (std::size_t k = 0; k < u_.size(); ++k) u_[k] = 0.5 * (u_[k] + before_[k]);
    ++evaluations_;
    found = look(forces_.evaluate(u_, product_));
  }
  return found;
}

bool Increments::form_residual() {
  if (no_start_ || refused_) return false;
  evaluations_ = 0;
  if (forces_.linear()) {
    if (!current_) {
      forces_.evaluate(u_, product_);
      ++evaluations_;
    }
    current_ = true;
    form_difference();
    return true;
  }
  if (!current_ && !evaluate_increment()) {
    take_back();
    return false;
  }
  form_difference();
  if (first_) at_first_ = present_;
  first_ = false;
  before_residual_ = present_;
  return !rounding_alone();
}

bool Increments::within(double tolerance) const {
  const double limit = tolerance * std::max(largest_rhs_, std::sqrt(weighed(b_)));
  return std::sqrt(weighed(r_)) <= std::max(limit, force_ * imperceptible_n_);
}

std::span<double> Increments::change() {
  if (!forces_.linear()) before_ = u_;
  current_ = false;
  return u_;
}

bool Increments::finish(double tolerance) {
  evaluations_ = 0;
  if (!current_) {
    current_ = true;
    ++evaluations_;
    if (!look(forces_.evaluate(u_, product_))) take_back();
  }
  if (no_start_) {
    ++without_start_;
    went_on_ = false;
    abandon();
    if (start_ != fixed::Start::zero) guess_ = solution_;
    return false;
  }
  form_difference();
  double residual = 0;
  double rhs = 0;
  double energy = 0;  // −2·(½uᵀAu − bᵀu) outside the contact: positive where u is better than zero
  for (std::size_t i = 0; i < r_.size(); ++i) {
    residual += square(force_ * r_[i]);
    rhs += square(force_ * b_[i]);
    energy += length_ * u_[i] * (force_ * (b_[i] + r_[i]));
  }
  largest_rhs_ = std::max(largest_rhs_, std::sqrt(rhs));
  remaining_ = residual == 0 || rounding_alone() ? 0 : std::sqrt(residual) / largest_rhs_;
  worst_remaining_ = std::max(worst_remaining_, remaining_);
  const bool felt = std::sqrt(residual) > force_ * imperceptible_n_;
  const bool converged = !refused_ && (remaining_ <= tolerance || !felt);
  // A solution that is worse than zero is no start for the next one, which would be worse still.
  // Forces that are not A·u have no such energy: there the residual must not have grown.
  diverged_ = !converged && (forces_.linear() ? energy < 0 : residual > at_first_);
  const bool keep = start_ != fixed::Start::zero && !(diverged_ && forces_.linear());
  const bool extrapolate = start_ == fixed::Start::extrapolated;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    guess_[i] = !keep ? 0 : extrapolate ? 2 * u_[i] - solution_[i] : u_[i];
    guess_product_[i] = !keep         ? 0
                        : extrapolate ? 2 * product_[i] - solution_product_[i]
                                      : product_[i];
  }
  solution_ = u_;
  solution_product_ = product_;
  return converged;
}

void Increments::abandon() {
  if (went_on_) {
    u_ = gone_on_from_;
    current_ = false;
    return;
  }
  u_ = solution_;
  product_ = solution_product_;
  current_ = true;
}

stability::Flags Increments::flags() const {
  stability::Flags flags;
  if (diverged_) flags.raise(stability::Flag::divergence);
  if (no_start_) flags.raise(stability::Flag::no_start);
  if (inverted_ > 0) flags.raise(stability::Flag::inverted_element);
  if (overflown_ > 0) flags.raise(stability::Flag::energy_overflow);
  return flags;
}

double Increments::begin_operations() const {
  double blocks = 0;
  for (const int node : contact_) {
    blocks += a_.row_begin[at(node) + 1] - a_.row_begin[at(node)];
  }
  // The product with the contact's columns for b, the change of q; the way that its nodes go.
  return forces_.follow_operations() + 18 * blocks + 6 * static_cast<double>(contact_.size());
}

double Increments::evaluate_operations() const {
  return std::max(1, evaluations_) * forces_.evaluate_operations();
}

double Increments::finish_operations() const {
  // Subtract; two norms, and an inner product with a sum.
  const double judge = 8.0 * a_.rows();
  const double extrapolation = start_ == fixed::Start::extrapolated ? 4.0 * a_.rows() : 0;
  // After go_on() a residual that was looked at already is there.
  const double evaluation = went_on_ && evaluations_ == 0 ? 0 : evaluate_operations();
  return evaluation + judge + extrapolation;
}

}  // namespace hvp::host
