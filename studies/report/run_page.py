"""The report of a run: verdict, times, body, accuracy, flags, settings."""

import platform
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from studies.command_line import shell_line
from studies.metrics import columns_of
from studies.program import Figure, Program
from studies.record import flatten
from studies.report import timeline
from studies.report.body import read_body
from studies.report.page import render
from studies.run_folder import read_run
from studies.whole_file import write_whole

# What a reader asks for first. Their meanings and units are the program's own.
KEY = (
    "deadline.worst_us", "deadline.p99_us", "deadline.budget_us", "deadline.misses",
    "deadline.skipped_ticks", "load.worst_us", "force.largest.N", "force.step.N",
    "accuracy.displacement_of_frame.median", "accuracy.force_of_frame.median",
    "stiffness.stiffness_max", "bus.utilisation.share", "accelerator.device",
    "accelerator.solve_us", "mesh.nodes", "mesh.tetrahedra",
)  # fmt: skip


def write_run_report(run: Path, out: Path, program: Program) -> Path:
    """Write one file, the same bytes for the same run. Throws InputError for what is no run."""
    folder = read_run(run)
    summary = folder.summary
    figures = program.figures()
    deadline = summary["deadline"]
    guest = summary.get("guest")
    worst = deadline.get("worst_frame")
    spans = folder.spans(worst) if worst is not None else []
    traced = bool(spans)
    spans = spans or timeline.path_of(summary.get("attribution") or [])
    frames, group = timeline.frames(folder)
    body = read_body(run, worst)
    flat = flatten(dict(summary))
    parts = [
        ("verdict", "Verdict"), ("frames", "Frames"), ("worst", "Worst frame"),
        ("attribution", "Attribution"), ("body", "Body"), ("accuracy", "Accuracy"),
        ("flags", "Flags"), ("figures", "Every figure"), ("settings", "Settings"),
        ("versions", "Commands and versions"),
    ]  # fmt: skip
    page = render(
        "run.html",
        {"figures": [frames, *([timeline.spans(spans)] if spans else [])], "body": body},
        kind="Run",
        title=summary.get("title") or "A run without a title",
        sections=[part for part in parts if body or part[0] != "body"],
        summary=summary,
        deadline=deadline,
        good=_standing(summary),
        key=_rows(flat, figures, [key for key in KEY if flat.get(key) is not None]),
        every=_rows(flat, figures, list(flat)),
        accuracy=_rows(flat, figures, [key for key in flat if key.startswith("accuracy.")]),
        measured=bool(flat.get("accuracy.measured")),
        group=group,
        spans=spans,
        traced=traced,
        body=body,
        flags=_flags(summary, program),
        remedy=summary.get("remedy"),
        latency_picture=folder.picture("latency.png"),
        body_picture=folder.picture("deformation.png"),
        settings=folder.settings,
        command=shell_line(["linux" if guest else "run", str(folder.scenario_file)]),
        guest=guest,
        versions={
            "hvp, of this page": program.version,
            "Python": platform.python_version(),
            **{package: version(package) for package in ("plotly", "Jinja2", "numpy")},
        },
    )
    return write_whole(out, page)


def _standing(summary: Mapping[str, Any]) -> str:
    if not summary.get("held"):
        return "bad"
    return "warn" if _raised(summary) or summary.get("partial") else "good"


def _raised(summary: Mapping[str, Any]) -> list[str]:
    """Of a guest, whose numbers nobody looks at, there are none."""
    raised: list[str] = summary.get("stability", {}).get("flags", [])
    return raised


def _rows(
    flat: dict[str, Any], figures: dict[str, Figure], keys: list[str]
) -> list[dict[str, Any]]:
    return [
        {"key": column.name, "value": flat[column.name], "unit": column.unit, "help": column.help}
        for column in columns_of(keys, figures)
    ]


def _flags(summary: Mapping[str, Any], program: Program) -> list[dict[str, str]]:
    known = {flag["name"]: flag for flag in program.reference["flags"]}
    return [
        {"name": name, "meaning": "", "remedy": ""} | known.get(name, {})
        for name in _raised(summary)
    ]
