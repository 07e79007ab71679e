#include "models/fixed/reference_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fixed {

namespace {

// The three sums of a block row, exact.
std::array<std::int64_t, 3> block_row_sums(const QuantisedMatrix& matrix, int row,
                                           std::span<const std::int32_t> vector) {
  std::array<std::int64_t, 3> sum = {0, 0, 0};
  for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
    const std::int32_t* a = &matrix.value[at(9 * k)];
    const std::int32_t* v = &vector[at(3 * matrix.column[at(k)])];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) sum[r] += std::int64_t{a[3 * r + c]} * v[c];
    }
  }
  return sum;
}

double norm(std::span<const std::int32_t> vector) {
  double sum = 0;
  for (const std::int32_t word : vector) sum += static_cast<double>(word) * word;
  return std::sqrt(sum);
}

// The same to the bit in any order of summation.
double square_sum(std::span<const std::int32_t> vector) {
  Int128 sum = 0;
  for (const std::int32_t word : vector) sum += static_cast<Int128>(word) * word;
  return static_cast<double>(sum);
}

double worth(const ScaledScalar& scalar) {
  return std::ldexp(static_cast<double>(scalar.word), -scalar.exponent);
}

// Bits of magnitude that re-scaling leaves the 32-bit r of PCG (and so z): the products in zᵀr
// have 50 bits then, and 2^13 rows fit 64.
constexpr int kWideResidualBits = 25;

double square(double value) { return value * value; }

}  // namespace

ReferenceSolver::ReferenceSolver(const Settings& settings)
    : settings_(settings),
      preconditioner_(settings),
      direction_target_(settings.vector_bits - 1 - settings.headroom_bits),
      residual_target_(settings.preconditioned() ? kWideResidualBits : direction_target_),
      residual_available_(settings.preconditioned() ? kWideResidualBits
                                                    : settings.vector_bits - 1) {
  settings_.check();
}

void ReferenceSolver::load(const QuantisedMatrix& matrix) {
  require_fitting(matrix);
  matrix_ = &matrix;
  for (auto* vector : {&r_, &z_, &d_, &q_, &w_, &n_, &v_, &product_}) {
    vector->word.assign(at(matrix.rows()), 0);
  }
  b_.assign(at(matrix.rows()), 0);
  preconditioner_.load(matrix);
}

void ReferenceSolver::update(int node) { preconditioner_.update(*matrix_, node); }

