#include "models/fixed/reference_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "models/config/input_error.h"

namespace hvp::fixed {

namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::uint64_t largest(std::span<const std::int32_t> vector) {
  std::uint64_t result = 0;
  for (const std::int32_t word : vector) result = std::max(result, magnitude(word));
  return result;
}

bool all_zero(std::span<const std::int32_t> vector) { return largest(vector) == 0; }

// Bits of a·2^a_exponent + b·2^b_exponent, rounded up; negative for sums under one half. Both
// terms are cut to 40 bits of the larger, as an adder behind two shifters would. The sum is
// taken a little too large, by four units of a word of `word_bits` that it just fills: room for
// the rounding of the two terms, so that what is scaled by this bound cannot saturate.
int sum_bit_length(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent,
                   int word_bits) {
  constexpr int kAdderBits = 40;
  if (a == 0 && b == 0) return 0;
  const int a_top = bit_length(a) + a_exponent;
  const int b_top = bit_length(b) + b_exponent;
  const int top = a == 0 ? b_top : b == 0 ? a_top : std::max(a_top, b_top);
  const int unit = top - kAdderBits;
  const auto aligned = [unit](std::uint64_t value, int exponent) {
    if (value == 0) return std::uint64_t{0};
    const int left = exponent - unit;
    if (left >= 0) return value << left;
    return left > -64 ? (value >> -left) + 1 : std::uint64_t{1};
  };
  const std::uint64_t sum = aligned(a, a_exponent) + aligned(b, b_exponent);
  return bit_length(sum + (sum >> (word_bits - 3))) + unit;
}

// The power of two that re-scales a vector whose largest entry has `bits` bits of magnitude: up
// to `target`, and down only as far as the word is narrow.
int rescaling(int bits, int available, int target) {
  if (bits < target) return target - bits;
  if (bits > available) return available - bits;
  return 0;
}

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

// Bits of magnitude that re-scaling leaves the 32-bit r of PCG (and so z): the products in zᵀr
// have 50 bits then, and 2^13 rows fit 64.
constexpr int kWideResidualBits = 25;

constexpr int kInverseBits = 18;

double square(double value) { return value * value; }

}  // namespace

ReferenceSolver::ReferenceSolver(const Settings& settings, int block_rows)
    : settings_(settings),
      vector_limit_(word_limit(settings.vector_bits)),
      residual_limit_(word_limit(settings.residual_bits())),
      product_limit_(word_limit(Settings::kProductBits)),
      direction_target_(settings.vector_bits - 1 - settings.headroom_bits),
      residual_target_(settings.method == Method::cg ? direction_target_ : kWideResidualBits),
      residual_available_(settings.method == Method::cg ? settings.vector_bits - 1
                                                        : kWideResidualBits) {
  settings_.check();
  for (auto* vector : {&r_, &z_, &d_, &q_, &inverse_diagonal_}) {
    vector->assign(3 * at(block_rows), 0);
  }
}

Report ReferenceSolver::solve(const QuantisedMatrix& matrix, Job job, Observer* observer) {
  require_fitting(matrix, job);
  report_ = {};
  stopped_ = false;
  last_progress_ = 0;
  if (settings_.start == Start::zero) std::ranges::fill(job.x, 0);
  invert_diagonal(matrix);
  start(matrix, job);
  smallest_ = std::ldexp(static_cast<double>(z_r_), -2 * residual_exponent_);
  while (report_.iterations < settings_.iterations && step(matrix, job.x)) {
    ++report_.iterations;
    const double squared = std::ldexp(static_cast<double>(z_r_), -2 * residual_exponent_);
    if (squared < smallest_) {
      smallest_ = squared;
      last_progress_ = report_.iterations;
    }
    if (observer == nullptr) continue;
    observer->iteration({.iteration = report_.iterations,
                         .x = job.x,
                         .r = r_,
                         .z = z_,
                         .d = d_,
                         .q = q_,
                         .d_q = d_q_,
                         .z_r = z_r_,
                         .alpha = alpha_,
                         .beta = beta_,
                         .residual_exponent = residual_exponent_,
                         .direction_exponent = direction_exponent_});
  }
  judge(matrix, job);
  return report_;
}

