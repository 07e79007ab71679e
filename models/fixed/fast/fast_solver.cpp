#include "models/fixed/fast/fast_solver.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fixed::fast {

namespace {

using stability::Flag;

double square(double value) { return value * value; }

double worth(Int128 word, int exponent) { return std::ldexp(static_cast<double>(word), -exponent); }

// Bits of magnitude that re-scaling leaves r and z of PCG (docs/fixed-point.md).
constexpr int kWideResidualBits = 25;

}  // namespace

FastSolver::FastSolver(const Settings& settings, const Passes& passes)
    : settings_(settings),
      passes_(passes),
      preconditioner_(settings),
      direction_target_(settings.vector_bits - 1 - settings.headroom_bits),
      residual_target_(settings.preconditioned() ? kWideResidualBits : direction_target_),
      residual_available_(settings.preconditioned() ? kWideResidualBits
                                                    : settings.vector_bits - 1) {
  settings_.check();
}

void FastSolver::load(const QuantisedMatrix& matrix) {
  require_fitting(matrix);
  matrix_ = &matrix;
  packed_.load(matrix, settings_.vector_bits);
  lane_products_bits_ = width(std::uint64_t{packed_.padded_rows() / passes_.lanes});
  for (Vector* vector : {&x_, &b_, &r_, &z_, &d_, &q_, &w_, &n_, &v_, &product_}) {
    vector->word.assign(packed_.padded_rows(), 0);
    vector->largest = 0;
  }
  short_.assign(packed_.padded_rows() / 3 * kRowWords, 0);
  sums_.assign(packed_.padded_rows(), 0);
  shown_.assign(kShownVectors * at(matrix.rows()), 0);
  preconditioner_.load(matrix, packed_);
}

void FastSolver::update(int node) {
  packed_.update(*matrix_, node);
  preconditioner_.update(*matrix_, packed_, node);
}

void FastSolver::require_fitting(const QuantisedMatrix& matrix) const {
  if (matrix.bits != settings_.matrix_bits) {
    throw InputError("matrix_bits", "the matrix has words of " + std::to_string(matrix.bits) +
                                        " bits, the solver was set to " +
                                        std::to_string(settings_.matrix_bits));
  }
  // Products have matrix_bits + vector_bits - 2 bits; a row's sum has 63.
  const int spare_bits = 65 - settings_.matrix_bits - settings_.vector_bits;
  const std::int64_t longest = std::int64_t{1} << spare_bits;
  for (int i = 0; i < matrix.block_rows(); ++i) {
    const std::int64_t entries =
        3 * std::int64_t{matrix.row_begin[at(i) + 1] - matrix.row_begin[at(i)]};
    if (entries <= longest) continue;
    throw InputError("row " + std::to_string(3 * i) + " has " + std::to_string(entries) +
                     " entries; with words of " + std::to_string(settings_.matrix_bits) + " and " +
                     std::to_string(settings_.vector_bits) + " bits the sum of " +
                     std::to_string(longest) + " fits 64 bits");
  }
}

Report FastSolver::solve(Job job, Observer* observer) {
  const std::size_t rows = matrix_ == nullptr ? 0 : at(matrix_->rows());
  if (matrix_ == nullptr || job.b.size() != rows || job.x.size() != rows) {
    throw InputError("b of " + std::to_string(job.b.size()) + " and x of " +
                     std::to_string(job.x.size()) + " entries; the loaded matrix has " +
                     std::to_string(rows) + " rows");
  }
  report_ = {};
  report_.flags = preconditioner_.flags();
  stopped_ = false;
  last_progress_ = 0;
  start(job);
  smallest_ = worth(z_r_.word, z_r_.exponent);
  while (report_.iterations < settings_.iterations) {
    if (reached()) {
      report_.reached = true;
      break;
    }
    const Step made = by_recurrence() ? step_by_recurrence() : step();
    if (made == Step::stopped) break;
    const double size = worth(z_r_.word, z_r_.exponent);
    if (size < smallest_) {
      smallest_ = size;
      last_progress_ = report_.iterations;
    }
    observe(observer);
  }
  judge(job);
  return report_;
}