void ReferenceSolver::require_fitting(const QuantisedMatrix& matrix) const {
  if (matrix.bits != settings_.matrix_bits) {
    throw InputError("matrix_bits", "the matrix has words of " + std::to_string(matrix.bits) +
                                        " bits, the solver was set to " +
                                        std::to_string(settings_.matrix_bits));
  }
  // Products have matrix_bits + vector_bits - 2 bits; a row's sum has 63.
  const int spare_bits = 63 - (settings_.matrix_bits + settings_.vector_bits - 2);
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

Report ReferenceSolver::solve(Job job, Observer* observer) {
  const std::size_t rows = r_.word.size();
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
  smallest_ = worth(z_r_);
  while (report_.iterations < settings_.iterations) {
    if (reached()) {
      report_.reached = true;
      break;
    }
    const Step made = by_recurrence() ? step_by_recurrence(job) : step(job);
    if (made == Step::stopped) break;
    if (worth(z_r_) < smallest_) {
      smallest_ = worth(z_r_);
      last_progress_ = report_.iterations;
    }
    observe(job, observer);
  }
  judge(job);
  return report_;
}

// Lines 1 to 7 of the pseudo-code in thesis §4.3.
void ReferenceSolver::start(const Job& job) {
  for (std::size_t i = 0; i < b_.size(); ++i) {
    if (settings_.start == Start::zero) job.x[i] = 0;
    job.x[i] = machine_.write(job.x[i], settings_.vector_bits);
    b_[i] = machine_.write(job.b[i], settings_.residual_bits());
  }
  rhs_square_ = std::ldexp(square_sum(b_), 2 * settings_.rhs_shift());
  form_residual(job);
  report_.start_residual_norm = std::sqrt(residual_squares_);
  precondition();
  z_r_ = machine_.inner_product(z_, r_);

  // Without dynamic scaling the direction of PCG is in units of x (thesis §4.3).
  d_.exponent = settings_.preconditioned() ? 0 : z_.exponent;
  fill(z_, d_);
  if (by_recurrence()) start_recurrences();
}

// r = b - A·x, as the host sent b. The exponent has to be known before the first word of r is
// written, so A·x is read twice.
void ReferenceSolver::form_residual(const Job& job) {
  const int rhs_shift = settings_.rhs_shift();
  const int product_shift = settings_.product_shift();
  multiply(job.x, 0, product_);
  const auto full = [&](std::size_t i) {
    return (std::int64_t{b_[i]} << rhs_shift) - (std::int64_t{product_.word[i]} << product_shift);
  };
  std::uint64_t widest = 0;
  residual_squares_ = 0;
  for (std::size_t i = 0; i < b_.size(); ++i) {
    widest = std::max(widest, magnitude(full(i)));
    residual_squares_ += square(static_cast<double>(full(i)));
  }
  r_.exponent = -rhs_shift;
  if (settings_.dynamic_scaling && widest != 0) {
    r_.exponent = residual_target_ - bit_length(widest);
  }
  for (std::size_t i = 0; i < b_.size(); ++i) {
    r_.word[i] =
        machine_.write(machine_.rounded_shift(full(i), r_.exponent), settings_.residual_bits());
  }
}

// The vectors that the recurrences carry, from their definitions.
void ReferenceSolver::start_recurrences() {
  form_recurrences();
  d_q_ = machine_.inner_product(w_, r_);
}

// w = A·r, q = A·d; pipelined: n = A·w, v = A·q.
void ReferenceSolver::form_recurrences() {
  if (!pipelined()) {
    multiply(r_.word, r_.exponent, w_);
    multiply(d_.word, d_.exponent, q_);
    return;
  }
  multiply(r_.word, r_.exponent, product_);
  w_.exponent = r_.exponent - settings_.shift();
  fill(product_, w_);
  multiply(d_.word, d_.exponent, product_);
  q_.exponent = d_.exponent - settings_.shift();
  fill(product_, q_);
  multiply(w_.word, w_.exponent, n_);
  multiply(q_.word, q_.exponent, v_);
}

// Writes a vector into vector words, so that it fills them with dynamic scaling; with the
// exponent that they have without.
void ReferenceSolver::fill(const ScaledVector& from, ScaledVector& to) {
  if (settings_.dynamic_scaling) {
    to.exponent = from.exponent + direction_target_ - bit_length(from.largest());
  }
  for (std::size_t i = 0; i < to.word.size(); ++i) {
    to.word[i] = machine_.write(machine_.rounded_shift(from.word[i], to.exponent - from.exponent),
                                settings_.vector_bits);
  }
}

// ‖r‖ <= stop_residual · ‖b‖.
bool ReferenceSolver::reached() const {
  if (settings_.stop_residual == 0) return false;
  const double residual_square = std::ldexp(square_sum(r_.word), -2 * r_.exponent);
  return residual_square <= square(settings_.stop_residual) * rhs_square_;
}

bool ReferenceSolver::nothing_left() {
  stopped_ = z_r_.word <= 0 || d_.all_zero();
  return stopped_;
}

// Every step so far lowered the energy ½xᵀAx - bᵀx; this one would raise it without bound. x
// stays the best there was.
bool ReferenceSolver::negative_curvature() {
  if (d_q_.word > 0) return false;
  report_.flags.raise(stability::Flag::negative_curvature);
  ++report_.breakdowns;
  return true;
}

// Lines 9 to 18 of the pseudo-code in thesis §4.3.
ReferenceSolver::Step ReferenceSolver::step(const Job& job) {
  if (nothing_left()) return Step::stopped;
  multiply(d_.word, d_.exponent, q_);
  d_q_ = machine_.inner_product(d_, q_);
  if (negative_curvature()) return Step::stopped;
  form_alpha();
  advance_solution(job);
  ++report_.iterations;
  if (replaces()) {
    form_residual(job);
  } else {
    advance(r_, q_, settings_.residual_bits(), residual_target_, residual_available_);
  }
  precondition();
  const ScaledScalar z_r_old = z_r_;
  z_r_ = machine_.inner_product(z_, r_);
  form_beta(z_r_old);
  follow(d_, z_);
  return Step::made;
}

// Chronopoulos and Gear: δ = rᵀA·r with γ = rᵀr at once, and dᵀA·d = δ - β²·(the one before).
// Ghysels and Vanroose: A·w beside both, and w = A·r and v = A·q by recurrence.
ReferenceSolver::Step ReferenceSolver::step_by_recurrence(const Job& job) {
  if (nothing_left()) return Step::stopped;
  if (negative_curvature()) return Step::stopped;
  form_alpha();
  advance_solution(job);
  ++report_.iterations;
  const bool replaced = replaces();
  if (replaced) {
    form_residual(job);
    form_recurrences();
  } else {
    advance(r_, q_, settings_.residual_bits(), residual_target_, residual_available_);
    if (pipelined()) {
      advance(w_, v_, settings_.vector_bits, direction_target_, settings_.vector_bits - 1);
      multiply(w_.word, w_.exponent, n_);
    } else {
      multiply(r_.word, r_.exponent, w_);
    }
  }
  precondition();
  const ScaledScalar z_r_old = z_r_;
  z_r_ = machine_.inner_product(z_, r_);
  form_beta(z_r_old);
  // The recurrences hold from the last residual to this one, not to one that was formed anew.
  if (replaced) beta_ = {};
  follow_curvature(machine_.inner_product(w_, r_));
  follow(d_, z_);
  if (pipelined()) {
    follow(q_, w_);
    follow_product(v_, n_, q_.exponent);
  } else {
    follow_product(q_, w_, d_.exponent);
  }
  return Step::made;
}

bool ReferenceSolver::replaces() {
  if (settings_.replace_residual_every == 0) return false;
  if (report_.iterations % settings_.replace_residual_every != 0) return false;
  ++report_.replacements;
  return true;
}

void ReferenceSolver::form_alpha() {
  alpha_ = machine_.divide(z_r_.word, d_q_.word, settings_.alpha_fraction_bits);
  alpha_.exponent += d_q_.exponent - z_r_.exponent;
  // α as it multiplies the words of q, for r before its re-scaling.
  shown_alpha_ = {alpha_.mantissa, alpha_.exponent - q_.exponent + r_.exponent};
}

void ReferenceSolver::form_beta(const ScaledScalar& z_r_old) {
  beta_ = {};
  if (z_r_.word <= 0) return;
  beta_ = machine_.divide(z_r_.word, z_r_old.word, settings_.beta_fraction_bits);
  beta_.exponent += z_r_old.exponent - z_r_.exponent;
}

// dᵀA·d of the next direction: δ - β²·(this one's). Both multiplications by β are rounded. Where
// rounding leaves nothing of it, the directions start anew, with β = 0.
void ReferenceSolver::follow_curvature(const ScaledScalar& delta) {
  const int mantissa_bits = settings_.coefficient_bits - 1;
  const Int128 once = machine_.shift_scalar(beta_.mantissa * d_q_.word, -mantissa_bits);
  const Int128 twice = machine_.shift_scalar(
      beta_.mantissa * once, 2 * beta_.exponent + mantissa_bits - d_q_.exponent + delta.exponent);
  d_q_ = {machine_.write_scalar(delta.word - twice), delta.exponent};
  if (d_q_.word > 0 || delta.word <= 0) return;
  beta_ = {};
  d_q_ = delta;
}

// x += α·d
void ReferenceSolver::advance_solution(const Job& job) {
  for (std::size_t i = 0; i < d_.word.size(); ++i) {
    const std::int64_t along = std::int64_t{alpha_.mantissa} * d_.word[i];
    const std::int64_t change = machine_.rounded_shift(along, alpha_.exponent - d_.exponent);
    job.x[i] = machine_.write(job.x[i] + change, settings_.vector_bits);
  }
}

// r -= α·q. r is re-scaled before it is written, by the bound |r| + α·|q| on what will come.
void ReferenceSolver::advance(ScaledVector& r, const ScaledVector& q, int bits, int target,
                              int available) {
  const int exponent = alpha_.exponent - q.exponent + r.exponent;
  const std::uint64_t step_size = magnitude(alpha_.mantissa) * q.largest();
  const int up = machine_.rescaling(r.largest(), 0, step_size, exponent, bits, target, available);
  for (std::size_t i = 0; i < r.word.size(); ++i) {
    const std::int64_t change = std::int64_t{alpha_.mantissa} * q.word[i];
    const std::int64_t kept = machine_.rounded_shift(r.word[i], up);
    r.word[i] = machine_.write(kept - machine_.rounded_shift(change, exponent + up), bits);
  }
  r.exponent += up;
}

// d = z + β·d, re-scaled by the bound |z| + β·|d|.
void ReferenceSolver::follow(ScaledVector& d, const ScaledVector& z) {
  int up = 0;
  if (z_r_.word > 0) {
    const std::uint64_t carried = magnitude(beta_.mantissa) * d.largest();
    up = machine_.rescaling(z.largest(), d.exponent - z.exponent, carried, beta_.exponent,
                            settings_.vector_bits, direction_target_, settings_.vector_bits - 1);
  }
  d.exponent += up;
  for (std::size_t i = 0; i < d.word.size(); ++i) {
    const std::int64_t carried = std::int64_t{beta_.mantissa} * d.word[i];
    const std::int64_t fresh = machine_.rounded_shift(z.word[i], d.exponent - z.exponent);
    d.word[i] = machine_.write(fresh + machine_.rounded_shift(carried, beta_.exponent + up),
                               settings_.vector_bits);
  }
}

// q = w + β·q, where q is a product and its exponent that of A·(the vector it belongs to).
void ReferenceSolver::follow_product(ScaledVector& q, const ScaledVector& w, int vector_exponent) {
  const int exponent = vector_exponent - settings_.product_shift();
  const int up = exponent - q.exponent;
  q.exponent = exponent;
  for (std::size_t i = 0; i < q.word.size(); ++i) {
    const std::int64_t carried = std::int64_t{beta_.mantissa} * q.word[i];
    const std::int64_t fresh = machine_.rounded_shift(w.word[i], q.exponent - w.exponent);
    q.word[i] = machine_.write(fresh + machine_.rounded_shift(carried, beta_.exponent + up),
                               Settings::kProductBits);
  }
}

// product = A·vector. The sum is exact and is rounded and clamped once, when it is written.
void ReferenceSolver::multiply(std::span<const std::int32_t> vector, int exponent,
                               ScaledVector& product) {
  const int product_shift = settings_.product_shift();
  for (int row = 0; row < matrix_->block_rows(); ++row) {
    const std::array<std::int64_t, 3> sum = block_row_sums(*matrix_, row, vector);
    for (std::size_t c = 0; c < 3; ++c) {
      product.word[at(3 * row) + c] =
          machine_.write(machine_.rounded_shift(sum[c], -product_shift), Settings::kProductBits);
    }
  }
  product.exponent = exponent - product_shift;
}

// z = P⁻¹·r
void ReferenceSolver::precondition() {
  if (!settings_.preconditioned()) {
    z_.exponent = r_.exponent;
    std::ranges::copy(r_.word, z_.word.begin());
    return;
  }
  const int dropped = preconditioner_.shift();
  for (std::size_t i = 0; i < r_.word.size(); ++i) {
    const std::size_t node = i / 3;
    const std::int32_t* inverse = &preconditioner_.words()[3 * i];
    const std::int32_t* r = &r_.word[3 * node];
    std::int64_t sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += std::int64_t{inverse[c]} * r[c];
    z_.word[i] = machine_.write(machine_.rounded_shift(sum, -dropped), Settings::kProductBits);
  }
  z_.exponent = r_.exponent + ReferencePreconditioner::scale_bits(settings_) - dropped;
}

void ReferenceSolver::observe(const Job& job, Observer* observer) const {
  if (observer == nullptr) return;
  IterationState state{.iteration = report_.iterations,
                       .x = job.x,
                       .r = r_.word,
                       .z = z_.word,
                       .d = d_.word,
                       .q = q_.word,
                       .d_q = d_q_.word,
                       .z_r = z_r_.word,
                       .alpha = shown_alpha_,
                       .beta = beta_,
                       .residual_exponent = r_.exponent + settings_.rhs_shift(),
                       .direction_exponent = d_.exponent - z_.exponent};
  if (by_recurrence()) state.w = w_.word;
  if (pipelined()) {
    state.n = n_.word;
    state.v = v_.word;
  }
  observer->iteration(state);
}

// Forms what the words themselves cannot tell: the true residual, and the flags that follow from
// it.
void ReferenceSolver::judge(const Job& job) {
  const int rhs_shift = settings_.rhs_shift();
  double rhs = 0;
  double residual = 0;
  double floor = 0;
  for (int row = 0; row < matrix_->block_rows(); ++row) {
    const std::array<std::int64_t, 3> product = block_row_sums(*matrix_, row, job.x);
    std::array<std::int64_t, 3> magnitudes = {0, 0, 0};
    for (int k = matrix_->row_begin[at(row)]; k < matrix_->row_begin[at(row) + 1]; ++k) {
      for (int e = 0; e < 9; ++e) magnitudes[at(e / 3)] += std::abs(matrix_->value[at(9 * k + e)]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int64_t b = std::int64_t{b_[at(3 * row) + c]} << rhs_shift;
      rhs += square(static_cast<double>(b));
      residual += square(static_cast<double>(Int128{b} - product[c]));
      floor += square(static_cast<double>(magnitudes[c]));
    }
  }
  report_.rhs_norm = std::sqrt(rhs);
  report_.true_residual_norm = std::sqrt(residual);
  report_.rounding_floor = std::sqrt(floor);
  report_.residual_norm = std::ldexp(norm(r_.word), -r_.exponent);

  if (report_.saturations > 0) report_.flags.raise(stability::Flag::saturation);
  if (report_.wraps > 0) report_.flags.raise(stability::Flag::wrapped);
  // Without dynamic scaling a direction can round to zero, or stall at a few last places, far
  // from the solution.
  if (stopped_ && !r_.all_zero()) report_.flags.raise(stability::Flag::stagnation);

  // Rounding x in every iteration leaves a few units in the last place.
  constexpr double kFloors = 4;
  const double negligible = kFloors * report_.rounding_floor;
  const double reached = report_.true_residual_norm;
  if (reached <= negligible) return;
  const bool stalled = last_progress_ < report_.iterations / 2;
  if (stalled || reached > 2 * report_.residual_norm + negligible) {
    report_.flags.raise(stability::Flag::stagnation);
  }
  if (reached > std::max(report_.rhs_norm, report_.start_residual_norm)) {
    report_.flags.raise(stability::Flag::divergence);
  }
}

}  // namespace hvp::fixed
