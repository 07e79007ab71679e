"""Plots of a study's table: what plotly.js draws, with exactly the table's figures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

# Okabe and Ito's colours for colour-blind readers, without those that vanish on white or black.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f")
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "triangle-down", "pentagon", "star")
# Between two designs of a front there is none: what is reached is that of the faster one.
_STEPS = {"color": "ink", "width": 2, "dash": "dot", "shape": "hv"}
# More kinds than these are told apart by a scale, or not at all.
MOST_KINDS = 14
# Of a plot over names: of more, bars are too thin to tell apart.
MOST_BARS = 60


@dataclass(frozen=True)
class Plot:
    """Two columns against each other, a point a row.

    `colour` is a third column: numbers make a scale, words make a trace and a symbol each. `symbol`
    is a column of words that make a trace and a symbol each beside a `colour` of numbers. `budget`
    is a line at that y and `budget_x` one at that x. `front` are the positions (0, 1, …) of the
    rows that steps join in their order, the Pareto front, and `mark` the position of the
    scenario's own row. `line` joins the rows of each trace in their order. A row without x or y is
    counted below the plot: the table has it. Over names each row is a bar, where there are few and
    no name has two of a trace.
    """

    x: str
    y: str
    colour: str | None = None
    symbol: str | None = None
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


def figure(
    frame: pd.DataFrame, plot: Plot, units: dict[str, str], id_: str, every: int = 1
) -> dict[str, Any]:
    """A plot as plotly.js takes it: of its points one in `every`, with all that stand out."""
    apart = {plot.mark, *(plot.front or ())}
    rows = [row for row in shown(frame, plot) if row % every == 0 or row in apart]
    x, y = values(frame, plot.x), values(frame, plot.y)
    labels = _labels(frame)
    traces: list[dict[str, Any]] = []
    legend: list[dict[str, Any]] = []

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
    statuses = values(frame, "status") if "status" in frame.columns else ["held"] * len(x)
    kinds = values(frame, plot.symbol) if plot.symbol else [None] * len(x)
    known = {row: colours[row] for row in rows if colours[row] is not None}
    scale = plot.colour and known and not plot.line and all(map(is_number, known.values()))
    scale = scale and (plot.symbol is not None or len(set(known.values())) > len(COLOURS))
    if scale:
        for index, kind in enumerate(dict.fromkeys(kinds[row] for row in rows)):
            of = [row for row in rows if kinds[row] == kind]
            good = SYMBOLS[index % len(SYMBOLS)]
            marker = {
                "color": [colours[row] for row in of],
                "coloraxis": "coloraxis",
                "symbol": good if plot.symbol else _symbols([statuses[row] for row in of]),
                "size": 9,
                # One end of every scale is near the paper, light or dark.
                "line": {"width": 1, "color": "ink"},
            }
            label = _escaped(plot.y if plot.symbol is None else str(kind))
            traces.append(trace(of, marker=marker, name=label, legendgroup=label, showlegend=False))
            if plot.symbol is not None:
                legend.append(_legend_entry(label, good, index))
    else:
        groups = list(dict.fromkeys(colours[row] for row in rows))
        places = {(x[row], colours[row]) for row in rows}
        few = len(rows) <= MOST_BARS and len(places) == len(rows)
        bars = few and not plot.line and _axis_type(frame, plot.x) == "category"
        for index, kind in enumerate(groups):
            of = [row for row in rows if colours[row] == kind]
            marker = {
                "color": COLOURS[index % len(COLOURS)],
                "symbol": _symbols([statuses[row] for row in of], SYMBOLS[index % len(SYMBOLS)]),
                "size": 9,
            }
            label = _escaped(plot.y if plot.colour is None else f"{plot.colour} = {kind}")
            drawn = trace(of, marker=marker, name=label, showlegend=len(groups) > 1)
            if bars:
                drawn = _bars(drawn, [statuses[row] for row in of])
            elif plot.line:
                drawn["line"] = {"color": marker["color"]}
            traces.append(drawn)
    inside = set(rows)
    if plot.front is not None:
        of = [int(row) for row in plot.front if int(row) in inside]
        front = {"mode": "lines", "line": _STEPS}
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
    traces += legend
    layout = _layout(frame, plot, units)
    if scale:
        title = {"text": _escaped(name(plot.colour or "", units)), "side": "right"}
        layout["coloraxis"] = {"colorscale": "Viridis", "colorbar": {"title": title}}
    return {"id": id_, "data": traces, "layout": layout}


def _bars(trace: dict[str, Any], statuses: Sequence[Any]) -> dict[str, Any]:
    """A trace as bars. What did not hold is hatched."""
    hatches = ["" if str(status) == "held" else "/" for status in statuses]
    marker = {"color": trace["marker"]["color"], "pattern": {"shape": hatches}}
    kept = {key: value for key, value in trace.items() if key != "mode"}
    return kept | {"type": "bar", "textposition": "none", "marker": marker}


def _legend_entry(label: str, symbol: str, rank: int) -> dict[str, Any]:
    """The legend's line of a trace that a scale colours. plotly.js would draw that trace's own with
    the first number of its colours, which is no colour."""
    marker = {"symbol": symbol, "size": 9, "color": "ink"}
    entry = {"type": "scatter", "mode": "markers", "x": [None], "y": [None], "marker": marker}
    return entry | {"name": label, "legendgroup": label, "legendrank": rank, "hoverinfo": "skip"}


def _layout(frame: pd.DataFrame, plot: Plot, units: dict[str, str]) -> dict[str, Any]:
    def axis(column: str, log: bool) -> dict[str, Any]:
        return {
            "title": {"text": _escaped(name(column, units))},
            "type": "log" if log else _axis_type(frame, column),
            "automargin": True,
            "exponentformat": "e",  # not "10n" of what has a unit already, or none
            **({} if not log else _QUANTITY if units.get(column) else _RATIO),
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


# Ticks of logarithmic axes, whole and not as digits between powers: 200, 500; 1e-2.
_QUANTITY = {"tickformat": ",~f", "nticks": 5}
_RATIO = {"tickformat": "~e"}


def _axis_type(frame: pd.DataFrame, column: str) -> str:
    there = [value for value in values(frame, column) if value is not None]
    return "linear" if there and all(map(is_number, there)) else "category"


def _fits(value: Any, log: bool) -> bool:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return False
    return not log or (is_number(value) and value > 0)


def _symbols(statuses: Sequence[Any], good: str = "circle") -> str | list[str]:
    """A cross for what did not hold, whatever its colour: it is shown, and shown as such. One word
    where all are alike: of ten thousand points it is a tenth of the page."""
    kinds = {"held": good, "not held": f"{good}-open"}
    symbols = [kinds.get(str(status), "x") for status in statuses]
    return symbols[0] if len(set(symbols)) == 1 else symbols


def _labels(frame: pd.DataFrame) -> list[str]:
    """What hovering says of a row: its number, its flags, how it ended unless it held."""
    labels = [f"row {row + 1}" for row in range(len(frame))]
    for column in ("status", "flags", "message"):
        if column in frame.columns:
            for row, value in enumerate(values(frame, column)):
                if value not in (None, "", [], "held"):
                    labels[row] += f"<br>{_escaped(str(value))}"
    return labels


def _escaped(text: str) -> str:
    """plotly.js takes some HTML in its texts; words of a user are words."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
