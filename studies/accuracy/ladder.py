"""How far each fidelity level is from the finest one, and what it costs in wall-clock time."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.point import Point
from studies.program import Resolved
from studies.screening.answers import KEEP, Influence, influence, read_answers
from studies.screening.changes import Change, effort, fidelity_keys, has_table, with_needs
from studies.screening.timing import Cost, measure
from studies.session import Session


@dataclass(frozen=True)
class Rung:
    """A level of a part: what differs from the part's finest level that the scenario takes."""

    part: str
    level: str
    finest: bool
    message: str = ""
    influence: Influence | None = None
    cost: Cost | None = None


def ladders(
    session: Session,
    scenario: Path,
    overrides: tuple[str, ...],
    settings: Mapping[str, Any],
    repeats: int,
) -> list[Rung]:
    """Every part's levels, with the other parts as the scenario has them, the finest first.

    Effects of the scenario that one of the levels cannot have are left out at all of that part's.
    `settings` is the resolved scenario.
    """
    reference: Mapping[str, Any] = session.program.reference
    points: dict[tuple[str, str], Point] = {}
    without: dict[str, tuple[Change, ...]] = {}
    for key in fidelity_keys(reference):
        left = without[key["path"]] = _in_the_way(key, reference, settings)
        for level in sorted(key["choices"], key=effort, reverse=True):
            words = [text for change in left for text in change.overrides]
            setting = f"{key['path']}={level}"
            points[key["path"], level] = Point(scenario, (*overrides, *words, setting), keep=KEEP)
    records = dict(zip(points, session.run(list(points.values())), strict=True))
    costs = measure(
        session.program,
        {f"{k} {v}": points[k, v] for (k, v), record in records.items() if record.done},
        repeats,
    )
    rungs: list[Rung] = []
    finest: dict[str, str] = {}
    for (key_path, level), record in records.items():
        part = key_path.removeprefix("fidelity.")
        if not record.done:
            rungs.append(Rung(part, level, False, record.message))
            continue
        first = finest.setdefault(key_path, level)
        base = read_answers(session.store, records[key_path, first])
        run = read_answers(session.store, record)
        rungs.append(
            Rung(
                part,
                level,
                level == first,
                _without(without[key_path]),
                influence=influence(base, run),
                cost=costs.get(f"{key_path} {level}"),
            )
        )
    return rungs


def _in_the_way(
    key: Mapping[str, Any], reference: Mapping[str, Any], settings: Mapping[str, Any]
) -> tuple[Change, ...]:
    """The scenario's effects that some level of the part refuses, switched off."""
    present = [e["path"] for e in reference["effects"] if has_table(e["path"], settings)]
    left: dict[str, Change] = {}
    for level in key["choices"]:
        change = with_needs(Change("level", key["path"], level), reference, present, settings)
        left |= {other.key: other for other in change.along}
    return tuple(left.values())


def _without(left: Sequence[Change]) -> str:
    return f"without {', '.join(change.key for change in left)}" if left else ""


def resolved_settings(
    session: Session, scenario: Path, overrides: tuple[str, ...]
) -> Resolved | str:
    """The scenario as it would be run, or the line that refuses it."""
    (resolved,) = session.program.resolve(scenario, [overrides])
    return resolved if isinstance(resolved, Resolved) else resolved.message
