"""What a search has found, in words and as a table."""

from collections import Counter
from collections.abc import Mapping

from studies.metrics import FLAGS, MESSAGE, STATUS, columns_of, row_of
from studies.point import Value
from studies.program import Figure
from studies.results import Column
from studies.search import Found, Tried
from studies.search_space import Search
from studies.text_table import cell, count_of

_JUST_BELOW = 3
_MOST_REASONS = 3
WITHIN = Column("within", "", "every bound of the search holds")


def metrics(search: Search) -> list[str]:
    """The figures that the search looks at, objectives first."""
    names = [one.metric for one in search.objectives] + [one.metric for one in search.constraints]
    return [name for name in dict.fromkeys(names) if name != FLAGS.name]


def table(found: Found, known: Mapping[str, Figure]) -> tuple[list[Column], list[dict[str, Value]]]:
    """A row a point, in the order in which they were tried."""
    names = metrics(found.search)
    columns = [
        *(Column(one.key, "", "an axis of the search") for one in found.search.dimensions),
        WITHIN,
        STATUS,
        *columns_of(names, known),
        FLAGS,
        MESSAGE,
    ]
    rows = [
        found.search.point(tried.choice).columns
        | row_of(tried.record, names)
        | {name: tried.figures.get(name) for name in names}
        | {WITHIN.name: tried.feasible}
        for tried in found.tried.values()
    ]
    return columns, rows


def words(found: Found, known: Mapping[str, Figure]) -> str:
    """What was found, what was tried, and what stands just below."""
    lines = [found.search.title, ""]
    if found.best:
        lines += _block("found", [_point(found, one, known) for one in found.best])
    elif not any(one.record.done for one in found.tried.values()):
        lines += _block("found", ["nothing: no point was measured"])
        lines += _block("why", _reasons(found))
    else:
        nearest = min(found.tried.values(), key=lambda tried: tried.rank)
        lines += _block("found", ["nothing that keeps every bound"])
        lines += _block("nearest", [_point(found, nearest, known), f"but {_why(found, nearest)}"])
    lines += _block("bounds", [one.text for one in found.search.constraints] or ["none"])
    lines += _block("tried", _tried(found))
    if found.best:
        below = _just_below(found)
        text = [f"{_axes(found.search, one)}: {_why(found, one)}" for one in below]
        lines += _block("just below", text or ["nothing that was tried would be better"])
    return "\n".join(lines)


def plan(search: Search) -> str:
    """What would be tried, and how many points at most."""
    wanted = [f"{one.metric}, {one.direction}d" for one in search.objectives]
    axes = [
        f"{one.key}: {', '.join(cell(value) for value in one.values)}" for one in search.dimensions
    ]
    count = [f"all {search.combinations} combinations"]
    if search.combinations > search.trials:
        count = [
            f"{search.trials} proposals by {search.method} (seed {search.seed}), then the "
            "neighbours of the best until none is better:",
            f"at most the {search.combinations} combinations that there are",
        ]
    return "\n".join(
        [
            *(search.title, ""),
            *_block("wanted", wanted),
            *_block("bounds", [one.text for one in search.constraints] or ["none"]),
            *_block("axes", axes),
            *_block("tries", count),
        ]
    )


def _block(name: str, lines: list[str]) -> list[str]:
    return [f"  {name if number == 0 else '':<12}{line}" for number, line in enumerate(lines)]


def _axes(search: Search, tried: Tried) -> str:
    return ", ".join(
        f"{one.key} = {cell(one.values[number])}"
        for one, number in zip(search.dimensions, tried.choice, strict=True)
    )


def _point(found: Found, tried: Tried, known: Mapping[str, Figure]) -> str:
    figures = [
        f"{column.name} {cell(tried.figures.get(column.name))} {column.unit}".rstrip()
        for column in columns_of(metrics(found.search), known)
    ]
    return f"{_axes(found.search, tried)}: {', '.join(figures)}"


def _tried(found: Found) -> list[str]:
    tried = found.tried.values()
    ran = Counter(one.record.status for one in tried)
    kept = sum(one.feasible for one in tried)
    failed = sum(one.record.done and not one.feasible for one in tried)
    what = [f"{kept} keep every bound", f"{failed} do not"]
    what += [f"{ran[name]} {name}" for name in ("refused", "crashed", "timed out") if ran[name]]
    count = (
        f"{len(tried)} of {count_of(found.search.combinations, 'combination')}: {', '.join(what)}"
    )
    unmeasured = ran["crashed"] + ran["timed out"]
    if not found.proposals and unmeasured:
        return [count, f"that is all there are; of {unmeasured} nothing is known"]
    if not found.proposals:
        return [count, "that is all there are: nothing else can be better"]
    how = f"{found.proposals} proposals by {found.search.method} (seed {found.search.seed})"
    sure = "all there are" if found.complete else "no step on one axis from there is better"
    if not any(one.record.done for one in tried):
        sure = "nothing was measured there either"
    elif unmeasured:
        sure += f" of what was measured; of {unmeasured} nothing is known"
    return [count, f"{how}, then {count_of(found.steps, 'round')} of neighbours: {sure}"]


def _reasons(found: Found) -> list[str]:
    """Why points have no figures, each reason once, with how often."""
    reasons = Counter(
        f"{one.record.status}: {one.record.message}".rstrip(": ") for one in found.tried.values()
    )
    return [f"{count} {reason}" for reason, count in reasons.most_common(_MOST_REASONS)]


def _just_below(found: Found) -> list[Tried]:
    """What would be better and does not do: of each value of the objectives the nearest to it."""
    best = found.best[0]
    nearest: dict[tuple[float, ...], Tried] = {}
    for one in found.tried.values():
        better = one.objectives < best.objectives
        if one.feasible or not better:
            continue
        known = nearest.get(one.objectives)
        if known is None or one.rank < known.rank:
            nearest[one.objectives] = one
    return sorted(nearest.values(), key=lambda one: one.objectives, reverse=True)[:_JUST_BELOW]


def _why(found: Found, tried: Tried) -> str:
    if not tried.record.done:
        return f"{tried.record.status}: {tried.record.message}"
    reasons = []
    for one, violation in zip(found.search.constraints, tried.violations, strict=False):
        if violation > 0:
            value = tried.figures.get(one.metric)
            reasons.append(
                f"{one.metric} is {cell(value)}, not {one.text.removeprefix(one.metric).strip()}"
                if value is not None
                else f"{one.metric} was not measured"
            )
    return "; ".join(reasons) or "it lacks a figure that is asked for"
