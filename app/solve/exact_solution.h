#pragma once

#include <span>
#include <vector>

#include "models/sparse/block_matrix.h"

namespace hvp::app {

// A⁻¹·b in double precision, by Cholesky's method. The unknowns are scaled by powers of two
// first, which costs no digit, so that only what cancellation destroys counts as singular and not
// units that differ. Throws InputError, with the reason, where A is not positive definite as far
// as double precision can tell. `equations` is the number that the user stated; the others fill the
// last block.
std::vector<double> exact_solution(const sparse::BlockMatrix& a, std::span<const double> b,
                                   int equations);

// ‖v‖ without overflow or underflow of the squares.
double norm(std::span<const double> v);

// ‖v - reference‖ / ‖reference‖; infinite where only the reference is zero.
double relative_distance(std::span<const double> v, std::span<const double> reference);

}  // namespace hvp::app
