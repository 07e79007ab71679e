#pragma once

#include <span>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fixed {

// A system as the board gets it, and what the host has to know to translate.
struct System {
  Settings settings;  // static_shift is the one in force
  QuantisedMatrix matrix;
  // s_i of MatrixScaling::diagonal: the board solves (S·A·S)·y = S·b, and x = S·y. Of one where
  // the matrix is not scaled.
  std::vector<double> scale;
};

// Scales and rounds a matrix as the settings say. Throws InputError as quantise() does, and where
// a diagonal that is to be scaled is not above zero.
System prepare(const sparse::BlockMatrix& matrix, const Settings& settings);

// What the board's words stand for, in the units of the matrix that was prepared: S⁻¹·Ã·S⁻¹.
sparse::BlockMatrix dequantise(const System& system);

// S·A·S. What is symmetric stays so to the last bit.
sparse::BlockMatrix scaled(const sparse::BlockMatrix& matrix, std::span<const double> scale);

// The least m with which b = A·x cannot overflow its vector word for any x that fits its own:
// 2^m >= the largest sum of magnitudes of a row.
int static_shift_for(const QuantisedMatrix& matrix);

}  // namespace hvp::fixed