void ReferenceSolver::require_fitting(const QuantisedMatrix& matrix, const Job& job) const {
  const std::size_t rows = r_.size();
  if (at(matrix.rows()) != rows || job.b.size() != rows || job.x.size() != rows) {
    throw InputError("a matrix of " + std::to_string(matrix.rows()) + " rows, b of " +
                     std::to_string(job.b.size()) + " and x of " + std::to_string(job.x.size()) +
                     " entries; the solver was made for " + std::to_string(rows));
  }
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

// P⁻¹ of thesis §4.3 in 32-bit words: 2^(matrix_bits + kInverseBits) / a_ii, so that the stiffest
// diagonal still has 19 bits. The preconditioner only has to be positive, so a tiny diagonal
// may be clamped at the largest word. A row without a positive diagonal takes no part.
void ReferenceSolver::invert_diagonal(const QuantisedMatrix& matrix) {
  const std::int64_t one = std::int64_t{1} << (settings_.matrix_bits + kInverseBits);
  for (int i = 0; i < matrix.rows(); ++i) {
    const std::int64_t diagonal = matrix.diagonal(i);
    if (diagonal == 0) report_.flags.raise(stability::Flag::zero_diagonal);
    if (diagonal < 0) report_.flags.raise(stability::Flag::negative_curvature);  // eᵢᵀA eᵢ < 0
    const std::int64_t inverse = diagonal > 0 ? (2 * one + diagonal) / (2 * diagonal) : 0;
    inverse_diagonal_[at(i)] = static_cast<std::int32_t>(std::min(inverse, product_limit_));
  }
  // One register for all rows: r · P⁻¹ / 2^shift always fits 32 bits.
  preconditioner_shift_ = bit_length(largest(inverse_diagonal_));
}

// Lines 1 to 7 of the pseudo-code in thesis §4.3.
void ReferenceSolver::start(const QuantisedMatrix& matrix, const Job& job) {
  for (std::int32_t& word : job.x) word = clamp(word, vector_limit_);
  multiply(matrix, job.x);
  const int rhs_shift = settings_.rhs_shift();
  const int product_shift = settings_.product_shift();
  const bool cg = settings_.method == Method::cg;

  // The exponent has to be known before the first word of r is written, so A·x is read twice.
  std::uint64_t widest = 0;
  double squares = 0;
  for (std::size_t i = 0; i < r_.size(); ++i) {
    const std::int64_t b = clamp(job.b[i], residual_limit_);
    const std::int64_t full = (b << rhs_shift) - (std::int64_t{q_[i]} << product_shift);
    widest = std::max(widest, magnitude(full));
    squares += square(static_cast<double>(full));
  }
  report_.start_residual_norm = std::sqrt(squares);
  residual_exponent_ = 0;
  if (settings_.dynamic_scaling && widest != 0) {
    residual_exponent_ = residual_target_ - bit_length(widest) + rhs_shift;
  }
  for (std::size_t i = 0; i < r_.size(); ++i) {
    std::int64_t ignored = 0;  // b was counted above
    const std::int64_t b = saturate(job.b[i], residual_limit_, ignored);
    const std::int64_t full = (b << rhs_shift) - (std::int64_t{q_[i]} << product_shift);
    r_[i] = clamp(shift(full, residual_exponent_ - rhs_shift), residual_limit_);
  }

  precondition();
  z_r_ = inner_product(z_, r_);

  // With neither scaling the direction of PCG is in units of x (thesis §4.3).
  direction_exponent_ =
      cg ? 0 : preconditioner_shift_ - (settings_.matrix_bits + kInverseBits) + product_shift;
  if (settings_.dynamic_scaling) direction_exponent_ = direction_target_ - bit_length(largest(z_));
  for (std::size_t i = 0; i < d_.size(); ++i) {
    d_[i] = clamp(shift(z_[i], direction_exponent_), vector_limit_);
  }
}

// Lines 9 to 18 of the pseudo-code in thesis §4.3.
bool ReferenceSolver::step(const QuantisedMatrix& matrix, std::span<std::int32_t> x) {
  const bool scaling = settings_.dynamic_scaling;
  if (z_r_ == 0 || all_zero(d_)) {
    stopped_ = true;
    return false;
  }

  multiply(matrix, d_);
  d_q_ = inner_product(d_, q_);
  if (d_q_ <= 0) {
    // Every step so far lowered the energy ½xᵀAx - bᵀx; this one would raise it without
    // bound. x stays the best there was.
    report_.flags.raise(stability::Flag::negative_curvature);
    ++report_.breakdowns;
    return false;
  }
  alpha_ = ratio(z_r_, d_q_, settings_.coefficient_bits);
  alpha_.exponent += direction_exponent_;

  // r is re-scaled before it is written, by the bound |r| + α·|q| on what will come.
  int up = 0;
  if (scaling) {
    const auto step_size = static_cast<std::uint64_t>(alpha_.mantissa) * largest(q_);
    up = rescaling(
        sum_bit_length(largest(r_), 0, step_size, alpha_.exponent, settings_.residual_bits()),
        residual_available_, residual_target_);
  }
  const int x_exponent =
      alpha_.exponent + settings_.rhs_shift() - residual_exponent_ - settings_.product_shift();
  for (std::size_t i = 0; i < r_.size(); ++i) {
    const std::int64_t along = std::int64_t{alpha_.mantissa} * d_[i];
    const std::int64_t change = std::int64_t{alpha_.mantissa} * q_[i];
    x[i] = clamp(x[i] + shift(along, x_exponent), vector_limit_);
    r_[i] = clamp(shift(r_[i], up) - shift(change, alpha_.exponent + up), residual_limit_);
  }
  residual_exponent_ += up;
  direction_exponent_ -= up;  // z grew with r

  precondition();
  const std::int64_t z_r_old = z_r_;
  z_r_ = inner_product(z_, r_);
  beta_ = ratio(z_r_, z_r_old, settings_.coefficient_bits);
  beta_.exponent -= 2 * up;

  // So is d, by |z| + β·|d|.
  up = 0;
  if (scaling && z_r_ != 0) {
    const auto carried = static_cast<std::uint64_t>(beta_.mantissa) * largest(d_);
    up = rescaling(sum_bit_length(largest(z_), direction_exponent_, carried, beta_.exponent,
                                  settings_.vector_bits),
                   settings_.vector_bits - 1, direction_target_);
  }
  direction_exponent_ += up;
  for (std::size_t i = 0; i < d_.size(); ++i) {
    const std::int64_t carried = std::int64_t{beta_.mantissa} * d_[i];
    d_[i] = clamp(shift(z_[i], direction_exponent_) + shift(carried, beta_.exponent + up),
                  vector_limit_);
  }
  return true;
}

// q = A·vector. The sum is exact and is rounded and clamped once, when it is written.
void ReferenceSolver::multiply(const QuantisedMatrix& matrix,
                               std::span<const std::int32_t> vector) {
  const int product_shift = settings_.product_shift();
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const std::array<std::int64_t, 3> sum = block_row_sums(matrix, row, vector);
    for (std::size_t c = 0; c < 3; ++c) {
      q_[at(3 * row) + c] = clamp(shift(sum[c], -product_shift), product_limit_);
    }
  }
}