void FastSolver::start(const Job& job) {
  take(job);
  form_residual();
  report_.start_residual_norm = std::sqrt(residual_squares_);
  precondition();
  z_r_ = scalar(z_r_sum_, z().exponent + r_.exponent);
  d_.exponent = preconditioned() ? 0 : z().exponent;
  fill(z(), d_);
  if (!by_recurrence()) return;
  form_recurrences();
  d_q_ = scalar(dot(r_, w_), w_.exponent + r_.exponent);
}

// r = b - A·x and, without a preconditioner, rᵀr.
void FastSolver::form_residual() {
  const int rhs_shift = settings_.rhs_shift();
  const int product_shift = settings_.product_shift();
  const auto exponent_of = [&](std::uint64_t largest) {
    if (!settings_.dynamic_scaling || largest == 0) return -rhs_shift;
    return residual_target_ - width(largest);
  };
  multiply(x_, 0, product_);
  if (product_shift == 0) {
    if (const auto squares = subtract_from_rhs(product_)) {
      residual_squares_ = square_sum(product_, *squares);
      r_.exponent = exponent_of(product_.largest);
      write(r_, {.vector = product_, .exponent = r_.exponent}, {.vector = product_, .factor = 0},
            settings_.residual_bits(), Wants::squares);
      return;
    }
  }
  std::uint64_t bits = 0;  // as many as the widest has
  residual_squares_ = 0;
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t i = first; i < first + 3; ++i) {
      const std::int64_t entry = (std::int64_t{b_.word[i]} << rhs_shift) -
                                 (std::int64_t{product_.word[i]} << product_shift);
      sums_[i] = entry;
      bits |= size_of(entry);
      residual_squares_ += square(static_cast<double>(entry));
    }
  }
  r_.exponent = exponent_of(bits);
  write_sums(r_, r_.exponent, settings_.residual_bits(), Wants::squares);
}

// w = A·r, q = A·d; pipelined: n = A·w, v = A·q.
void FastSolver::form_recurrences() {
  if (!pipelined()) {
    multiply(r_, r_.exponent, w_);
    multiply(d_, d_.exponent, q_);
    return;
  }
  multiply(r_, r_.exponent, product_);
  w_.exponent = r_.exponent - settings_.shift();
  fill(product_, w_);
  multiply(d_, d_.exponent, product_);
  q_.exponent = d_.exponent - settings_.shift();
  fill(product_, q_);
  multiply(w_, w_.exponent, n_);
  multiply(q_, q_.exponent, v_);
}

void FastSolver::fill(const Vector& from, Vector& to) {
  if (settings_.dynamic_scaling) {
    to.exponent = from.exponent + direction_target_ - width(from.largest);
  }
  write(to, {.vector = from, .exponent = to.exponent - from.exponent},
        {.vector = from, .factor = 0}, settings_.vector_bits);
}

bool FastSolver::reached() {
  if (settings_.stop_residual == 0) return false;
  return stop_test_.reached(static_cast<UInt128>(dot(r_, r_)), r_.exponent);
}

bool FastSolver::negative_curvature() {
  if (d_q_.word > 0) return false;
  report_.flags.raise(Flag::negative_curvature);
  ++report_.breakdowns;
  return true;
}

bool FastSolver::replaces() {
  const int every = settings_.replace_residual_every;
  if (every == 0 || report_.iterations % every != 0) return false;
  ++report_.replacements;
  return true;
}

