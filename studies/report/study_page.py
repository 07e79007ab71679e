"""The report of a study: its answer in words, its plots, its table, how it was made."""

import math
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.report.page import number, render
from studies.report.plots import Plot, figure, is_number, name, shown, values
from studies.text_table import count_of
from studies.whole_file import write_whole

__all__ = ["Plot", "write_study_report"]

# A browser takes a second or two for so many cells, and a page of 5 MB has room for them beside
# plotly.js and the points; results.csv has all.
MOST_ROWS = 2000
MOST_CELLS = 20_000
MOST_DRAWN = 30_000  # points, of all plots together
# Rows that have no figures, only a message.
FAILED = ("refused", "crashed", "timed out")


@dataclass(frozen=True)
class _Shown:
    """A plot beside its words."""

    id: str
    title: str
    help: str
    alt: str
    left_out: str


def write_study_report(  # noqa: PLR0913
    folder: Path,
    *,
    title: str,
    frame: pd.DataFrame,
    units: dict[str, str],
    helps: dict[str, str],
    plots: list[Plot],
    words: list[str],
    commands: list[str],
    versions: dict[str, str],
) -> Path:
    """Write folder/report.html: one file, the same bytes for the same arguments.

    `frame` has a row a point; its columns `status` and `message`, where there, say how a row ended.
    `units` and `helps` are of columns; `words` are paragraphs above the plots, the answer first;
    `commands` repeat what was done. Numbers are embedded as they are, so that a plot has the CSV's.
    """
    figures: list[dict[str, Any]] = []
    drawn: list[_Shown] = []
    for index, plot in enumerate(plots, start=1):
        id_ = f"plot-{index}"
        every = math.ceil(len(frame) * len(plots) / MOST_DRAWN) or 1
        figures.append(figure(frame, plot, units, id_, every))
        drawn.append(_shown(frame, plot, units, id_, every))
    table_rows = min(len(frame), MOST_ROWS, max(MOST_CELLS // max(len(frame.columns), 1), 1))
    columns = [
        {
            "name": name(str(column), units),
            "help": helps.get(str(column), ""),
            "number": _numeric(values(frame, str(column))),
        }
        for column in frame.columns
    ]
    statuses = sorted({str(value) for value in frame["status"]}) if "status" in frame else []
    page = render(
        "study.html",
        {"figures": figures},
        kind="Study",
        title=title,
        sections=[("answer", "Answer")]
        + ([("plots", "Plots")] if plots else [])
        + [("table", "Table"), ("versions", "Commands and versions")],
        words=words,
        plots=drawn,
        columns=columns,
        rows=_rows(frame.head(table_rows)),
        rows_left_out=len(frame) - table_rows,
        statuses=statuses,
        counts=_counts(frame),
        commands=commands,
        versions=versions,
    )
    folder.mkdir(parents=True, exist_ok=True)
    return write_whole(folder / "report.html", page)


def _rows(frame: pd.DataFrame) -> list[dict[str, Any]]:
    columns = [values(frame, str(column)) for column in frame.columns]
    status = values(frame, "status") if "status" in frame else [""] * len(frame)
    return [
        {
            "status": status[row],
            "failed": status[row] in FAILED,
            "cells": [
                {"text": _text(column[row]), "exact": _exact(column[row])} for column in columns
            ],
        }
        for row in range(len(frame))
    ]


def _text(value: Any) -> str:
    if isinstance(value, list | tuple):
        return " ".join(map(str, value))
    return "" if value is None else number(value)


def _exact(value: Any) -> str | None:
    """All digits of what is shown with fewer: it is sorted by them."""
    if isinstance(value, float) and number(value) != repr(value):
        return repr(value)
    return None


def _shown(frame: pd.DataFrame, plot: Plot, units: dict[str, str], id_: str, every: int) -> _Shown:
    rows = set(shown(frame, plot))
    title = plot.title or f"{plot.y} over {plot.x}"
    alt = (
        f"{title}: {count_of(len(rows), 'point')}, {name(plot.y, units)} over {name(plot.x, units)}"
        + (f", coloured by {name(plot.colour, units)}" if plot.colour else "")
        + ". The table below has the same figures."
    )
    left_out = _left_out(frame, plot, rows)
    if every > 1:
        left_out += f" One point in {every} is drawn; results.csv has all {len(rows)}."
    return _Shown(id_, title, plot.help, alt, left_out.strip())


def _left_out(frame: pd.DataFrame, plot: Plot, rows: set[int]) -> str:
    missing = [row for row in range(len(frame)) if row not in rows]
    if not missing:
        return ""
    status = values(frame, "status") if "status" in frame else ["without a value"] * len(frame)
    x, y = values(frame, plot.x), values(frame, plot.y)
    # Only a figure that is there can be one that a logarithm has no place for.
    kinds = Counter(
        str(status[row])
        if x[row] is None or y[row] is None
        else f"{status[row]}, not more than 0 on a logarithmic axis"
        for row in missing
    )
    how = "; ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    return f"{len(missing)} of {len(frame)} rows have no point here ({how}); the table has them."


def _counts(frame: pd.DataFrame) -> str:
    if "status" not in frame:
        return f"{len(frame)} rows"
    kinds = Counter(map(str, frame["status"]))
    return f"{len(frame)} rows: " + ", ".join(f"{n} {kind}" for kind, n in sorted(kinds.items()))


def _numeric(column: list[Any]) -> bool:
    there = [value for value in column if value is not None]
    return bool(there) and all(map(is_number, there))
