"""Pictures of tables: the one place that draws with matplotlib."""

import io
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator, ScalarFormatter

from studies.whole_file import write_whole

# Okabe and Ito's colours: told apart with any kind of colour vision. Black is left for limits.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7F7F7F")
_MARKERS = "osD^vP*X"
_DASHES = ("-", "--", "-.", ":")
_HATCHES = ("", "//", "..", "xx")
_WIDTH_IN = 7.5
_PANEL_IN = 2.6
_DPI = 110
_FEW_TICKS = 12
_TICKS_APART = 0.05  # of the axis: a label of four digits
_MOST_TICKS = 60
_MANY_DECADES = 10.0
_MOST_BARS = 60  # of a panel
_GROUP = 0.8  # of the room of a name

Place = float | str


@dataclass(frozen=True)
class Line:
    """What is drawn in one colour. A y that is None is a gap; `joined` draws the line between.
    `level`: what the others are held against, at each place."""

    name: str
    x: Sequence[Place]
    y: Sequence[float | None]
    joined: bool = True
    level: bool = False


@dataclass(frozen=True)
class Limit:
    """A level that something is held against, with its name."""

    at: float
    name: str


@dataclass(frozen=True)
class Panel:
    """One quantity over the common x axis."""

    label: str
    lines: Sequence[Line]
    limits: Sequence[Limit] = ()
    log: bool = False


@dataclass(frozen=True)
class Chart:
    """Panels above each other. `crosses` are places on the x axis with nothing to be drawn. Places
    that are names are choices: each has a bar a line, as long as bars can be told apart."""

    title: str
    x_label: str
    panels: Sequence[Panel]
    legend: str = ""  # what tells the lines apart
    log_x: bool = False
    crosses: Sequence[Place] = field(default_factory=tuple)
    crosses_name: str = "refused"


def draw_chart(path: Path, chart: Chart) -> None:
    """Draw as PNG, PDF or SVG, by the file's suffix. Equal charts give equal bytes."""
    style: Any = {  # the stubs name every key there is
        "font.size": 9,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#E4E4E4",
        "axes.axisbelow": True,
        "figure.facecolor": "white",
        "svg.hashsalt": "hvp",
    }
    with mpl.rc_context(style):
        size = (_WIDTH_IN, 0.9 + _PANEL_IN * len(chart.panels))
        figure = Figure(figsize=size, dpi=_DPI, layout="constrained")
        axes = list(figure.subplots(len(chart.panels), 1, sharex=True, squeeze=False)[:, 0])
        figure.suptitle(chart.title, x=0.01, ha="left", fontsize=10, fontweight="bold")
        names = _names(chart)
        for axis, panel in zip(axes, chart.panels, strict=True):
            _draw_panel(axis, panel, chart, names)
        _x_axis(axes[-1], chart, names)
        handles, labels = axes[0].get_legend_handles_labels()
        if any(label for label in labels):
            figure.legend(handles, labels, title=chart.legend or None, loc="outside right upper")
        data = io.BytesIO()
        kind = path.suffix.lstrip(".").lower() or "png"
        dates = {"png": "Software", "pdf": "CreationDate", "svg": "Date"}
        metadata = {dates[kind]: None} if kind in dates else None
        figure.savefig(data, format=kind, metadata=metadata)
    write_whole(path, data.getvalue())


def drawable(path: Path) -> bool:
    """Whether draw_chart() knows the suffix."""
    return path.suffix.lower() in (".png", ".pdf", ".svg")


def spans_decades(values: Sequence[float | None]) -> bool:
    """Whether a logarithmic axis shows more: all positive, the largest far above the smallest."""
    known = [value for value in values if value is not None]
    return bool(known) and min(known) > 0 and max(known) > _MANY_DECADES * min(known)


def _names(chart: Chart) -> dict[Place, float] | None:
    """Where the x axis' places stand where they are names; None where they are numbers."""
    places: list[Place] = [x for panel in chart.panels for line in panel.lines for x in line.x]
    places += chart.crosses
    if all(not isinstance(place, str) for place in places):
        return None
    return {place: float(at) for at, place in enumerate(dict.fromkeys(places))}


def _at(place: Place, names: dict[Place, float] | None) -> float:
    return names[place] if names is not None else float(place)


