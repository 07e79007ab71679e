#include "models/host/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "models/host/costs.h"
#include "models/index.h"
#include "models/stability/force_quality.h"

namespace hvp::host {

namespace {

using stability::Flag;
using stability::Flags;

// The exponent of a pass' finest unit over the range's; a finer one is beyond double precision.
constexpr int kFinest = -64;
// The rounding error of a residual that is zero, as a share of ‖A‖∞·‖u‖∞: a few units in the last
// place.
constexpr double kNoise = 0x1p-50;
// How many times larger than the gain predicts an increment may be and still fit its word of x.
constexpr double kReserve = 4;
// A pass that has no gain of its own yet takes this times the gain of the pass before.
constexpr double kUnknown = 4;
constexpr double kWiden = 4;
// The factor by which a gain decays in a frame: a larger one is believed at once, a smaller one
// within some ten frames.
constexpr double kForget = 0.75;

// ‖A‖∞, the largest sum of magnitudes in a row.
double row_sum_norm(const sparse::BlockMatrix& matrix) {
  double norm = 0;
  for (int row = 0; row < matrix.block_rows(); ++row) {
    std::array<double, 3> sum = {0, 0, 0};
    for (int k = matrix.row_begin[at(row)]; k < matrix.row_begin[at(row) + 1]; ++k) {
      for (std::size_t e = 0; e < 9; ++e) sum[e / 3] += std::abs(matrix.block(at(k))[e]);
    }
    norm = std::max({norm, sum[0], sum[1], sum[2]});
  }
  return norm;
}

// The least k with value <= 2^k; value > 0.
int ceil_log2(double value) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return mantissa == 0.5 ? exponent - 1 : exponent;
}

// The flags that concern a pass' own words: a later pass sees the remaining residual and repairs
// it.
Flags repairable() {
  Flags flags;
  flags.raise(Flag::saturation);
  flags.raise(Flag::stagnation);
  flags.raise(Flag::divergence);
  return flags;
}

}  // namespace

void Refinement::declare(config::Visitor& v) {
  v.integer("passes", passes, {1, 16},
            {"solves of a frame: each is for the increment that the residual of the last leaves",
             "two bring 12/16-bit words under 1e-3 of the true trajectory, docs/fixed-point.md"});
  v.quantity("tolerance", tolerance, config::Dimension::dimensionless, config::between(0, 1),
             {"residual after the last pass, of the largest right-hand side so far, above which "
              "a frame is flagged not-converged",
              "measured: the displacement is off by 17 to 30 times as much, docs/fixed-point.md"});
}

RefinedSolve::RefinedSolve(const Refinement& refinement, fem::InternalForces& forces,
                           const sparse::BlockMatrix& matrix, const fixed::System& system,
                           std::span<const double> initial)
    : matrix_(matrix),
      scaling_(system),
      tolerance_(refinement.tolerance),
      norm_(row_sum_norm(matrix)),
      displacement_limit_(static_cast<double>(fixed::word_limit(system.settings.vector_bits))),
      force_limit_(static_cast<double>(fixed::word_limit(system.settings.residual_bits()))),
      increments_(forces, matrix, initial, system.settings.start,
                  system.settings.displacement_range, scaling_.force_unit()),
      r_(initial.size()),
      increment_(initial.size()),
      passes_(refinement.passes),
      divided_(refinement.divided(false)),
      gain_(at(refinement.passes), 0.0) {
  if (system.settings.matrix_scaling != fixed::MatrixScaling::none) scale_ = system.scale;
}

Refinement::Passes Refinement::divided(bool goes_on) const {
  if (!goes_on) return {passes, 0, 0};
  const int before = (passes + 1) / 2;
  return {before, std::max(1, passes - before), passes};
}

void RefinedSolve::expect_to_go_on() {
  divided_ = Refinement{passes_, tolerance_}.divided(true);
  gain_.assign(at(divided_.before + divided_.most_after), 0.0);
  increments_.set_imperceptible(stability::ForceQuality::kNoForce);
}

void RefinedSolve::begin(std::span<const double> f, const fem::Hold& hold) {
  increments_.begin(f, hold);
  pass_ = 0;
  first_pass_ = 0;
  end_ = divided_.before;
  passes_made_ = 0;
  pass_flags_ = {};
  flags_ = {};
  clamped_ = 0;
  way_ = 0;
  for (std::size_t n = 0; n < increments_.contact().size(); ++n) {
    for (int i = 0; i < 3; ++i) {
      const double scale = scale_.empty() ? 1 : scale_[at(3 * increments_.contact()[n] + i)];
      const double moved = std::abs(increments_.moved()[n][i]);
      way_ = std::max(way_, moved / (scale * scaling_.displacement_unit()));
    }
  }
  since_next_ = increments_.begin_operations();
}

void RefinedSolve::go_on(std::span<const double> f, double way) {
  increments_.go_on(f);
  pass_ = divided_.before;
  first_pass_ = pass_;
  end_ = divided_.before + divided_.most_after;
  const double least_scale = scale_.empty() ? 1 : *std::ranges::min_element(scale_);
  way_ = way / (least_scale * scaling_.displacement_unit());
}

