"""Sets between those of the grid, where one of them may cost less: fewer iterations, fewer passes.

Time grows with iterations and with passes, and error is taken to fall with both. So the fewest
iterations of a family, all else being equal, stand between the most that do not reach a target and
the least that do; and a family whose too few iterations already take longer than the cheapest set
has none that is cheaper.
"""

import math
from collections.abc import Mapping, Sequence

from studies.accuracy.design import UNMEASURED, Design, DesignStudy
from studies.accuracy.grid import ITERATIONS, NODES, PASSES
from studies.point import Value

_Family = frozenset[tuple[str, Value]]
_Members = dict[int, Design]  # by iterations
# What fewer iterations or passes would not change.
_WITHOUT = ("does not fit", "refused", "crashed", "timed out", UNMEASURED)


def refine(study: DesignStudy, designs: Sequence[Design], targets: Sequence[float]) -> list[Design]:
    """The designs, then those that were tried between them until no target can be had for less."""
    found = list(designs)
    while wanted := _wanted(found, targets):
        found += study.variants(wanted)
    return found


def fewer(designs: Sequence[Design], design: Design) -> Design | None:
    """The same with one iteration less, where it was tried."""
    return _families(designs).get(_family(design), {}).get(_iterations(design) - 1)


def _wanted(
    designs: Sequence[Design], targets: Sequence[float]
) -> list[tuple[Design, Mapping[str, Value]]]:
    families = _families(designs)
    wanted: dict[tuple[_Family, int, int], tuple[Design, Mapping[str, Value]]] = {}
    for target in targets:
        limit = min(
            (_time(d) for d in designs if d.usable and d.own_mesh and d.reaches(target)),
            default=math.inf,
        )
        for family, members in families.items():
            sample = next(iter(members.values()))
            passes = _passes(sample)
            trial = _iterations_between(members, target, limit)
            if trial is None:
                passes -= 1
                trial = _with_fewer_passes(families, members, target, limit)
            if trial is not None:
                changes: Mapping[str, Value] = {ITERATIONS: trial, PASSES: passes}
                wanted[family, trial, passes] = (sample, changes)
    return list(wanted.values())


def _iterations_between(members: _Members, target: float, limit: float) -> int | None:
    """Half-way between too few and enough; nothing where these are neighbours."""
    enough = [number for number, design in members.items() if design.reaches(target)]
    if not enough:
        return None
    high = min(enough)
    low = max((number for number in members if number < high), default=0)
    if high - low <= 1 or (low and _time(members[low]) >= limit):
        return None
    return (low + high) // 2


def _with_fewer_passes(
    families: Mapping[_Family, _Members], members: _Members, target: float, limit: float
) -> int | None:
    """Iterations with which one pass less may do, of a family whose own are settled: as many as
    that has, then twice as many, until they do or take longer than what is known."""
    passes = _passes(next(iter(members.values())))
    enough = [number for number, design in members.items() if design.reaches(target)]
    if passes <= 1 or not enough:
        return None
    lesser, single = (
        families.get(_family(next(iter(members.values())), passes=other), {})
        for other in (passes - 1, 0)
    )
    if any(design.reaches(target) for design in lesser.values()):
        return None
    # Neither fewer iterations than with the pass more, nor fewer than those that do not reach it.
    least = [_time(design) for number, design in single.items() if number <= min(enough)]
    least += [_time(design) for design in lesser.values()]
    trial = max([min(enough), *(2 * number for number in lesser)])
    if trial > max(members) or max(least, default=0.0) >= limit:
        return None
    return trial


def _families(designs: Sequence[Design]) -> dict[_Family, _Members]:
    """Designs of the scenario's mesh that differ in iterations alone, without those that no number
    of them helps."""
    families: dict[_Family, _Members] = {}
    for design in designs:
        if design.own_mesh:
            families.setdefault(_family(design), {})[_iterations(design)] = design
    return {
        family: members
        for family, members in families.items()
        if not any(design.state in _WITHOUT for design in members.values())
    }


def _family(design: Design, passes: int | None = None) -> _Family:
    columns = {
        key: value for key, value in design.columns.items() if key not in (ITERATIONS, NODES)
    }
    return frozenset((columns if passes is None else columns | {PASSES: passes}).items())


def _iterations(design: Design) -> int:
    return int(str(design.columns[ITERATIONS]))


def _passes(design: Design) -> int:
    return int(str(design.columns.get(PASSES) or 0))


def _time(design: Design) -> float:
    return math.inf if design.time_us is None else design.time_us
