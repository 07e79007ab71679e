"""What accuracy costs, in words: the least time of each error, over what was tried.

A mesh of other nodes is another body: its sets are compared with their own model, and so with
nothing that the scenario's sets are. They have words of their own.
"""

from collections import Counter
from collections.abc import Sequence

from studies.accuracy.between import fewer
from studies.accuracy.design import BUDGET, FORCE_ERROR, Design
from studies.accuracy.grid import (
    ITERATIONS,
    MATRIX_BITS,
    MEMORY,
    METHOD,
    NODES,
    PASSES,
    SCALING,
    VECTOR_BITS,
)
from studies.accuracy.partitions import KEY

TARGETS = (1e-1, 1e-2, 1e-3)
_PLURAL = {
    "fits": "fit",
    "breaks down": "break down",
    "does not fit": "do not fit",
}


def words(designs: Sequence[Design], device: str) -> list[str]:
    """What each accuracy costs at least, the question that the study answers; then what was tried.

    The scenario's own design is the first.
    """
    lines = [_target(designs, device, target) for target in TARGETS]
    budget = designs[0].record.metrics.get(BUDGET)
    own = designs[0]
    lines.append(
        f"The scenario itself ({own.state}): {_ms(own)}, error {_text(own.error())}, force "
        f"{_text(own.error(FORCE_ERROR))}; budget "
        f"{float(budget) / 1000 if isinstance(budget, int | float) else 0:g} ms."
    )
    return [*lines, _tried(designs)]


def _target(designs: Sequence[Design], device: str, target: float) -> str:
    reaching = [d for d in designs if d.reaches(target) and d.own_mesh]
    usable = [d for d in reaching if d.usable]
    name = f"A displacement error of {short(target)} (95 % of the frames in contact)"
    if usable:
        best = min(usable, key=lambda d: d.time_us or 0.0)
        text = (
            f"{name} costs at least {_ms(best)} on this device ({device}); the cheapest set is "
            f"{describe(best)}: error {_text(best.error())}, force "
            f"{_text(best.error(FORCE_ERROR))}."
        )
        less = fewer(designs, best)
        missed = less.error() if less else None
        if missed is not None and missed > target:
            text += f" With one iteration less it does not reach that: {missed:.3g}."
        faster = [d for d in reaching if (d.time_us or 0.0) < (best.time_us or 0.0)]
        if faster:
            text += (
                f" Faster with that error, but none for this device and budget: {counted(faster)}."
            )
        return text + _coarser(designs, target, best)
    if reaching:
        best = min(reaching, key=lambda d: d.time_us or 0.0)
        return (
            f"{name}: none of these sets reaches it on this device ({device}) within the budget; "
            f"the fastest that does elsewhere ({best.state}): {_ms(best)} with {describe(best)}."
        )
    return f"{name}: no set of these reaches it."


def _coarser(designs: Sequence[Design], target: float, best: Design) -> str:
    other = [
        d
        for d in designs
        if not d.own_mesh
        and d.usable
        and d.reaches(target)
        and (d.time_us or 0.0) < (best.time_us or 0.0)
    ]
    if not other:
        return ""
    least = min(other, key=lambda d: d.time_us or 0.0)
    return (
        f" On another mesh, whose distance from the scenario's is not in the error: {_ms(least)} "
        f"with {describe(least)}, error {_text(least.error())}."
    )


def counted(designs: Sequence[Design]) -> str:
    """How many there are of each state."""
    states = Counter(design.state for design in designs)
    return ", ".join(
        f"{count} {_PLURAL.get(state, state) if count > 1 else state}"
        for state, count in states.items()
    )


def _tried(designs: Sequence[Design]) -> str:
    """What "at least" is meant of."""
    numbers = sorted({design.tried for design in designs if design.tried})
    between = sum(design.between for design in designs)
    text = f"Least of {len(designs)} sets"
    if numbers:
        text += (
            ", each but the scenario's own with the partitions that make it fastest of those "
            f"that fit, 1 to {' or '.join(map(str, numbers))} tried"
        )
        text += (
            "; where none fits, with one of the memories that the program then proposes, if "
            "that is enough"
        )
    text += "; every other key is the scenario's."
    if between:
        text += (
            f" {between} of them stand between those of the grid: where fewer iterations might "
            "cost less than the cheapest set known, they were halved between the most that do not "
            "reach the error and the least that do, down to 1; and one pass less was tried where "
            "a set is refined."
        )
    return text


def describe(design: Design) -> str:
    """A design's settings in few words."""
    if design.own:
        return "the scenario's own"
    c = design.columns
    text = (
        f"{c[METHOD]}, {c[ITERATIONS]} iteration{'s' if c[ITERATIONS] != 1 else ''}, "
        f"{c[MATRIX_BITS]}/{c[VECTOR_BITS]} bits"
    )
    if c.get(PASSES):
        text += f", refined in {c[PASSES]} pass{'es' if c[PASSES] != 1 else ''}"
    if c.get(SCALING) not in (None, "none"):
        text += f", {c[SCALING]} scaling"
    if c.get(NODES):
        text += f", {c[NODES]} nodes"
    if c.get(KEY):
        text += f", {c[KEY]} partition{'s' if c[KEY] != 1 else ''}"
    if c.get(MEMORY):
        text += f", {c[MEMORY]}"
    return text


def short(value: float) -> str:
    """An error as people write it: 1e-2."""
    digits, power = f"{value:.0e}".split("e")
    return f"{digits}e{int(power)}"


def _ms(design: Design) -> str:
    return f"{design.time_us / 1000:.3g} ms" if design.time_us is not None else "no time"


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"
