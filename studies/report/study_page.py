"""The report of a study: its answer in words, its plots, its table, how it was made."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.report.page import number, render
from studies.report.plots import Plot, figure, is_number, name, shown, values
from studies.whole_file import write_whole

__all__ = ["Plot", "write_study_report"]

# A browser takes a second or two for so many rows; results.csv has all of them.
MOST_ROWS = 2000
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
        figures.append(figure(frame, plot, units, id_))
        drawn.append(_shown(frame, plot, units, id_))
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
        rows=_rows(frame),
        rows_left_out=max(0, len(frame) - MOST_ROWS),
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
        for row in range(min(len(frame), MOST_ROWS))
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


def _shown(frame: pd.DataFrame, plot: Plot, units: dict[str, str], id_: str) -> _Shown:
    rows = set(shown(frame, plot))
    title = plot.title or f"{plot.y} over {plot.x}"
    alt = (
        f"{title}: {len(rows)} points, {name(plot.y, units)} over {name(plot.x, units)}"
        + (f", coloured by {name(plot.colour, units)}" if plot.colour else "")
        + ". The table below has the same figures."
    )
    return _Shown(id_, title, plot.help, alt, _left_out(frame, plot, rows))


def _left_out(frame: pd.DataFrame, plot: Plot, rows: set[int]) -> str:
    missing = [row for row in range(len(frame)) if row not in rows]
    if not missing:
        return ""
    status = values(frame, "status") if "status" in frame else ["without a value"] * len(frame)
    kinds = Counter(str(status[row]) for row in missing)
    how = ", ".join(f"{count} {kind}" for kind, count in sorted(kinds.items()))
    why = " that a logarithmic axis can show" if plot.log_x or plot.log_y else ""
    return (
        f"{len(missing)} of {len(frame)} rows have no point{why} here ({how}); the table has them."
    )


def _counts(frame: pd.DataFrame) -> str:
    if "status" not in frame:
        return f"{len(frame)} rows"
    kinds = Counter(map(str, frame["status"]))
    return f"{len(frame)} rows: " + ", ".join(f"{n} {kind}" for kind, n in sorted(kinds.items()))


def _numeric(column: list[Any]) -> bool:
    there = [value for value in column if value is not None]
    return bool(there) and all(map(is_number, there))
