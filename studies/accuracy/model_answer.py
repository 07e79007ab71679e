"""What accuracy costs across models, in words: per scene what goes unnoticed for how much."""

from collections.abc import Sequence

from studies.accuracy.families import RENEW, SETTINGS, SUBSTEPS
from studies.accuracy.grid import ITERATIONS, MATRIX_BITS, METHOD, PASSES, VECTOR_BITS
from studies.accuracy.measured import Measured, front
from studies.accuracy.mesh_error import MeshError
from studies.accuracy.model_picture import NORM, NOTICEABLE

TARGETS = (NOTICEABLE[0], 1e-2)
FORCE = f"force_{NORM}"
DISPLACEMENT = f"displacement_{NORM}"

LEFT_OUT = (
    "Left out: mixed elements, which the project does not have; quadratic elements of a member, "
    "which are those of the finer meshes alone; relaxation, which multiplies every law alike; "
    "an anisotropic law, for none is there; refinement of the linear body on the host, which is "
    "refused as it has nothing to refine; other words, several boards and other rates of the host, "
    "which `hvp study accuracy` and `hvp study` vary for one model; operations a frame, which "
    "results do not have: a host's share of a frame is its time at the scenario's rate."
)


def words(name: str, measured: Sequence[Measured], mesh: MeshError, truth: str) -> list[str]:
    """Of one scene: the cheapest that reaches each error, the best of the linear law, the mesh."""
    lines = [f"{name}, against {truth}: {_target(measured, target)}" for target in TARGETS]
    linear = [m for m in measured if m.member.law == "linear" and m.drawn and m.error(FORCE)]
    if linear:
        best = min(linear, key=lambda m: m.error(FORCE) or 0.0)
        lines.append(
            f"{name}: the linear law's force is {_share(best.error(FORCE))} off at best, its "
            f"displacement {_share(best.error(DISPLACEMENT))} ({describe(best)}); more passes or "
            "wider words do not change the law."
        )
    return [*lines, f"{name}: {mesh.words}"]


def describe(measured: Measured) -> str:
    """A member in few words."""
    c = measured.member.columns
    parts = [measured.member.family]
    if passes := c.get(PASSES):
        parts.append(f"{passes} pass{'' if passes == 1 else 'es'}")
    if c.get(METHOD):
        parts.append(f"{c[ITERATIONS]} iterations of {c[METHOD]}")
    if c.get(MATRIX_BITS):
        parts.append(f"{c[MATRIX_BITS]}/{c[VECTOR_BITS]} bits")
    if c.get(RENEW):
        parts.append(f"every {c[RENEW]} frames")
    if c.get(SUBSTEPS):
        parts.append(f"{c[SUBSTEPS]} substeps")
    return ", ".join(parts)


def best_of_families(measured: Sequence[Measured]) -> list[Measured]:
    """Of each family what is on its front of force and time, the families in their order."""
    families: dict[str, list[Measured]] = {}
    for one in measured:
        families.setdefault(one.member.family, []).append(one)
    return [m for of in families.values() for m in front(of, FORCE)]


def columns_of(measured: Measured) -> dict[str, object]:
    """Its settings under the names of the table, without what does not apply."""
    return {key: measured.member.columns.get(key) or None for key in SETTINGS}


def _target(measured: Sequence[Measured], target: float) -> str:
    reaching = [
        m
        for m in measured
        if m.drawn and (error := m.error(FORCE)) is not None and error <= target and m.worst_us
    ]
    if not reaching:
        return f"no member reaches a force error of {_share(target)}."
    usable = [m for m in reaching if m.state == "fits"]
    best = min(usable or reaching, key=lambda m: m.worst_us or 0.0)
    unless = "" if usable else f", none of them as this scene stands; the fastest ({best.state})"
    return (
        f"a force error of {_share(target)} in 95 % of the frames costs at least "
        f"{(best.worst_us or 0.0) / 1000:.3g} ms{unless}: {describe(best)}, error "
        f"{_share(best.error(FORCE))}, of the displacement {_share(best.error(DISPLACEMENT))}."
    )


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.2g} %"
