"""A sweep: a scenario run with every value of a key, or of several, as a table and as a picture."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from studies.axis import Axis
from studies.budgets import budget_of, one_value
from studies.errors import InputError
from studies.metrics import FLAGS, MESSAGE, STATUS, columns_of, row_of
from studies.plot import Chart, Limit, Line, Panel, Place, spans_decades
from studies.point import Point, Value
from studies.program import Figure
from studies.record import Record
from studies.results import Column

WORST = "deadline.worst_us"
DEFAULT_METRICS = (WORST, "deadline.held", "accuracy.displacement_of_frame.p95", "force.largest.N")


@dataclass(frozen=True)
class Sweep:
    """What is asked for: a product of the axes, or with `zipped` their first values together,
    then their second ones."""

    scenario: Path
    axes: tuple[Axis, ...]
    zipped: bool = False
    overrides: tuple[str, ...] = ()
    includes: tuple[Path, ...] = ()

    def choices(self) -> list[tuple[int, ...]]:
        """For each run the number of the value that each axis has. Throws InputError."""
        lengths = [len(axis.texts) for axis in self.axes]
        if not self.zipped:
            return list(product(*(range(length) for length in lengths)))
        if len(set(lengths)) > 1:
            each = ", ".join(f"{axis.key} has {len(axis.texts)}" for axis in self.axes)
            raise InputError(f"--zip: expected as many values of each key; {each}")
        return [(number,) * len(self.axes) for number in range(lengths[0])]

    def points(self) -> list[Point]:
        """The runs, the last axis changing fastest."""
        return [
            Point(
                self.scenario,
                self.overrides
                + tuple(
                    f"{axis.key}={axis.texts[number]}"
                    for axis, number in zip(self.axes, choice, strict=True)
                ),
                {
                    axis.key: axis.values[number]
                    for axis, number in zip(self.axes, choice, strict=True)
                },
                includes=self.includes,
            )
            for choice in self.choices()
        ]


def all_refused(records: Sequence[Record]) -> str | None:
    """Why, in one line, where every point was refused. For the same reason, it is the first one's:
    the key is wrong then, and not one of its values."""
    if not records or any(record.status != "refused" for record in records):
        return None
    first = records[0].message
    reasons = {re.sub(r"(--set [^=]*)=.*?: ", r"\1: ", record.message) for record in records}
    if len(reasons) == 1:
        return first
    return f"each of {len(records)} points was refused, the first: {first}"


def measured(metrics: Sequence[str], records: Sequence[Record]) -> list[str]:
    """The figures that some run has."""
    return [
        name for name in metrics if any(record.metrics.get(name) is not None for record in records)
    ]


def table(
    sweep: Sweep, records: Sequence[Record], metrics: Sequence[str], known: dict[str, Figure]
) -> tuple[list[Column], list[dict[str, Value]]]:
    """Columns and rows: the axes, what became of the run, its figures."""
    columns = [
        *(Column(axis.key, "", "an axis of the sweep") for axis in sweep.axes),
        STATUS,
        *columns_of(metrics, known),
        FLAGS,
        MESSAGE,
    ]
    rows = [
        point.columns | row_of(record, metrics)
        for point, record in zip(sweep.points(), records, strict=True)
    ]
    return columns, rows


def chart(
    title: str,
    sweep: Sweep,
    records: Sequence[Record],
    metrics: Sequence[str],
    known: dict[str, Figure],
) -> Chart:
    """A panel a figure over the first axis; a line for each value of the others."""
    first, others = sweep.axes[0], () if sweep.zipped else sweep.axes[1:]
    places = first.places
    lines: dict[str, list[tuple[Place, Record]]] = {}
    for choice, record in zip(sweep.choices(), records, strict=True):
        name = ", ".join(
            str(axis.values[number]) for axis, number in zip(others, choice[1:], strict=False)
        )
        lines.setdefault(name, []).append((places[choice[0]], record))
    numbers = [place for place in places if isinstance(place, float)]
    return Chart(
        title,
        Column(first.key, first.unit).heading,
        [_panel(columns, lines) for columns in columns_of(numeric(metrics, records), known)],
        legend=", ".join(axis.key for axis in others),
        log_x=len(numbers) == len(places) and spans_decades(numbers),
        crosses=tuple(
            dict.fromkeys(place for line in lines.values() for place, r in line if not r.done)
        ),
        crosses_name="without a result",
    )


def numeric(metrics: Sequence[str], records: Sequence[Record]) -> list[str]:
    """What can be drawn: numbers, or at the least yes and no where nothing else is asked for."""

    def kinds(name: str) -> set[type]:
        return {type(value) for r in records if (value := r.metrics.get(name)) is not None}

    numbers = [name for name in metrics if kinds(name) and kinds(name) <= {int, float}]
    return numbers or [name for name in metrics if kinds(name) == {bool}]


def _panel(column: Column, lines: dict[str, list[tuple[Place, Record]]]) -> Panel:
    drawn = [
        Line(name, [x for x, _ in line], [_number(r.metrics.get(column.name)) for _, r in line])
        for name, line in lines.items()
    ]
    limits: list[Limit] = []
    if name := budget_of(column.name):
        every = [(x, r) for line in lines.values() for x, r in line if r.done]
        each = {x: _number(r.metrics.get(name)) for x, r in every}
        budget = one_value(r.metrics.get(name) for _, r in every)
        if budget is not None:
            limits = [Limit(budget, "budget")]
        elif set(each.values()) - {None}:
            drawn.append(Line("budget", list(each), list(each.values()), level=True))
    return Panel(
        column.heading, drawn, limits, log=spans_decades([y for line in drawn for y in line.y])
    )


def _number(value: Value) -> float | None:
    return float(value) if isinstance(value, int | float) else None
