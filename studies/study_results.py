"""What a study leaves behind: a table in files, on the terminal, as pictures and as a page."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd

from studies.axis import places
from studies.budgets import budget_of, one_value
from studies.influence import COLUMNS as INFLUENCE_COLUMNS
from studies.influence import Influence, influences
from studies.influence import words as influence_words
from studies.metrics import figure_of
from studies.plot import draw_chart
from studies.point import Command, Point, Value
from studies.program import Figure, Program
from studies.record import Record
from studies.report.study_page import Plot, write_study_report
from studies.results import Column, write_columns, write_csv
from studies.study_file import Picture, Study
from studies.study_picture import chart
from studies.text_table import count_of

_DEFAULT: dict[Command, tuple[str, ...]] = {
    "run": (
        "deadline.worst_us",
        "deadline.misses",
        "accuracy.displacement_of_frame.p95",
        "accuracy.force_of_frame.p95",
    ),
    "device": ("fits", "clock.highest_hz", "mesh.frame_us", "largest_mesh.nodes"),
    "stability": ("stiffness_max", "stiffness_linear", "delay_us"),
    "misses": ("share", "low", "high"),
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
        return tuple(name for name in _DEFAULT[self.study.command] if name in self._figures)

    def columns(self) -> list[Column]:
        """Axes, outcome, the metrics asked for, then every other figure that a run has."""
        figures = self.program.figures(self.study.command)
        axes = [
            Column(axis.label, "", "axis: " + (axis.key or " ".join(axis.keys)))
            for axis in self.study.axis
        ]
        taken = {column.name for column in (*axes, *_FIXED, _ADDRESS)}
        names = dict.fromkeys((*self._asked, *sorted(self._figures)))
        return [
            *axes,
            *_FIXED,
            *(_column(name, figures) for name in names if name not in taken),
            _ADDRESS,
        ]

    @cached_property
    def cells(self) -> dict[str, list[Value]]:
        """Those of each column, a point each. Each record is read once for them."""
        cells: dict[str, list[Value]] = {
            name: self._figures.get(name, [None] * len(self.points)) for name in self._asked
        }
        axes: dict[str, list[Value]] = {
            axis.label: [point.columns[axis.label] for point in self.points]
            for axis in self.study.axis
        }
        return cells | self._figures | axes | self._read[1]

    @cached_property
    def influences(self) -> list[Influence]:
        """Of each axis on the metrics, where the points are sampled."""
        return influences(self.study, self.cells, self.metrics)

    @property
    def ends(self) -> list[tuple[str, bool]]:
        """How each run ended, and whether it raised flags."""
        cells = self.cells
        return [
            (str(status), bool(flags))
            for status, flags in zip(cells["status"], cells["flags"], strict=True)
        ]

    @property
    def _asked(self) -> list[str]:
        """What is shown, whether a run has it or not."""
        return [*self.metrics, *(name for picture in self.study.plot for name in picture.y)]

    @property
    def _figures(self) -> dict[str, list[Value]]:
        return self._read[0]

    @cached_property
    def _read(self) -> tuple[dict[str, list[Value]], dict[str, list[Value]]]:
        """Figures by their names, and how the runs ended."""
        figures: dict[str, list[Value]] = {}
        ends: dict[str, list[Value]] = {column.name: [] for column in (*_FIXED, _ADDRESS)}
        for row, record in enumerate(self.records):
            for name, value in record.metrics.items():
                if name not in figures:
                    figures[name] = [None] * len(self.points)
                figures[name][row] = value
            for name, value in (
                ("status", record.status),
                ("message", record.message),
                ("verdict", record.verdict),
                ("flags", " ".join(record.flags) if record.done else None),
                (_ADDRESS.name, record.address),
            ):
                ends[name].append(value)
        return figures, ends


def _column(name: str, figures: dict[str, Figure]) -> Column:
    figure = figure_of(name, figures)
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
    columns, cells = results.columns(), results.cells
    written = write_columns(folder, cells, columns)
    found = results.influences
    if found:
        rows = [influence.row() for influence in found]
        written.append(write_csv(folder / "influence.csv", rows, INFLUENCE_COLUMNS))
    names = [column.name for column in columns]
    units = {column.name: column.unit for column in columns if column.unit}
    pictures = results.study.plot or _default_pictures(results)
    shown = [(picture, picture.y or results.metrics[:_MOST_PANELS]) for picture in pictures]
    for index, (picture, metrics) in enumerate(shown, start=1):
        path = folder / ("plot.png" if len(pictures) == 1 else f"plot-{index}.png")
        draw_chart(path, chart(results.study.title, picture, metrics, cells, units))
        written.append(path)
    plots = [
        Plot(
            x=picture.x,
            y=metric,
            colour=picture.colour or None,
            budget=one_value(cells.get(budget_of(metric) or "", ())),
        )
        for picture, metrics in shown
        for metric in metrics
    ]
    shown_cells: dict[str, Sequence[Value]] = {name: cells[name] for name in names}
    for axis in results.study.axis:  # sorted and drawn as numbers, where they are
        numbers, unit = places(cells[axis.label])
        if unit:
            shown_cells[axis.label], units[axis.label] = numbers, unit
    written.append(
        write_study_report(
            folder,
            title=results.study.title or name,
            frame=pd.DataFrame(shown_cells, columns=names),
            units=units,
            helps={column.name: column.help for column in columns},
            plots=plots,
            words=[outcome_words(results.ends, results.study.command), *influence_words(found)],
            commands=commands,
            versions={"hvp": results.program.version.removeprefix("hvp ")},
        )
    )
    return written


def outcome_words(ends: Iterable[tuple[str, bool]], command: Command = "run") -> str:
    """How the runs ended, counted: the status of each, and whether it raised flags."""
    of = Counter(ends)
    # `hvp misses` judges nothing.
    judged = command != "misses"
    counts = {
        "held every budget" if judged else "have an answer": of["held", False],
        "held every budget with flags": of["held", True],
        "did not": of["not held", False] + of["not held", True],
        "were refused": of["refused", False],
        "crashed": of["crashed", False],
        "had no end in time": of["timed out", False],
    }
    said = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
    return f"Of {count_of(of.total(), 'point')} {said}."


def _default_pictures(results: Results) -> list[Picture]:
    axes = [axis.label for axis in results.study.axis]
    if not results.metrics:
        return []
    if results.study.design.kind in ("latin-hypercube", "sobol"):
        # No two axes stand still while a third one moves: each has a picture of its own.
        return [Picture(x=label, y=[results.metrics[0]]) for label in axes]
    return [Picture(x=axes[0], colour=axes[1] if len(axes) > 1 else "")]
