#include "models/stability/flag.h"

#include <cstddef>

namespace hvp::stability {

namespace {
// The remedies are those that were tried on the hard cases; see docs/fixed-point.md.
constexpr std::array<Description, static_cast<std::size_t>(Flag::count)> kDescriptions = {{
    {"saturation", "a word of the solver reached its limit and was clamped",
     "solver.static_shift = matrix_bits - 1 or one more, or a wider solver.displacement_range"},
    {"negative-curvature", "d'Ad was not positive: the rounded matrix is not positive definite",
     "more matrix bits, more anchors, or a lower Poisson's ratio"},
    {"zero-diagonal", "a diagonal entry of the matrix rounds to zero",
     "more matrix bits, or less contrast between the stiffest and the softest part"},
    {"stagnation",
     "the step became zero, or the second half of the iterations made no progress, before the "
     "residual was as small as the words allow",
     "more vector bits, or dynamic scaling if it is off"},
    {"scalar-overflow", "an inner product left its word",
     "solver.scalar_bits = 128, or fewer vector bits"},
    {"divergence", "the residual at the end was larger than at the start and than b",
     "raise solver.static_shift, more headroom_bits, or dynamic scaling if it is off"},
    {"matrix-rounding",
     "rounding the matrix to its words moves the solution further from the true model than "
     "reference.tolerance",
     "more matrix bits, with solver.static_shift = matrix_bits - 1; each bit about halves it"},
    {"not-converged", "the solver's own error is larger than reference.solver_tolerance",
     "first what other flags say; else more iterations, method = \"jacobi-pcg\", more vector bits, "
     "or a solver.displacement_range that is not far above the displacements"},
    {"range-exceeded", "a displacement or a right-hand side did not fit its word and was clamped",
     "solver.static_shift = matrix_bits - 1 if it is less, a wider solver.displacement_range, or "
     "a slower probe"},
    {"locking", "linear tetrahedra are too stiff at this Poisson's ratio",
     "a Poisson's ratio of at most 0.45, or more nodes"},
    {"poor-elements", "the mesh has slivers: dihedral angles under 5 or over 175 degrees",
     "a surface without needle-shaped triangles, or another node count"},
    {"solver-timeout", "the board did not finish in the driver's time-out",
     "raise host.timeout, or find out why the board is late in trace.json"},
    {"wrapped", "a word of the solver did not fit and lost its high bits",
     "solver.overflow = \"saturate\", and then what that run's flags say"},
}};
}  // namespace

const Description& describe(Flag flag) { return kDescriptions.at(static_cast<std::size_t>(flag)); }

}  // namespace hvp::stability
