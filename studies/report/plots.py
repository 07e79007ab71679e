"""Plots of a study's table: what plotly.js draws, with exactly the table's figures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

# Okabe and Ito's colours for colour-blind readers, without those that vanish on white or black.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "triangle-down", "pentagon", "star")
# More kinds than these are told apart by a scale, or not at all.
MOST_KINDS = 14


@dataclass(frozen=True)
class Plot:
    """Two columns against each other, a point a row.

    `colour` is a third column: numbers make a scale, words make a trace and a symbol each. `budget`
    is a line at that y and `budget_x` one at that x. `front` are the positions (0, 1, …) of the
    rows that a line joins in their order, the Pareto front, and `mark` the position of the
    scenario's own row. `line` joins the rows of each trace in their order. A row without x or y is
    counted below the plot: the table has it.
    """

    x: str
    y: str
    colour: str | None = None
    title: str = ""
    budget: float | None = None
    log_x: bool = False
    log_y: bool = False
    front: Sequence[int] | None = None
    mark: int | None = None
    budget_x: float | None = None
    line: bool = False
    help: str = ""


def is_number(value: Any) -> bool:
    """Finite, and no truth value: those are words in a plot."""
    return (
        not isinstance(value, bool)
        and hasattr(value, "__float__")
        and not isinstance(value, str)
        and math.isfinite(value)
    )


def values(frame: pd.DataFrame, column: str) -> list[Any]:
    """A column as JSON has it: nothing for what was not measured."""
    plain: list[Any] = frame[column].astype(object).tolist()
    return [None if value is None or value != value else value for value in plain]  # noqa: PLR0124


def name(column: str, units: dict[str, str]) -> str:
    """A column with its unit."""
    unit = units.get(column, "")
    return f"{column} / {unit}" if unit else column


def shown(frame: pd.DataFrame, plot: Plot) -> list[int]:
    """The positions of the rows that a plot can show."""
    return [
        row
        for row, (x, y) in enumerate(zip(values(frame, plot.x), values(frame, plot.y), strict=True))
        if _fits(x, plot.log_x) and _fits(y, plot.log_y)
    ]


def figure(frame: pd.DataFrame, plot: Plot, units: dict[str, str], id_: str) -> dict[str, Any]:
    """A plot as plotly.js takes it."""
    rows = shown(frame, plot)
    x, y = values(frame, plot.x), values(frame, plot.y)
    labels = _labels(frame)
    traces: list[dict[str, Any]] = []

    def trace(of: list[int], **more: Any) -> dict[str, Any]:
        return {
            "type": "scatter",
            "mode": "lines+markers" if plot.line else "markers",
            "x": [x[row] for row in of],
            "y": [y[row] for row in of],
            "text": [labels[row] for row in of],
            **more,
        }

    colours = values(frame, plot.colour) if plot.colour else [None] * len(x)
    known = {row: colours[row] for row in rows if colours[row] is not None}
    scale = plot.colour and known and not plot.line and all(map(is_number, known.values()))
    if scale and len(set(known.values())) > len(COLOURS):
        marker = {
            "color": [colours[row] for row in rows],
            "colorscale": "Viridis",
            "showscale": True,
            "colorbar": {"title": {"text": _escaped(name(plot.colour or "", units))}},
            "symbol": [_symbol(frame, row) for row in rows],
            "size": 9,
        }
        traces.append(trace(rows, marker=marker, name=_escaped(plot.y), showlegend=False))
    else:
        kinds = list(dict.fromkeys(colours[row] for row in rows))
        for index, kind in enumerate(kinds):
            of = [row for row in rows if colours[row] == kind]
            marker = {
                "color": COLOURS[index % len(COLOURS)],
                "symbol": [_symbol(frame, row, SYMBOLS[index % len(SYMBOLS)]) for row in of],
                "size": 9,
            }
            label = _escaped(plot.y if plot.colour is None else f"{plot.colour} = {kind}")
            traces.append(
                trace(of, marker=marker, name=label, showlegend=len(kinds) > 1)
                | ({"line": {"color": marker["color"]}} if plot.line else {})
            )
    inside = set(rows)
    if plot.front is not None:
        of = [int(row) for row in plot.front if int(row) in inside]
        front = {"mode": "lines", "line": {"color": "ink", "width": 2, "dash": "dot"}}
        traces.append(trace(of) | front | {"name": "Pareto front"})
    if plot.mark is not None and plot.mark in inside:
        ring = {
            "symbol": "circle-open",
            "size": 20,
            "color": "ink",
            "line": {"width": 3, "color": "ink"},
        }
        traces.append(
            trace([plot.mark], marker=ring) | {"mode": "markers", "name": "the scenario as it is"}
        )
    return {"id": id_, "data": traces, "layout": _layout(frame, plot, units)}


def _layout(frame: pd.DataFrame, plot: Plot, units: dict[str, str]) -> dict[str, Any]:
    def axis(column: str, log: bool) -> dict[str, Any]:
        return {
            "title": {"text": _escaped(name(column, units))},
            "type": "log" if log else _axis_type(frame, column),
            "automargin": True,
        }

    dashed = {"color": "bad", "width": 2, "dash": "dash"}
    lines: list[dict[str, Any]] = []
    notes: list[dict[str, Any]] = []
    if plot.budget is not None:
        at = {"y0": plot.budget, "y1": plot.budget, "yref": "y"}
        lines.append({"type": "line", "x0": 0, "x1": 1, "xref": "paper", "line": dashed} | at)
        y = math.log10(plot.budget) if plot.log_y and plot.budget > 0 else plot.budget
        notes.append({"xref": "paper", "x": 1, "y": y, "text": "budget", "yanchor": "bottom"})
    if plot.budget_x is not None:
        at = {"x0": plot.budget_x, "x1": plot.budget_x, "xref": "x"}
        lines.append({"type": "line", "y0": 0, "y1": 1, "yref": "paper", "line": dashed} | at)
        x = math.log10(plot.budget_x) if plot.log_x and plot.budget_x > 0 else plot.budget_x
        notes.append({"yref": "paper", "x": x, "y": 1, "text": "budget", "xanchor": "left"})
    return {
        "xaxis": axis(plot.x, plot.log_x),
        "yaxis": axis(plot.y, plot.log_y),
        "shapes": lines,
        "annotations": [note | {"showarrow": False, "font": {"color": "bad"}} for note in notes],
        "margin": {"l": 70, "r": 20, "t": 20, "b": 60},
        "hovermode": "closest",
    }


def _axis_type(frame: pd.DataFrame, column: str) -> str:
    there = [value for value in values(frame, column) if value is not None]
    return "linear" if there and all(map(is_number, there)) else "category"


def _fits(value: Any, log: bool) -> bool:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return False
    return not log or (is_number(value) and value > 0)


def _symbol(frame: pd.DataFrame, row: int, good: str = "circle") -> str:
    """A cross for what did not hold, whatever its colour: it is shown, and shown as such."""
    status = str(frame["status"].iloc[row]) if "status" in frame.columns else "held"
    return good if status == "held" else f"{good}-open" if status == "not held" else "x"


def _labels(frame: pd.DataFrame) -> list[str]:
    """What hovering says of a row: its number, how it ended and its flags."""
    labels = [f"row {row + 1}" for row in range(len(frame))]
    for column in ("status", "flags", "message"):
        if column in frame.columns:
            for row, value in enumerate(values(frame, column)):
                if value not in (None, "", []):
                    labels[row] += f"<br>{_escaped(str(value))}"
    return labels


def _escaped(text: str) -> str:
    """plotly.js takes some HTML in its texts; words of a user are words."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
