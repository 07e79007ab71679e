#pragma once

#include "models/fixed/quantised_matrix.h"

namespace hvp::fixed {

// How many eigenvalues of the rounded matrix are zero or negative: rounding can make a positive
// definite matrix indefinite, and a solve may end before conjugate gradients notice. Counted by
// the signs of the pivots of a sparse LDLᵀ factorisation in double precision (Sylvester's law of
// inertia); -1 where a pivot is zero and the factorisation cannot go on. A set-up call.
int non_positive_eigenvalues(const QuantisedMatrix& matrix);

}  // namespace hvp::fixed
