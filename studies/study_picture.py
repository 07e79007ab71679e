"""The picture of a study: its figures over an axis, a line for each value of another one."""

from collections.abc import Mapping, Sequence

from studies.axis import places
from studies.budgets import budget_of, one_value
from studies.plot import Chart, Limit, Line, Panel, Place, spans_decades
from studies.point import Value
from studies.results import Column
from studies.study_file import Picture

_DONE = ("held", "not held")
_MOST_LINES = 40  # of more, nobody tells one from another


def chart(
    title: str,
    picture: Picture,
    metrics: Sequence[str],
    cells: Mapping[str, Sequence[Value]],
    units: Mapping[str, str],
) -> Chart:
    """A panel a figure. `cells` has a study's columns; points without figures are crosses."""
    x, unit = places(cells[picture.x])
    done = [status in _DONE for status in cells["status"]]
    groups: dict[str, list[int]] = {}
    for row in range(len(x)):
        if done[row]:
            kind = cells[picture.colour][row] if picture.colour else None
            groups.setdefault("" if kind is None else str(kind), []).append(row)
    joined = len(groups) <= _MOST_LINES
    if not joined:
        groups = {f"{len(groups)} values": [row for rows in groups.values() for row in rows]}
    panels = []
    for metric in metrics:
        y = [_number(value) for value in cells[metric]]
        lines = [
            Line(group, [x[row] for row in rows], [y[row] for row in rows], joined)
            for group, rows in groups.items()
        ]
        log = spans_decades([y[row] for row in range(len(x)) if done[row]])
        budget = one_value(cells.get(budget_of(metric) or "", ()))
        limits = [Limit(budget, "budget")] if budget is not None else []
        panels.append(Panel(Column(metric, units.get(metric, "")).heading, lines, limits, log))
    numbers = [place for place in x if not isinstance(place, str)]
    crosses: list[Place] = [place for place, has in zip(x, done, strict=True) if not has]
    return Chart(
        title or picture.x,
        Column(picture.x, unit).heading,
        panels,
        legend=picture.colour,
        log_x=len(numbers) == len(x) and spans_decades(numbers),
        crosses=tuple(dict.fromkeys(crosses)),
        crosses_name="no figures",
    )


def _number(value: Value) -> float | None:
    return float(value) if isinstance(value, int | float) else None
