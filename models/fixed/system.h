#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fixed {

// A system as the board gets it, and what the host needs to convert words.
struct System {
  Settings settings;  // static_shift is the one in force
  QuantisedMatrix matrix;
  // s_i of MatrixScaling::diagonal: the board solves (S·A·S)·y = S·b, and x = S·y. All ones if the
  // matrix is not scaled.
  std::vector<double> scale;
};

// Scales and rounds a matrix as the settings say. With `headroom` above one the largest word leaves
// room for an entry so much larger, and the static shift for rows. Throws InputError as quantise()
// does, and if a diagonal entry that is to be scaled is not above zero.
System prepare(const sparse::BlockMatrix& matrix, const Settings& settings, double headroom = 1);

// How the entries of another matrix fit the words of a system.
struct Fit {
  std::int64_t beyond = 0;  // entries that do not
  double filling = 0;       // the largest, in the largest of a word
};

// Replaces the system's words by those of a matrix with the same pattern, at the same scale. Where
// an entry does not fit its word, or is not a finite number, the words stay as they are. Does not
// allocate.
Fit replace_values(const sparse::BlockMatrix& matrix, System& system);

// The matrix that the board's words stand for, in the units of the matrix that was prepared:
// S⁻¹·Ã·S⁻¹.
sparse::BlockMatrix dequantise(const System& system);

// S·A·S. A symmetric matrix stays symmetric to the last bit.
sparse::BlockMatrix scaled(const sparse::BlockMatrix& matrix, std::span<const double> scale);

// The least static shift m with which b = A·x cannot overflow its vector word for any x that fits
// its word: 2^m >= the largest sum of magnitudes of a row, of rows that grow by this factor.
int static_shift_for(const QuantisedMatrix& matrix, double growth = 1);

// The host's side of the interface to the board: the unit of each word, and the conversions. One
// unit of x is u = displacement_range / (2^(vector_bits-1) - 1); one unit of the right-hand side is
// matrix.scale · u · 2^rhs_shift.
//
// If the matrix is scaled, x = S·y, the words are those of y and S·b, and
// u = displacement_range / (least s_i · (2^(vector_bits-1) - 1)): every x within the range fits.
class Scaling {
 public:
  // Throws InputError if a unit is not a finite number above zero.
  Scaling(const Settings& settings, double matrix_scale);
  Scaling(const Settings& settings, const QuantisedMatrix& matrix)
      : Scaling(settings, matrix.scale) {}
  explicit Scaling(const System& system);

  // The unit of a word, without s_i: m and N (the unit of K·x) if the matrix is not scaled.
  double displacement_unit() const { return displacement_unit_; }
  double force_unit() const { return force_unit_; }
  // The displacement of an equation that fills its word, s_i included.
  double displacement_limit(std::size_t equation) const {
    const double limit = displacement_unit_ * static_cast<double>(displacement_limit_);
    return scale_.empty() ? limit : scale_[equation] * limit;
  }

  // Both round to the nearest word, ties away from zero, and clamp a value beyond its word. They
  // return the number of clamped values, which the caller reports as range_exceeded, and throw
  // InputError for NaN or infinity, or if a span's size differs from the other's or from the scaled
  // matrix'.
  int right_hand_side(std::span<const double> force, std::span<std::int32_t> words) const;
  int displacement_words(std::span<const double> displacement, std::span<std::int32_t> words) const;

  void displacements(std::span<const std::int32_t> words, std::span<double> displacement) const;

 private:
  Scaling(const Settings& settings, double matrix_scale, double displacement_range,
          std::vector<double> scale);

  std::vector<double> scale_;  // s_i; empty: all ones
  double displacement_unit_;
  double force_unit_;
  std::int64_t displacement_limit_;
  std::int64_t force_limit_;
};

}  // namespace hvp::fixed
