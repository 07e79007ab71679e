"""How far each fidelity level is from the finest one, and what it costs in wall-clock time."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.point import Point
from studies.program import Resolved
from studies.screening.answers import KEEP, Influence, influence, read_answers
from studies.screening.changes import effort, fidelity_keys
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
    session: Session, scenario: Path, overrides: tuple[str, ...], repeats: int
) -> list[Rung]:
    """Every part's levels, with the other parts as the scenario has them, the finest first."""
    reference: Mapping[str, Any] = session.program.reference
    points: dict[tuple[str, str], Point] = {}
    for key in fidelity_keys(reference):
        for level in sorted(key["choices"], key=effort, reverse=True):
            setting = f"{key['path']}={level}"
            points[key["path"], level] = Point(scenario, (*overrides, setting), keep=KEEP)
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
                influence=influence(base, run),
                cost=costs.get(f"{key_path} {level}"),
            )
        )
    return rungs


def resolved_settings(
    session: Session, scenario: Path, overrides: tuple[str, ...]
) -> Resolved | str:
    """The scenario as it would be run, or the line that refuses it."""
    (resolved,) = session.program.resolve(scenario, [overrides])
    return resolved if isinstance(resolved, Resolved) else resolved.message