FastSolver::Step FastSolver::step() {
  stopped_ = z_r_.word <= 0 || d_.largest == 0;
  if (stopped_) return Step::stopped;
  const Int128 curvature = multiply(d_, d_.exponent, q_);
  d_q_ = scalar(curvature, d_.exponent + q_.exponent);
  if (negative_curvature()) return Step::stopped;
  form_alpha();
  ++report_.iterations;
  const bool replaced = replaces();
  if (replaced) {
    advance_solution();
    form_residual();
  } else {
    advance(r_, q_, settings_.residual_bits(), residual_target_, residual_available_,
            preconditioned() ? Wants::nothing : Wants::squares);
  }
  precondition();
  const Scalar z_r_old = z_r_;
  z_r_ = scalar(z_r_sum_, z().exponent + r_.exponent);
  form_beta(z_r_old);
  if (replaced) {
    follow(d_, z());
  } else {
    advance_solution_and_follow();
  }
  return Step::made;
}

FastSolver::Step FastSolver::step_by_recurrence() {
  stopped_ = z_r_.word <= 0 || d_.largest == 0;
  if (stopped_ || negative_curvature()) return Step::stopped;
  form_alpha();
  advance_solution();
  ++report_.iterations;
  const bool replaced = replaces();
  if (replaced) {
    form_residual();
    form_recurrences();
  } else {
    advance(r_, q_, settings_.residual_bits(), residual_target_, residual_available_,
            Wants::squares);
    if (pipelined()) {
      advance(w_, v_, settings_.vector_bits, direction_target_, settings_.vector_bits - 1,
              Wants::nothing);
      multiply(w_, w_.exponent, n_);
    } else {
      multiply(r_, r_.exponent, w_);
    }
  }
  const Scalar z_r_old = z_r_;
  z_r_ = scalar(z_r_sum_, 2 * r_.exponent);
  form_beta(z_r_old);
  // The recurrences do not hold across a residual that was formed anew.
  if (replaced) beta_ = {};
  follow_curvature(scalar(dot(r_, w_), w_.exponent + r_.exponent));
  follow(d_, r_);
  if (pipelined()) {
    follow(q_, w_);
    follow_product(v_, n_, q_.exponent);
  } else {
    follow_product(q_, w_, d_.exponent);
  }
  return Step::made;
}

// r -= α·q, re-scaled by the bound |r| + α·|q|.
void FastSolver::advance(Vector& r, const Vector& q, int bits, int target, int available,
                         Wants wants) {
  const int exponent = alpha_.exponent - q.exponent + r.exponent;
  const int up = rescaling(r.largest, 0, size_of(alpha_.mantissa) * q.largest, exponent, bits,
                           target, available);
  write(r, {.vector = r, .exponent = up},
        {.vector = q, .exponent = exponent + up, .factor = -alpha_.mantissa}, bits, wants);
  r.exponent += up;
}

// α·d in units of x.
FastSolver::Term FastSolver::along(const Vector& d) const {
  return {.vector = d, .exponent = alpha_.exponent - d.exponent, .factor = alpha_.mantissa};
}

void FastSolver::advance_solution() { write(x_, {.vector = x_}, along(d_), settings_.vector_bits); }

// By the bound |z| + β·|d|.
int FastSolver::rescaling_of_direction(const Vector& d, const Vector& z) const {
  if (z_r_.word <= 0) return 0;
  return rescaling(z.largest, d.exponent - z.exponent, size_of(beta_.mantissa) * d.largest,
                   beta_.exponent, settings_.vector_bits, direction_target_,
                   settings_.vector_bits - 1);
}

// d = z + β·d, re-scaled.
void FastSolver::follow(Vector& d, const Vector& z) {
  const int up = rescaling_of_direction(d, z);
  d.exponent += up;
  write(d, {.vector = z, .exponent = d.exponent - z.exponent},
        {.vector = d, .exponent = beta_.exponent + up, .factor = beta_.mantissa},
        settings_.vector_bits);
}

// x += α·d, and d = z + β·d.
void FastSolver::advance_solution_and_follow() {
  const Term step = along(d_);
  const int up = rescaling_of_direction(d_, z());
  d_.exponent += up;
  write_both(x_, step, d_, {.vector = z(), .exponent = d_.exponent - z().exponent},
             {.vector = d_, .exponent = beta_.exponent + up, .factor = beta_.mantissa},
             settings_.vector_bits);
}

