"""The first question of all: who should solve."""

from collections.abc import Sequence
from dataclasses import replace

from studies.plot import Chart, Limit, Panel
from studies.questions.answer import Answer, Row, line, number, where

LOAD = "load.worst_us"
WORST = "deadline.worst_us"
FORCE = "accuracy.force_of_frame.p95"
DISPLACEMENT = "accuracy.displacement_of_frame.p95"
_PERIOD_MS = 2.0
_EXACT = 1e-9
_NOW = "desktop-2026"
_THEN = "thesis-pc"


def solvers(rows: Sequence[Row]) -> Answer:
    """Whether a core beats the board, in the first line."""
    heading = ["solver", "host", "force after, ms", "work of a period, ms", "held",
               "force error", "displacement error", "memory, MB", "set-up, ms"]  # fmt: skip
    table = [_cells(row) for row in rows]
    ran = [row for row in rows if row[LOAD] is not None]
    for row in ran:
        row["load_ms"] = row[LOAD] / 1000
    chart = Chart(
        "Work of the worst period by who solves",
        "solver",
        [
            Panel(
                "ms",
                [
                    replace(line(host, where(ran, host=host), "solver", "load_ms"), joined=False)
                    for host in (_THEN, _NOW)
                ],
                [Limit(_PERIOD_MS, "500 Hz")],
                log=True,
            )
        ],
        legend="host",
    )
    then = _least_exact(where(ran, host=_THEN))
    facts = {
        "verdict": verdict(rows),
        "then_core": _ms(then[LOAD]),
        "then_name": str(then["solver"]),
        "then_board": _ms(where(ran, host=_THEN, solver="board")[0][LOAD]),
    }
    return Answer(heading, table, chart, facts)


def verdict(rows: Sequence[Row]) -> str:
    """Of today's host, from the rows."""
    today = [row for row in where(rows, host=_NOW) if row[LOAD] is not None]
    core = _least_exact(today)
    board = where(today, solver="board")[0]
    first = "A core beats the board" if core[LOAD] < board[LOAD] else "The board beats a core"
    return (
        f"{first}: a period's work takes a core of today {_ms(core[LOAD])} ms, exact in double "
        f"precision ({core['solver']}), and with the board {_ms(board[LOAD])} ms with a force that "
        f"is {100 * board[FORCE]:.2g} % off."
    )


def _least_exact(rows: Sequence[Row]) -> Row:
    exact = [
        row
        for row in rows
        if not str(row["solver"]).startswith("board") and (row[DISPLACEMENT] or 0.0) < _EXACT
    ]
    return min(exact, key=lambda row: float(row[LOAD]))


def _cells(row: Row) -> list[str]:
    memory = row["host_solve.memory_bytes"]
    ran = row[LOAD] is not None
    held = "yes" if row["status"] == "held" else row["status"]
    return [
        str(row["solver"]),
        str(row["host"]),
        _ms(row[WORST]),
        _ms(row[LOAD]),
        held,
        number(row[FORCE], ".2g"),
        number(row[DISPLACEMENT], ".2g"),
        number(memory / 1e6 if memory else None, ".3g"),
        number(row["set_up_us"] / 1000 if ran else None, ".3g"),
    ]


def _ms(microseconds: float | None) -> str:
    return number(microseconds / 1000 if microseconds is not None else None, ".3g")
