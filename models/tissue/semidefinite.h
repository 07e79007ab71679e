#pragma once

#include "models/tissue/element.h"
#include "models/tissue/operations.h"

namespace hvp::tissue {

// What make_semidefinite() did with an element.
struct Projection {
  bool changed = false;  // it had a negative eigenvalue
  Operations operations = {};
};

// Takes away the negative eigenvalues of an element's tangent (Teran et al. 2005, "Robust
// quasistatic finite elements and flesh simulation"), whose sums over elements are then positive
// semidefinite whatever the deformation. It is never softer than the tangent, so that Newton's
// method with it does not overshoot. Forces know no place, so that the twelve rows of the four
// nodes have three zero eigenvalues; the other nine are those of the blocks in an orthonormal basis
// without them. A factorisation finds most elements as they should be; the others are diagonalised
// by Jacobi's rotations. An eigenvalue above −2⁻²⁴ of the trace counts as rounding: it is below
// half a unit of the longest words of a matrix. `support` (N/m) is what else stands on the twelve
// diagonal entries, such as inertia: an element whose eigenvalues are above −support is left as it
// is.
Projection make_semidefinite(Blocks<double>& blocks, double support = 0);

}  // namespace hvp::tissue