// The pass' unit, as an exponent: the residual fits its word, and so does the increment that the
// gain foretells. `largest` is the residual's largest word in the range's own unit.
int RefinedSolve::exponent_for(double largest) const {
  const auto pass = at(pass_);
  double gain = gain_[pass];
  if (gain == 0) gain = pass_ > first_pass_ ? kUnknown * gain_[pass - 1] : way_ / largest;
  // No increment is beyond the range that the scenario states.
  if (gain == 0) return 0;
  const double filling =
      largest * std::max(1 / force_limit_, kReserve * gain / displacement_limit_);
  return std::clamp(ceil_log2(filling), kFinest, 0);
}

bool RefinedSolve::next(std::span<std::int32_t> b) {
  next_operations_ = std::exchange(since_next_, 0);
  if (pass_ == end_) return false;
  const bool product = !increments_.current();
  const bool formed = increments_.form_residual();
  next_operations_ += residual_operations(product);
  if (!formed) return false;
  if (first_pass_ > 0 && pass_ >= first_pass_ + divided_.after) {
    next_operations_ += increments_.within_operations();
    if (increments_.within(tolerance_)) return false;
  }
  std::ranges::copy(increments_.residual(), r_.begin());
  const std::span<const double> u = increments_.displacement();
  double largest = 0;
  double largest_r = 0;
  double largest_u = 0;
  for (std::size_t i = 0; i < r_.size(); ++i) {
    largest = std::max(largest, std::abs(scale_.empty() ? r_[i] : scale_[i] * r_[i]));
    largest_r = std::max(largest_r, std::abs(r_[i]));
    largest_u = std::max(largest_u, std::abs(u[i]));
  }
  if (largest_r <= kNoise * norm_ * largest_u) return false;
  exponent_ = exponent_for(largest / scaling_.force_unit());
  // The unit is a power of two times the range's: scaling r by it loses nothing.
  for (double& r : r_) r = std::ldexp(r, -exponent_);
  clamped_ += scaling_.right_hand_side(r_, b);
  largest_b_ = 0;
  for (const std::int32_t word : b) largest_b_ = std::max(largest_b_, std::abs(double{1} * word));
  return largest_b_ > 0;
}

void RefinedSolve::accept(std::span<const std::int32_t> x, Flags flags) {
  scaling_.displacements(x, increment_);
  double largest = 0;
  for (const std::int32_t word : x) largest = std::max(largest, std::abs(double{1} * word));
  const std::span<double> displacement = increments_.change();
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double u = displacement[i] + std::ldexp(increment_[i], exponent_);
    const double limit = scaling_.displacement_limit(i);
    displacement[i] = std::clamp(u, -limit, limit);
    if (displacement[i] != u) ++clamped_;
  }
  since_next_ = accept_operations();
  pass_flags_.merge(flags);

  double& gain = gain_[at(pass_)];
  if (largest >= displacement_limit_ && exponent_ < 0) {
    gain = kWiden * std::max(gain, largest / largest_b_);
    ++widened_;
  } else {
    gain = std::max((largest + 1) / largest_b_, kForget * gain);
  }
  ++pass_;
  ++passes_made_;
}

void RefinedSolve::finish() {
  const bool converged = increments_.finish(tolerance_);
  flags_ = pass_flags_;
  if (converged) flags_ = Flags(flags_.bits() & ~repairable().bits());
  if (!converged) flags_.raise(Flag::not_converged);
  if (clamped_ > 0) flags_.raise(Flag::range_exceeded);
  flags_.merge(increments_.flags());
}

double RefinedSolve::conversion() const {
  const double entries = matrix_.rows();
  return conversion_operations(matrix_.rows()) + (scale_.empty() ? 0 : entries);
}

double RefinedSolve::residual_operations(bool product) const {
  // Subtract, and find the largest of r and u.
  const double residual = 3.0 * matrix_.rows() + conversion();
  return product ? increments_.evaluate_operations() + residual : residual;
}

double RefinedSolve::accept_operations() const {
  // Find the largest, add, two comparisons with the range.
  return 4.0 * matrix_.rows() + conversion();
}

double RefinedSolve::finish_operations() const { return increments_.finish_operations(); }

std::vector<Step> RefinedSolve::steps() const {
  std::vector<Step> steps = {
      {"first residual (without contact)", Step::Where::host, residual_operations(false)},
      {"each further pass' residual", Step::Where::host,
       accept_operations() + residual_operations(true), divided_.before - 1},
      {"", Step::Where::board, 0, divided_.before},
      {"last increment", Step::Where::host, accept_operations()},
      {"residual after the force", Step::Where::host, finish_operations(), 1, true}};
  return steps;
}

// The residual that the last pass leaves is looked at before it is known to be the last.
std::vector<Step> RefinedSolve::further_steps() const {
  const double looked = divided_.most_after > divided_.after
                            ? residual_operations(true) + increments_.within_operations()
                            : 0;
  const double judged =
      looked > 0 ? finish_operations() - increments_.evaluate_operations() : finish_operations();
  return after_force(
      {{"residual with the new forces", Step::Where::host, residual_operations(true),
        divided_.after},
       {"", Step::Where::board, 0, divided_.after},
       {"last increment, and what it leaves", Step::Where::host, accept_operations() + looked},
       {"judgement of that", Step::Where::host, judged}});
}

}  // namespace hvp::host
