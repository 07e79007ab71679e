#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/fixed/system.h"

namespace hvp::fixed {

// The host's side of the interface to the board: what one unit of each word is worth, and the
// conversions. One unit of x is u = displacement_range / (2^(vector_bits-1) - 1); one unit of
// the right-hand side is matrix.scale · u · 2^rhs_shift.
//
// Where the matrix is scaled, x = S·y, the words are those of y and S·b, and
// u = displacement_range / (least s_i · (2^(vector_bits-1) - 1)): every x within the range fits.
class Scaling {
 public:
  // Throws InputError where a unit is not a finite number above zero.
  Scaling(const Settings& settings, double matrix_scale);
  Scaling(const Settings& settings, const QuantisedMatrix& matrix)
      : Scaling(settings, matrix.scale) {}
  explicit Scaling(const System& system);

  // Of a word, without s_i: m and N (the unit of K·x) where the matrix is not scaled.
  double displacement_unit() const { return displacement_unit_; }
  double force_unit() const { return force_unit_; }
  // The displacement of an equation that fills its word, s_i counted.
  double displacement_limit(std::size_t equation) const {
    const double limit = displacement_unit_ * static_cast<double>(displacement_limit_);
    return scale_.empty() ? limit : scale_[equation] * limit;
  }

  // Nearest words, ties away from zero; a value beyond its word is clamped. Both return how
  // many were clamped, which the caller reports as range_exceeded, and throw InputError for
  // NaN or infinity, or a span of another size than the other one or the scaled matrix.
  int right_hand_side(std::span<const double> force, std::span<std::int32_t> words) const;
  int displacement_words(std::span<const double> displacement, std::span<std::int32_t> words) const;

  void displacements(std::span<const std::int32_t> words, std::span<double> displacement) const;

 private:
  Scaling(const Settings& settings, double matrix_scale, double displacement_range,
          std::vector<double> scale);

  std::vector<double> scale_;  // s_i; empty: one
  double displacement_unit_;
  double force_unit_;
  std::int64_t displacement_limit_;
  std::int64_t force_limit_;
};

}  // namespace hvp::fixed