void ReferenceSolver::precondition() {
  if (settings_.method == Method::cg) {
    std::ranges::copy(r_, z_.begin());
    return;
  }
  for (std::size_t i = 0; i < r_.size(); ++i) {
    const std::int64_t product = std::int64_t{r_[i]} * inverse_diagonal_[i];
    z_[i] = clamp(shift(product, -preconditioner_shift_), product_limit_);
  }
}

std::int64_t ReferenceSolver::inner_product(std::span<const std::int32_t> a,
                                            std::span<const std::int32_t> b) {
  Accumulator sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum.add(a[i], b[i]);
  bool overflow = false;
  const std::int64_t result = sum.value(overflow);
  if (overflow) report_.flags.raise(stability::Flag::scalar_overflow);
  return result;
}

std::int32_t ReferenceSolver::clamp(std::int64_t value, std::int64_t limit) {
  return static_cast<std::int32_t>(saturate(value, limit, report_.saturations));
}

// What the words themselves cannot tell: the true residual, and which flags follow from it.
void ReferenceSolver::judge(const QuantisedMatrix& matrix, const Job& job) {
  const int rhs_shift = settings_.rhs_shift();
  double rhs = 0;
  double residual = 0;
  double floor = 0;
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const std::array<std::int64_t, 3> product = block_row_sums(matrix, row, job.x);
    std::array<std::int64_t, 3> magnitudes = {0, 0, 0};
    for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
      for (int e = 0; e < 9; ++e) magnitudes[at(e / 3)] += std::abs(matrix.value[at(9 * k + e)]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      std::int64_t ignored = 0;
      const std::int64_t b = saturate(job.b[at(3 * row) + c], residual_limit_, ignored)
                             << rhs_shift;
      rhs += square(static_cast<double>(b));
      residual += square(static_cast<double>(Int128{b} - product[c]));
      floor += square(static_cast<double>(magnitudes[c]));
    }
  }
  report_.rhs_norm = std::sqrt(rhs);
  report_.true_residual_norm = std::sqrt(residual);
  report_.rounding_floor = std::sqrt(floor);
  report_.residual_norm = std::ldexp(norm(r_), rhs_shift - residual_exponent_);

  if (report_.saturations > 0) report_.flags.raise(stability::Flag::saturation);
  // Without dynamic scaling a direction can round to zero, or stall at a few last places, far
  // from the solution.
  if (stopped_ && !all_zero(r_)) report_.flags.raise(stability::Flag::stagnation);

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
