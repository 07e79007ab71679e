"""Who should solve where the matrix changes: nodes by renewals by what a late host leaves."""

from collections.abc import Sequence

from studies.plot import Chart, Limit, Panel
from studies.questions.answer import Answer, Row, line, number, values, where

LOAD = "load.worst_us"
EVERY = "renewed every"
_PERIOD_US = 2000.0
_BOARD = "board"
_TAILS_US = (0, 100, 300, 1000)


def renewals(rows: Sequence[Row]) -> Answer:
    """The map, and who holds most of it."""
    solvers = values(rows, "who")
    places = _places(rows)
    table = [
        [
            str(nodes),
            _named(every),
            *(_cell(row) for row in where(rows, nodes=nodes, **{EVERY: every})),
        ]
        for nodes, every in places
    ]
    panels = [
        Panel(
            f"ms, {nodes} nodes",
            [line(who, [_drawn(row) for row in where(rows, nodes=nodes, who=who)], "x", "y")
             for who in solvers],
            [Limit(_PERIOD_US / 1000, "500 Hz")],
            log=True,
        )
        for nodes in values(rows, "nodes")
    ]  # fmt: skip
    most = max(values(rows, "nodes"))
    facts = {
        "verdict": verdict(rows),
        "tangents": number(_tangents_us(where(rows, nodes=most)) / 1000, ".2g"),
        "most": str(most),
        "cells": str(len(places)),
        "least": least_work(rows),
        "without_gpu": without_gpu(rows),
        "tails": "\n".join(_tails(rows)),
    }
    return Answer(
        ["nodes", EVERY, *solvers],
        table,
        Chart(
            "Work of the worst period", "frames from one renewal to the next", panels, "who solves"
        ),
        facts,
    )


def verdict(rows: Sequence[Row]) -> str:
    """Where a board alone holds, and where nobody needs one."""
    places = _places(rows)
    alone, without, nobody = 0, 0, 0
    for nodes, every in places:
        holding = [row for row in where(rows, nodes=nodes, **{EVERY: every}) if _held(row)]
        boards = [row for row in holding if _on_board(row)]
        nobody += not holding
        alone += bool(boards) and len(boards) == len(holding)
        without += len(boards) < len(holding)
    first = (
        f"A board alone holds 500 Hz in {alone} of {len(places)} places of the map"
        if alone
        else "Nowhere on the map does a board alone hold 500 Hz"
    )
    return (
        f"{first}: without one they are held in {without} of {len(places)} places, in {nobody} by "
        f"nobody; {_best(rows)}."
    )


def _best(rows: Sequence[Row]) -> str:
    """The one that holds most places, and how many the best board does."""
    held = {who: _count(where(rows, who=who)) for who in values(rows, "who")}
    best = max(held, key=lambda who: held[who])
    board = max((who for who in held if who.startswith(_BOARD)), key=lambda who: held[who])
    return f'"{best}" holds {held[best]}, "{board}" {held[board]}'


def least_work(rows: Sequence[Row]) -> str:
    """Of each kind, in how many places it has the least work of all that hold."""
    counts: dict[str, int] = {"a board": 0, "a core": 0, "a GPU": 0}
    for nodes, every in _places(rows):
        holding = [row for row in where(rows, nodes=nodes, **{EVERY: every}) if _held(row)]
        if holding:
            best = str(min(holding, key=lambda row: float(row[LOAD]))["who"])
            counts[f"a {best.partition(',')[0].split()[0]}"] += 1
    return ", ".join(f"{kind} in {count}" for kind, count in counts.items())


def without_gpu(rows: Sequence[Row]) -> str:
    """The places that nobody holds where there is no GPU."""
    cores = [row for row in rows if not str(row["who"]).startswith("GPU")]
    held = {(row["nodes"], row[EVERY]) for row in cores if _held(row)}
    return str(len(_places(rows)) - len(held))


def _tails(rows: Sequence[Row]) -> list[str]:
    solvers = values(rows, "who")
    lines = [f"| to spare, us | {' | '.join(solvers)} |", f"| --- |{' --- |' * len(solvers)}"]
    for tail in _TAILS_US:
        counts = [str(_count(where(rows, who=who), tail)) for who in solvers]
        lines.append(f"| {tail} | {' | '.join(counts)} |")
    return lines


def _tangents_us(rows: Sequence[Row]) -> float:
    """What a renewal takes of a solver that makes nothing anew."""
    cg = where(rows, who="core, cg")
    never, always = (where(cg, **{EVERY: every})[0][LOAD] for every in (0, 50))
    return float(always - never)


def _places(rows: Sequence[Row]) -> list[tuple[int, int]]:
    return [(nodes, every) for nodes in values(rows, "nodes") for every in values(rows, EVERY)]


def _count(rows: Sequence[Row], tail_us: float = 0) -> int:
    return sum(_held(row) and row[LOAD] + tail_us <= _PERIOD_US for row in rows)


def _held(row: Row) -> bool:
    return str(row["status"]).startswith("held")


def _on_board(row: Row) -> bool:
    return str(row["who"]).startswith(_BOARD)


def _named(every: int) -> str:
    return str(every) if every else "never"


def _drawn(row: Row) -> Row:
    return {"x": _named(row[EVERY]), "y": row[LOAD] / 1000}


def _cell(row: Row) -> str:
    return number(row[LOAD] / 1000, ".3g") + ("" if _held(row) else " late")
