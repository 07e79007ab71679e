#include "models/fixed/fast/fast_solver.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/config/input_error.h"

namespace hvp::fixed::fast {

namespace {

using stability::Flag;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

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

// r = b - A·x and, without a preconditioner, rᵀr. Sums of doubles run over the rows in the
// matrix' order: the reference's norms are the same to the bit.
void FastSolver::form_residual() {
  const int rhs_shift = settings_.rhs_shift();
  const int product_shift = settings_.product_shift();
  multiply(x_, 0, product_);
  std::uint64_t bits = 0;  // as many as the widest has
  residual_squares_ = 0;
  Int128 rhs = 0;
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t i = first; i < first + 3; ++i) {
      const std::int64_t entry = (std::int64_t{b_.word[i]} << rhs_shift) -
                                 (std::int64_t{product_.word[i]} << product_shift);
      sums_[i] = entry;
      bits |= size_of(entry);
      residual_squares_ += square(static_cast<double>(entry));
      rhs += std::int64_t{b_.word[i]} * b_.word[i];
    }
  }
  rhs_square_ = std::ldexp(static_cast<double>(rhs), 2 * rhs_shift);
  r_.exponent = -rhs_shift;
  if (settings_.dynamic_scaling && bits != 0) r_.exponent = residual_target_ - width(bits);
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
  w_.exponent = r_.exponent - settings_.static_shift;
  fill(product_, w_);
  multiply(d_, d_.exponent, product_);
  q_.exponent = d_.exponent - settings_.static_shift;
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
  const double residual_square = std::ldexp(static_cast<double>(dot(r_, r_)), -2 * r_.exponent);
  return residual_square <= square(settings_.stop_residual) * rhs_square_;
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
  write(x_, {.vector = x_},
        {.vector = d_, .exponent = alpha_.exponent - d_.exponent, .factor = alpha_.mantissa},
        settings_.vector_bits);
  ++report_.iterations;
  if (replaces()) {
    form_residual();
  } else {
    advance(r_, q_, settings_.residual_bits(), residual_target_, residual_available_,
            preconditioned() ? Wants::nothing : Wants::squares);
  }
  precondition();
  const Scalar z_r_old = z_r_;
  z_r_ = scalar(z_r_sum_, z().exponent + r_.exponent);
  form_beta(z_r_old);
  follow(d_, z());
  return Step::made;
}

FastSolver::Step FastSolver::step_by_recurrence() {
  stopped_ = z_r_.word <= 0 || d_.largest == 0;
  if (stopped_ || negative_curvature()) return Step::stopped;
  form_alpha();
  write(x_, {.vector = x_},
        {.vector = d_, .exponent = alpha_.exponent - d_.exponent, .factor = alpha_.mantissa},
        settings_.vector_bits);
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

// d = z + β·d, re-scaled by the bound |z| + β·|d|.
void FastSolver::follow(Vector& d, const Vector& z) {
  int up = 0;
  if (z_r_.word > 0) {
    up = rescaling(z.largest, d.exponent - z.exponent, size_of(beta_.mantissa) * d.largest,
                   beta_.exponent, settings_.vector_bits, direction_target_,
                   settings_.vector_bits - 1);
  }
  d.exponent += up;
  write(d, {.vector = z, .exponent = d.exponent - z.exponent},
        {.vector = d, .exponent = beta_.exponent + up, .factor = beta_.mantissa},
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

// Hands the solution over, and finds the true residual and what follows from it.
void FastSolver::judge(const Job& job) {
  const int rhs_shift = settings_.rhs_shift();
  sum_rows(x_, product_);
  double rhs = 0;
  double residual = 0;
  double recurrence = 0;
  std::uint64_t left = 0;
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = first + c;
      const std::int64_t b = std::int64_t{b_.word[i]} << rhs_shift;
      // Both fit 63 bits, but perhaps not their difference.
      const double difference = packed_.paired() ? static_cast<double>(b - product_.word[i])
                                                 : static_cast<double>(Int128{b} - sums_[i]);
      rhs += square(static_cast<double>(b));
      residual += square(difference);
      recurrence += square(static_cast<double>(r_.word[i]));
      left |= size_of(r_.word[i]);
      job.x[3 * at(node) + c] = x_.word[i];
    }
  }
  report_.rhs_norm = std::sqrt(rhs);
  report_.true_residual_norm = std::sqrt(residual);
  report_.rounding_floor = packed_.rounding_floor();
  report_.residual_norm = std::ldexp(std::sqrt(recurrence), -r_.exponent);

  if (report_.saturations > 0) report_.flags.raise(Flag::saturation);
  if (report_.wraps > 0) report_.flags.raise(Flag::wrapped);
  if (stopped_ && left != 0) report_.flags.raise(Flag::stagnation);
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
