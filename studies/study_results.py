"""What a study leaves behind: a table in files, on the terminal, as pictures and as a page."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from studies.plot import Chart, Line, Panel, draw_chart, spans_decades
from studies.point import Command, Point, Value
from studies.program import Figure, Program
from studies.record import Record
from studies.report.study_page import Plot, write_study_report
from studies.results import Column, write_results
from studies.study_file import Picture, Study

_DEFAULT: dict[Command, tuple[str, ...]] = {
    "run": (
        "deadline.worst_us",
        "deadline.misses",
        "accuracy.displacement_rel",
        "accuracy.force_rel",
    ),
    "device": ("fits", "clock.highest_hz", "mesh.frame_us", "largest_mesh.nodes"),
    "stability": ("stiffness_max", "stiffness_linear", "delay_us"),
}
_MOST_PANELS = 3
_FIXED = (
    Column("status", "", "held, not held, refused, crashed or timed out"),
    Column("message", "", "why there are no figures"),
    Column("verdict", "", "what the terminal calls the run"),
    Column("flags", "", "of the run, by spaces"),
)
_ADDRESS = Column("address", "", "of the record in the store")


@dataclass(frozen=True)
class Results:
    """Points with their records, and what is shown of them."""

    study: Study
    program: Program
    points: Sequence[Point]
    records: Sequence[Record]

    @property
    def metrics(self) -> tuple[str, ...]:
        """What tables show first: what the study asks for, or what its command usually is for."""
        if self.study.metrics:
            return tuple(self.study.metrics)
        there = {name for record in self.records for name in record.metrics}
        return tuple(name for name in _DEFAULT[self.study.command] if name in there)

    def columns(self) -> list[Column]:
        """Axes, outcome, the metrics asked for, then every other figure that a run has."""
        figures = self.program.figures(self.study.command)
        axes = [
            Column(axis.label, "", "axis: " + (axis.key or " ".join(axis.keys)))
            for axis in self.study.axis
        ]
        taken = {column.name for column in (*axes, *_FIXED, _ADDRESS)}
        others = sorted({name for record in self.records for name in record.metrics})
        names = dict.fromkeys((*self.metrics, *others))
        return [
            *axes,
            *_FIXED,
            *(_column(name, figures) for name in names if name not in taken),
            _ADDRESS,
        ]

    def rows(self) -> list[dict[str, Value]]:
        """A row a point."""
        return [
            {
                **record.metrics,
                **point.columns,
                "status": record.status,
                "message": record.message,
                "verdict": record.verdict,
                "flags": " ".join(record.flags),
                "address": record.address,
            }
            for point, record in zip(self.points, self.records, strict=True)
        ]


def _column(name: str, figures: dict[str, Figure]) -> Column:
    figure = figures.get(name)
    if figure is None:  # of a table whose names are the scenario's
        figure = next(
            (
                f
                for f in figures.values()
                if "*" in f.name or "<" in f.name
                if _matches(f.name, name)
            ),
            Figure(name, "", ""),
        )
    return Column(name, figure.unit, figure.help)


def _matches(pattern: str, name: str) -> bool:
    parts = re.split(r"(<[^>]*>|\*)", pattern)
    expression = "".join(".+" if re.match(r"<|\*", part) else re.escape(part) for part in parts)
    return re.fullmatch(expression, name) is not None


def write_all(folder: Path, results: Results, name: str, commands: list[str]) -> list[Path]:
    """results.csv, results.parquet, pictures and report.html. Returns the files."""
    columns, rows = results.columns(), results.rows()
    written = write_results(folder, rows, columns)
    frame = pd.DataFrame(rows, columns=[column.name for column in columns])
    units = {column.name: column.unit for column in columns if column.unit}
    pictures = results.study.plot or _default_pictures(results)
    budget = "deadline.budget_us"
    for index, picture in enumerate(pictures, start=1):
        path = folder / ("plot.png" if len(pictures) == 1 else f"plot-{index}.png")
        draw_chart(path, _chart(results, picture, units))
        written.append(path)
    plots = [
        Plot(
            x=picture.x,
            y=metric,
            colour=picture.colour or None,
            budget=_one_value(results.records, budget) if metric == "deadline.worst_us" else None,
        )
        for picture in pictures
        for metric in picture.y or results.metrics[:_MOST_PANELS]
    ]
    written.append(
        write_study_report(
            folder,
            title=results.study.title or name,
            frame=frame,
            units=units,
            helps={column.name: column.help for column in columns},
            plots=plots,
            words=[outcome_words(results.records)],
            commands=commands,
            versions={"hvp": results.program.version.removeprefix("hvp ")},
        )
    )
    return written


def outcome_words(records: Sequence[Record]) -> str:
    """How the runs ended, counted."""
    counts = {
        "held every budget": sum(r.status == "held" and not r.flags for r in records),
        "held every budget with flags": sum(r.status == "held" and bool(r.flags) for r in records),
        "did not": sum(r.status == "not held" for r in records),
        "were refused": sum(r.status == "refused" for r in records),
        "crashed": sum(r.status == "crashed" for r in records),
        "had no end in time": sum(r.status == "timed out" for r in records),
    }
    said = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    return f"Of {len(records)} points {said}."


def _default_pictures(results: Results) -> list[Picture]:
    axes = [axis.label for axis in results.study.axis]
    if not results.metrics:
        return []
    return [Picture(x=axes[0], colour=axes[1] if len(axes) > 1 else "")]


def _one_value(records: Sequence[Record], metric: str) -> float | None:
    found = {record.metrics.get(metric) for record in records if record.done}
    value = found.pop() if len(found) == 1 else None
    return float(value) if isinstance(value, int | float) else None


def _chart(results: Results, picture: Picture, units: dict[str, str]) -> Chart:
    """Points without figures are crosses on the x axis."""
    pairs = list(zip(results.points, results.records, strict=True))
    done = [(point, record) for point, record in pairs if record.done]
    groups = list(dict.fromkeys(_text(p.columns.get(picture.colour)) for p, _ in done))
    panels = []
    for metric in picture.y or results.metrics[:_MOST_PANELS]:
        lines = []
        for group in groups:
            of_group = [
                (_place(point.columns[picture.x]), _number(record.metrics.get(metric)))
                for point, record in done
                if _text(point.columns.get(picture.colour)) == group
            ]
            lines.append(Line(group, [x for x, _ in of_group], [y for _, y in of_group]))
        log = spans_decades([y for line in lines for y in line.y])
        unit = units.get(metric)
        panels.append(Panel(f"{metric} [{unit}]" if unit else metric, lines, log=log))
    crosses = [_place(point.columns[picture.x]) for point, record in pairs if not record.done]
    places = [_place(point.columns[picture.x]) for point, _ in pairs]
    numbers = [place for place in places if not isinstance(place, str)]
    return Chart(
        results.study.title or picture.x,
        picture.x,
        panels,
        legend=picture.colour,
        log_x=len(numbers) == len(places) and spans_decades(numbers),
        crosses=tuple(dict.fromkeys(crosses)),
        crosses_name="no figures",
    )


def _text(value: Value) -> str:
    return "" if value is None else str(value)


def _place(value: Value) -> float | str:
    return value if isinstance(value, int | float) and not isinstance(value, bool) else str(value)


def _number(value: Value) -> float | None:
    return float(value) if isinstance(value, int | float) else None
