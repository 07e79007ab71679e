#include "models/stability/flag.h"

#include <cstddef>

namespace hvp::stability {

namespace {
// The remedies are those that fixed::next_remedy() applies, in its order; docs/hard-cases.md shows
// each of them tried.
constexpr std::array<Description, static_cast<std::size_t>(Flag::count)> kDescriptions = {{
    {"saturation", "a word of the solver reached its limit and was clamped",
     "solver.dynamic_scaling and scaling_down = true, coefficient_format = \"own-shift\", "
     "static_scale = \"matrix-norm\" (without a preconditioner), a displacement_range twice the "
     "displacements, method = \"jacobi-pcg\", more matrix_bits and vector_bits; with refinement "
     "more refinement.passes, then more solver.iterations, then more bits"
     "; of a body that is not linear as for divergence: object.model.matrix.renew_every = 50, or a "
     "headroom nearer to matrix.growth"},
    {"negative-curvature", "d'Ad was not positive: the rounded matrix is not positive definite",
     "solver.matrix_scaling = \"diagonal\", then more matrix_bits and vector_bits; where 24 bits "
     "leave it indefinite no setting of the board helps: more anchors, less contrast of stiffness "
     "or a lower Poisson's ratio"},
    {"zero-diagonal", "a diagonal entry of the matrix rounds to zero",
     "solver.matrix_scaling = \"diagonal\", then more matrix_bits and vector_bits"},
    {"stagnation",
     "the step became zero, or the second half of the iterations made no progress, before the "
     "residual was as small as the words allow",
     "solver.dynamic_scaling and scaling_down = true, coefficient_format = \"own-shift\", method = "
     "\"jacobi-pcg\", more refinement.passes, more solver.vector_bits; with refinement more "
     "refinement.passes, then more solver.iterations, then more matrix_bits and vector_bits"
     "; of a body that is not linear as for divergence: object.model.matrix.renew_every = 50, or a "
     "headroom nearer to matrix.growth"},
    {"scalar-overflow", "an inner product left its 64 bits",
     "solver.scalar_bits = 128, or fewer vector_bits"},
    {"divergence", "the residual at the end was larger than at the start and than b",
     "as for saturation: solver.dynamic_scaling and scaling_down = true, coefficient_format = "
     "\"own-shift\", static_scale = \"matrix-norm\" (without a preconditioner), a "
     "displacement_range twice the displacements, method = \"jacobi-pcg\", more matrix_bits and "
     "vector_bits; with refinement more refinement.passes, then more solver.iterations; of a body "
     "that is not linear object.model.matrix.renew_every = 50, or down to 1, or a "
     "headroom nearer to matrix.growth"},
    {"matrix-rounding",
     "rounding the matrix to its words moves the solution further from the true model than "
     "reference.tolerance",
     "solver.matrix_scaling = \"diagonal\", more refinement.passes, more matrix_bits and "
     "vector_bits; each bit about halves it"},
    {"not-converged",
     "the solver's own error is larger than reference.solver_tolerance, or the residual that "
     "refinement leaves than refinement.tolerance",
     "first what other flags say; then a solver.displacement_range twice the displacements if it "
     "is far wider, method = \"jacobi-pcg\", more refinement.passes, more solver.iterations, more "
     "matrix_bits and vector_bits; of a body that is not linear also "
     "object.model.matrix.renew_every = 50, or down to 1, or a headroom nearer to "
     "matrix.growth, smaller loads, or [dynamics]; "
     "with explicit steps more host.substeps"},
    {"range-exceeded",
     "a displacement or a right-hand side did not fit its word and was clamped: where it was a "
     "contact's, what was held is not what the contact asked for, and the force is wrong",
     "a solver.displacement_range twice the displacements, static_scale = \"matrix-norm\" (without "
     "a preconditioner), or a slower probe"},
    {"locking", "tetrahedra that are too stiff at this Poisson's ratio",
     "object.elements = \"quadratic-mean-dilatation\", on fewer object.mesh.nodes where longer "
     "rows do not fit the device, with solver.matrix_scaling = \"diagonal\", more "
     "solver.iterations and refinement.passes for the larger condition number; or a "
     "Poisson's ratio of at most 0.45, or more nodes"},
    {"poor-elements", "the mesh has slivers: dihedral angles under 5 or over 175 degrees",
     "no setting of the board helps: a surface without needle-shaped triangles, or another node "
     "count"},
    {"solver-timeout", "the board did not end in time what the driver waited for",
     "no setting of the solver's words helps: a longer host.timeout, fewer solver.iterations, or "
     "why the board is late in trace.json"},
    {"wrapped", "a word of the solver did not fit and lost its high bits",
     "solver.overflow = \"saturate\", and then what that run's flags say"},
    {"force-step",
     "the force changes by more than a tenth of its largest value from one frame to the next, or "
     "by more than can go unnoticed while a contact is handed from node to node",
     "of a node, contact.kind = \"proxy\", else a longer contact.hand_over; a slower probe, or a "
     "shorter budget.period"},
    {"force-ringing", "the force turns back and forth from frame to frame",
     "a contact.hand_over of at least 20 ms, dynamics.newmark_gamma above 0.5, a finer "
     "device.encoder.resolution, a smaller contact.patch_radius"},
    {"limit-cycle",
     "the force moves on while the tip rests, or a device with mass while its user does: rounding "
     "of the solver's words, a body that hardly damps its swing, a hand that does, or a loop too "
     "stiff for its delay or its encoder",
     "where the device moves, a smaller wall.stiffness, a finer device.encoder, more "
     "device.friction, device.dynamics.damping or hand.damping; else method = \"jacobi-pcg\", a "
     "solver.displacement_range twice the displacements, more "
     "refinement.passes, more vector_bits"},
    {"beyond-linearity",
     "the body is deformed further than linear elasticity holds, or stretched further than a law "
     "that is linear in strain, or turned inside out",
     "no setting of the board's words helps: a shallower motion of the probe, a "
     "contact.patch_radius, which spreads it, or a body that is not linear: object.model.kind, "
     "of which the strain's line names one, with [refinement]"},
    {"force-clamped", "a force did not fit the device's register and was clamped",
     "no setting of the board helps: a softer wall or body, less wall.damping, a shallower motion "
     "of the probe"},
    {"contact-missed",
     "the tip was inside the body and nothing was held: on a part that is anchored, or between two "
     "passes of the collision process",
     "no setting of the board helps: a probe that touches what is free, a higher "
     "host.graphics.rate, contact.fresh, a slower probe"},
    {"active-port", "the loop fed energy into device and hand: what is felt there is not passive",
     "no setting of the board's words helps: what loop.energy.fed_by names: a smaller "
     "wall.stiffness or a softer body, a moderate "
     "wall.damping, a shorter budget.period, less latency or host.delay, a finer device.encoder or "
     "more device.friction, more device.dac.bits, a faster device.amplifier; against each of them "
     "more device.dynamics.damping; hvp stability says up to which stiffness the loop is stable "
     "and passive"},
    {"force-saturated",
     "a force was beyond what converter, amplifier or the device's maker allow, and was clamped",
     "no setting of the board's words helps: a softer wall or body, a shallower motion of the "
     "probe, or a larger device"},
    {"device-at-its-limit",
     "the device was out of its reach, at a singular pose or beyond its counters",
     "no setting of the board's words helps: a motion inside the device's workspace, another "
     "device.kinematics.home, more "
     "device.encoder.counter_bits"},
    {"low-gain-margin",
     "the wall, or the body at its contact, is nearer to the stiffness at which the linear loop is "
     "unstable at its worst delay than budget.gain_margin allows",
     "no setting of the board's words helps: a smaller wall.stiffness or a softer body, a shorter "
     "budget.period, less latency or host.delay, more device.dynamics.damping"},
    {"inverted-element",
     "an element of the body was turned inside out, or would have been: where it has no forces "
     "then, that step is taken back",
     "no setting of the board's words helps: a slower or shallower motion of the probe, a "
     "contact.patch_radius over which the probe presses, more nodes; of a corotational or St "
     "Venant-Kirchhoff body, which hardly resists it, and of springs, which do not see volume, "
     "object.model.kind = \"neo-hookean-isochoric\"; of a neo-Hookean one more "
     "refinement.passes"},
    {"unstable-step",
     "an explicit time step was longer than the body, deformed as it was, is stable for; one that "
     "would throw it apart is not done, and the last state stays",
     "no setting of the board helps: more host.substeps, or a shallower motion of the probe"},
    {"matrix-word-beyond-scale",
     "an entry of the renewed matrix did not fit its word at the scale of the body at rest, and "
     "the "
     "matrix before it stayed",
     "more object.model.matrix.headroom; matrix.growth says how much was needed"},
    {"bus-error",
     "the bus lost or damaged what went between host and board, or nobody answered there",
     "no setting of the solver's words helps: what the driver's ERROR lines say, and more "
     "host.recovery.retries where there is time for them"},
    {"board-error", "the board refused what the driver asked for, or failed",
     "no setting of the solver's words helps: what the driver's ERROR lines say"},
    {"no-start",
     "a frame kept the last solution: with the contact in its place elements had no "
     "forces, or forces beyond all bounds",
     "no setting of the board's words helps: what inverted-element or energy-overflow say, else a "
     "slower or shallower motion of the probe, or a contact.patch_radius over which it presses"},
    {"energy-overflow",
     "the strain energy of an element of the body, exponential in its strain, was beyond what the "
     "law is defined for",
     "no setting of the board's words helps: a smaller object.model.exponent, a shallower motion "
     "of the probe, or a contact.patch_radius over which it presses"},
    {"proxy-at-rim",
     "a proxy stood beside nodes that do not move, within its radius of an edge of more than 40 "
     "degrees, or slid where the body's stiffness changes by more than friction pays for: its "
     "force changes as on no smooth surface, and may give the hand energy",
     "no setting of the board helps: a motion of the probe that stays on one face, away from edges "
     "and what is anchored; a larger contact.friction, with which no energy is made there"},
    {"contact-doubtful",
     "the probe is so large beside the elements, or the mesh so coarse, that more than a tenth of "
     "its depth is the softness of a point, the tip was deeper than half of the body or further "
     "from "
     "the surface than a diameter "
     "of its probe, two probes were in one place, "
     "or the friction's cone was not reached in a frame's steps",
     "no setting of the board helps: contact.kind = \"patch\" where the probe is large beside the "
     "elements; a slower or shallower motion of the probe, fewer nodes or a smaller probe.radius, "
     "or "
     "probes that stay apart"},
}};
}  // namespace

const Description& describe(Flag flag) { return kDescriptions.at(static_cast<std::size_t>(flag)); }

}  // namespace hvp::stability
