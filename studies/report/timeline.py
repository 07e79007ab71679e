"""The plots of a run's times: every frame against its budget, the worst one's spans, the sums."""

from typing import Any

from studies.errors import InputError
from studies.report.plots import COLOURS, values
from studies.run_folder import RunFolder, Span

# A part has one colour in every plot.
PARTS = {"fpga": 0, "bus": 1, "host": 2, "daq": 3, "device": 4}
# More points than these are slow to draw: of each group of frames the slowest is shown.
MOST_FRAMES = 20_000
_MARGIN = {"l": 70, "r": 20, "t": 20, "b": 60}


def colour(part: str) -> str:
    """Of a part."""
    return COLOURS[PARTS.get(part, 5)]


def frames(run: RunFolder) -> tuple[dict[str, Any], int]:
    """Latency over frames, missed ones apart, and how many frames a point stands for."""
    table = run.frames
    if table is None:
        raise InputError(f"{run.path / 'frames.csv'}: expected a file of a run; there is none")
    try:
        number = [int(value) for value in table["frame"]]
        in_time = [int(value) == 1 for value in table["in_time"]]
    except (KeyError, ValueError) as error:
        raise InputError(f"{run.path / 'frames.csv'}: damaged: {error}") from None
    latency = values(table, "latency_us")
    force = values(table, "force_N") if "force_N" in table else []
    group = -(-len(number) // MOST_FRAMES) if number else 1
    kept = [
        max(range(at, min(at + group, len(number))), key=lambda row: latency[row] or 0.0)
        for at in range(0, len(number), group)
    ]
    kind = "scattergl" if len(kept) > 4000 else "scatter"  # noqa: PLR2004
    late = [row for row in kept if not in_time[row]]

    def points(rows: list[int], name: str, **more: Any) -> dict[str, Any]:
        return {
            "type": kind,
            "x": [number[row] for row in rows],
            "y": [latency[row] for row in rows],
            "name": name,
            "mode": "markers",
            **more,
        }

    traces = [
        points(
            kept,
            "latency",
            mode="lines+markers",
            line={"width": 1, "color": colour("fpga")},
            marker={"size": 4, "color": colour("fpga")},
        )
    ]
    if late:
        traces.append(points(late, "missed", marker={"size": 8, "symbol": "x", "color": "bad"}))
    deadline = run.summary["deadline"]
    worst = [row for row in kept if number[row] == deadline["worst_frame"]]
    ring = {
        "symbol": "circle-open",
        "size": 16,
        "color": "ink",
        "line": {"width": 2, "color": "ink"},
    }
    traces.append(points(worst, "worst frame", marker=ring))
    layout: dict[str, Any] = {
        "xaxis": {"title": {"text": "frame"}, "anchor": "y2"},
        "yaxis": {"title": {"text": "latency / µs"}, "rangemode": "tozero", "domain": [0, 1]},
        "shapes": [],
        "annotations": [],
        "margin": _MARGIN,
    }
    layout["xaxis"].pop("anchor")
    budget = deadline["budget_us"]
    if budget:
        line = {"color": "bad", "width": 2, "dash": "dash"}
        layout["shapes"].append(
            {
                "type": "line",
                "xref": "paper",
                "x0": 0,
                "x1": 1,
                "y0": budget,
                "y1": budget,
                "line": line,
            }
        )
        layout["annotations"].append(
            {
                "xref": "paper",
                "x": 1,
                "y": budget,
                "text": "budget",
                "yanchor": "bottom",
                "showarrow": False,
                "font": {"color": "bad"},
            }
        )
    if any(force):
        traces.append(
            points(
                kept,
                "contact force",
                mode="lines",
                yaxis="y2",
                line={"color": colour("host"), "width": 1},
            )
            | {"y": [force[row] for row in kept]}
        )
        layout["yaxis"]["domain"] = [0.36, 1]
        layout["yaxis2"] = {"title": {"text": "force / N"}, "domain": [0, 0.28], "anchor": "x"}
        layout["xaxis"]["anchor"] = "y2"
    return {"id": "frames-plot", "data": traces, "layout": layout}, group


def spans(of: list[Span]) -> dict[str, Any]:
    """A frame's spans as bars, a lane a part; what is beside the critical path is pale."""
    traces = [
        {
            "type": "bar",
            "orientation": "h",
            "name": part,
            "base": [span.from_us for span in here],
            "x": [span.us for span in here],
            "y": [part if span.critical else f"{part}, beside" for span in here],
            "text": [span.phase for span in here],
            "textposition": "inside",
            "insidetextanchor": "middle",
            "hovertemplate": "%{text}: %{x:.6g} µs from %{base:.6g} µs<extra></extra>",
            "marker": {
                "color": colour(part),
                "opacity": [1 if span.critical else 0.4 for span in here],
            },
        }
        for part in dict.fromkeys(span.part for span in of)
        if (here := [span for span in of if span.part == part])
    ]
    layout = {
        "barmode": "overlay",
        "xaxis": {"title": {"text": "µs since the frame's tick"}, "rangemode": "tozero"},
        "yaxis": {"autorange": "reversed", "automargin": True, "fixedrange": True},
        "margin": _MARGIN,
        "showlegend": False,
    }
    return {"id": "spans-plot", "data": traces, "layout": layout}


def path_of(attribution: list[dict[str, Any]]) -> list[Span]:
    """The worst frame's critical path where its trace is missing: its sums, one after another."""
    path: list[Span] = []
    at = 0.0
    for item in attribution:
        path.append(Span(item["part"], item["phase"], round(at, 6), item["us"], True))
        at += item["us"]
    return path