def _has_bars(panel: Panel, names: dict[Place, float] | None) -> bool:
    """Whether every line has one value a name, and there are few."""
    lines = [line for line in panel.lines if not line.level]
    return (
        names is not None
        and len(names) * len(lines) <= _MOST_BARS
        and all(len(set(line.x)) == len(line.x) for line in lines)
    )


def _draw_bars(axis: Axes, panel: Panel, names: dict[Place, float]) -> None:
    lines = [line for line in panel.lines if not line.level]
    width = _GROUP / max(len(lines), 1)
    for number, line in enumerate(lines):
        shift = (number - (len(lines) - 1) / 2) * width
        there = [(x, float(y)) for x, y in zip(line.x, line.y, strict=True) if y is not None]
        axis.bar(
            [names[x] + shift for x, _ in there],
            [y for _, y in there],
            width,
            label=line.name,
            color=COLOURS[number % len(COLOURS)],
            hatch=_HATCHES[number // len(COLOURS) % len(_HATCHES)],
            edgecolor="white",
            linewidth=0.5,
        )
    if panel.log:
        known = [float(y) for line in panel.lines for y in line.y if y]
        axis.set_yscale("log")
        axis.set_ylim(bottom=min(known) / 2)


def _draw_panel(axis: Axes, panel: Panel, chart: Chart, names: dict[Place, float] | None) -> None:
    bars = names is not None and _has_bars(panel, names)
    if names is not None and bars:
        _draw_bars(axis, panel, names)
    for number, line in enumerate(panel.lines):
        if bars and not line.level:
            continue
        y = [math.nan if value is None else float(value) for value in line.y]
        axis.plot(
            [_at(x, names) for x in line.x],
            y,
            label=line.name,
            color=COLOURS[number % len(COLOURS)],
            marker=_MARKERS[number % len(_MARKERS)],
            markersize=4.5,
            linewidth=1.5,
            # Colours run out: then the dashes tell lines apart.
            linestyle=_DASHES[number // len(COLOURS) % len(_DASHES)] if line.joined else "none",
        )
    if panel.log:
        axis.set_yscale("log")
    for limit in panel.limits:
        axis.axhline(limit.at, color="black", linewidth=1, linestyle=(0, (5, 3)))
        axis.annotate(
            limit.name,
            (1.0, limit.at),
            xycoords=("axes fraction", "data"),
            xytext=(-2, 2),
            textcoords="offset points",
            ha="right",
            va="bottom",
        )
    if chart.crosses:
        axis.plot(
            [_at(place, names) for place in chart.crosses],
            [0.0] * len(chart.crosses),
            transform=axis.get_xaxis_transform(),
            color="black",
            marker="x",
            linestyle="none",
            clip_on=False,
            zorder=5,
            label=chart.crosses_name,
        )
    axis.set_ylabel(panel.label)
    axis.margins(y=0.12)
    if not panel.log:
        axis.ticklabel_format(axis="y", useOffset=False)


def _apart(places: list[float], log: bool) -> list[float]:
    """Those of these, in ascending order, whose labels leave each other room."""
    at = [math.log(place) if log else place for place in places]
    kept: list[int] = []
    for i in range(len(places)):
        if not kept or at[i] - at[kept[-1]] >= _TICKS_APART * (at[-1] - at[0]):
            kept.append(i)
    return [places[i] for i in kept]


def _x_axis(axis: Axes, chart: Chart, names: dict[Place, float] | None) -> None:
    axis.set_xlabel(chart.x_label)
    if names is not None:
        # Of more than can be read, some: a tick costs milliseconds, each time it is laid out.
        ticks = list(names.items())[:: math.ceil(len(names) / _MOST_TICKS)]
        long = sum(len(str(name)) for name, _ in ticks) > _FEW_TICKS * 6
        axis.set_xticks([at for _, at in ticks], [str(name) for name, _ in ticks])
        axis.tick_params(axis="x", rotation=30 if long else 0)
        return
    if chart.log_x:
        axis.set_xscale("log")
    places = sorted({x for panel in chart.panels for line in panel.lines for x in line.x})
    if len(places) <= _FEW_TICKS:  # the values themselves, not what is round beside them
        axis.set_xticks(_apart([float(place) for place in places], chart.log_x))
        if chart.log_x:
            axis.xaxis.set_minor_locator(NullLocator())
            axis.xaxis.set_minor_formatter(NullFormatter())
            axis.xaxis.set_major_formatter(ScalarFormatter())
