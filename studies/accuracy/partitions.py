"""The number of partitions with which a set of settings is fastest on the scenario's device."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.point import Point
from studies.record import Record
from studies.session import Session

KEY = "accelerator.partitions"
_FIRST = 8  # partitions that are tried of every set
_LAST_QUARTER = 3 / 4


@dataclass(frozen=True)
class Choice:
    """What 1 to `tried` partitions came to: the number that solves in the fewest clocks of those
    that the device holds with its clock reached, or none."""

    best: int | None
    tried: int
    clocks: tuple[int, int] | None = None  # of an iteration and of the set-up, with the best


def fastest(
    session: Session, scenario: Path, settings: Sequence[tuple[str, ...]], own: int
) -> list[Choice]:
    """Of each list of overrides, by the closed forms of `hvp device`: nothing is run.

    1 to 8 partitions (to `own`, the scenario's, where that is more), then twice as many for as long
    as one of the last quarter is the fastest: clocks fall until the vector unit is what is waited
    for, and needs grow, though not of each memory. Of equally fast numbers the smallest. An
    iteration and the set-up before the first hold the same product, so that the order is that of a
    whole solve, of however many iterations.
    """
    most = _most(session.program.reference)
    best: dict[int, tuple[int, int, int]] = {}
    tried = dict.fromkeys(range(len(settings)), 0)
    going = list(tried)
    first, last = 1, min(most, max(_FIRST, own))
    while going:
        numbers = range(first, last + 1)
        asked = [(index, number) for index in going for number in numbers]
        points = [
            Point(scenario, (*settings[index], f"{KEY}={number}"), command="device")
            for index, number in asked
        ]
        for (index, number), record in zip(asked, session.run(points), strict=True):
            clocks = _clocks(record)
            if clocks is not None and (*clocks, number) < best.get(index, (*clocks, most + 1)):
                best[index] = (*clocks, number)
        tried |= dict.fromkeys(going, last)
        going = [
            index
            for index in going
            if last < most and index in best and best[index][2] > _LAST_QUARTER * last
        ]
        first, last = last + 1, min(most, 2 * last)
    return [
        Choice(best[index][2], tried[index], best[index][:2])
        if index in best
        else Choice(None, tried[index])
        for index in range(len(settings))
    ]


def _clocks(record: Record) -> tuple[int, int] | None:
    """Of an iteration and of the set-up; nothing for what the device does not hold."""
    if record.status != "held":
        return None
    figures = record.metrics
    return int(figures["cycles.iteration"] or 0), int(figures["cycles.setup"] or 0)


def _most(reference: Mapping[str, Any]) -> int:
    """By the key's declared range."""
    (key,) = (key for key in reference["keys"] if key["path"] == KEY)
    return int(key["range"]["max"])