// q = w + β·q, where q's exponent is that of A·(the vector it belongs to).
void FastSolver::follow_product(Vector& q, const Vector& w, int vector_exponent) {
  const int exponent = vector_exponent - settings_.product_shift();
  const int up = exponent - q.exponent;
  q.exponent = exponent;
  write(q, {.vector = w, .exponent = exponent - w.exponent},
        {.vector = q, .exponent = beta_.exponent + up, .factor = beta_.mantissa},
        Settings::kProductBits);
}

// The words in the matrix' own order.
void FastSolver::observe(Observer* observer) {
  if (observer == nullptr) return;
  const std::size_t rows = at(matrix_->rows());
  std::size_t shown = 0;
  const auto show = [&](const Vector& vector) {
    std::int32_t* out = shown_.data() + rows * shown++;
    for (int node = 0; node < packed_.nodes(); ++node) {
      std::copy_n(&vector.word[packed_.first_row(node)], 3, out + 3 * node);
    }
    return std::span<const std::int32_t>(out, rows);
  };
  IterationState state{.iteration = report_.iterations,
                       .x = show(x_),
                       .r = show(r_),
                       .z = show(z()),
                       .d = show(d_),
                       .q = show(q_),
                       .d_q = d_q_.word,
                       .z_r = z_r_.word,
                       .alpha = shown_alpha_,
                       .beta = beta_,
                       .residual_exponent = r_.exponent + settings_.rhs_shift(),
                       .direction_exponent = d_.exponent - z().exponent};
  if (by_recurrence()) state.w = show(w_);
  if (pipelined()) {
    state.n = show(n_);
    state.v = show(v_);
  }
  observer->iteration(state);
}

// ‖b - A·x‖ of the solution.
double FastSolver::true_residual() {
  sum_rows(x_, product_);
  if (packed_.paired()) {
    if (const auto squares = subtract_from_rhs(product_)) {
      return std::sqrt(square_sum(product_, *squares));
    }
  }
  const int rhs_shift = settings_.rhs_shift();
  double sum = 0;
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t i = first; i < first + 3; ++i) {
      const std::int64_t b = std::int64_t{b_.word[i]} << rhs_shift;
      // Both fit 63 bits, but perhaps not their difference.
      const double difference = packed_.paired() ? static_cast<double>(b - product_.word[i])
                                                 : static_cast<double>(Int128{b} - sums_[i]);
      sum += square(difference);
    }
  }
  return std::sqrt(sum);
}

// Hands the solution over, and finds the true residual and what follows from it.
void FastSolver::judge(const Job& job) {
  hand_over(job.x);
  report_.rhs_norm = std::ldexp(std::sqrt(square_sum(b_, rhs_squares_)), settings_.rhs_shift());
  report_.true_residual_norm = true_residual();
  report_.rounding_floor = packed_.rounding_floor();
  const Int128 squares = preconditioned() ? dot(r_, r_) : z_r_sum_;
  report_.residual_norm = std::ldexp(std::sqrt(square_sum(r_, squares)), -r_.exponent);

  if (report_.saturations > 0) report_.flags.raise(Flag::saturation);
  if (report_.wraps > 0) report_.flags.raise(Flag::wrapped);
  if (stopped_ && r_.largest != 0) report_.flags.raise(Flag::stagnation);
  // docs/fixed-point.md, "Flags, and what helps": four rounding floors are negligible.
  const double negligible = 4 * report_.rounding_floor;
  const double size = report_.true_residual_norm;
  if (size <= negligible) return;
  const bool stalled = last_progress_ < report_.iterations / 2;
  if (stalled || size > 2 * report_.residual_norm + negligible) {
    report_.flags.raise(Flag::stagnation);
  }
  if (size > std::max(report_.rhs_norm, report_.start_residual_norm)) {
    report_.flags.raise(Flag::divergence);
  }
}

}  // namespace hvp::fixed::fast
