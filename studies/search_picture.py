"""The picture of a search: every point that has figures, those that do, and the best of them."""

from studies.plot import Chart, Limit, Line, Panel, spans_decades
from studies.point import Value
from studies.program import Figure
from studies.results import Column
from studies.search import Found, Tried
from studies.search_text import metrics


def axes_of(found: Found) -> tuple[str, str] | None:
    """Two figures between which the choice is: two objectives, or the objective and the bound that
    comes last. None where no point has both."""
    tried = found.tried.values()
    names = [name for name in metrics(found.search) if any(_has(one, name) for one in tried)]
    second = 1 if len(found.search.objectives) > 1 else -1
    return (names[0], names[second]) if len(names) > 1 else None


def chart(found: Found, pair: tuple[str, str], known: dict[str, Figure]) -> Chart:
    """One figure over the other. The best points are joined in the order of the first."""
    x, y = pair
    drawn = [one for one in found.tried.values() if _has(one, x) and _has(one, y)]
    best = sorted(
        (one for one in found.best if one in drawn), key=lambda one: _number(one.figures[x])
    )
    lines = [
        _line("within the bounds", [one for one in drawn if one.feasible], pair),
        _line("outside", [one for one in drawn if not one.feasible], pair),
        _line("Pareto front" if len(found.search.objectives) > 1 else "found", best, pair, True),
    ]
    limits = [
        Limit(at, f"at {word} {at:g}")
        for one in found.search.constraints
        if one.metric == y
        for at, word in ((one.at_most, "most"), (one.at_least, "least"))
        if at is not None
    ]
    heading = {name: Column(name, known[name].unit).heading for name in pair}
    log_y = spans_decades([_number(one.figures[y]) for one in drawn])
    return Chart(
        found.search.title,
        heading[x],
        [Panel(heading[y], [line for line in lines if line.x], limits, log=log_y)],
        legend="points",
        log_x=spans_decades([_number(one.figures[x]) for one in drawn]),
    )


def _has(one: Tried, name: str) -> bool:
    return isinstance(one.figures.get(name), int | float)


def _line(name: str, points: list[Tried], pair: tuple[str, str], joined: bool = False) -> Line:
    x, y = pair
    return Line(
        name,
        [_number(one.figures[x]) for one in points],
        [_number(one.figures[y]) for one in points],
        joined,
    )


def _number(value: Value) -> float:
    assert isinstance(value, int | float)
    return float(value)
