"""`hvp compare RUN RUN …`: what differs between runs."""

import argparse
import json
import shutil
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studies.comparison import Comparison, Names, Row, compare
from studies.comparison_text import comparison_text
from studies.errors import HELD, InputError, StudyError
from studies.metrics import figure_of
from studies.program import find_program
from studies.run_folder import RunFolder, read_run

if TYPE_CHECKING:
    from studies.commands import Subparsers

_TWO = 2


def add_compare(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "compare", help="what differs between runs: settings, time, force, accuracy, flags"
    )
    parser.add_argument(
        "runs", nargs="+", type=Path, metavar="RUN", help="a folder that hvp run --out has written"
    )
    parser.add_argument("--all", action="store_true", help="what is the same too")
    parser.add_argument("--json", action="store_true", help="one JSON object, with everything")
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    if len(arguments.runs) < _TWO:
        raise InputError("hvp compare: expected two runs or more, got 1")
    comparison = compare([read_run(path) for path in arguments.runs], declared_units())
    if arguments.json:
        document = as_json(comparison)
        print(json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False))
    else:
        width = shutil.get_terminal_size().columns
        print(comparison_text(comparison, width, everything=arguments.all), end="")
    return HELD


def declared_units() -> Callable[[str], str]:
    """The unit of a figure, by its declaration; nothing where there is no program to ask.

    Runs can be compared all the same then: names say their units where these are not SI.
    """
    try:
        declared = find_program().figures()
    except (StudyError, InputError, OSError):
        declared = {}
    return lambda key: figure.unit if (figure := figure_of(key, declared)) else ""


def as_json(comparison: Comparison) -> dict[str, Any]:
    """Everything, as docs/reports.md describes it."""
    return {
        "same": comparison.same,
        "runs": [_run_json(run) for run in comparison.runs],
        "settings": [_row_json(row) for row in comparison.settings if row.differs],
        "figures": [_row_json(row) for row in comparison.figures],
        "attribution": [_row_json(row) for row in comparison.attribution],
        "flags": _names_json(comparison.flags),
        "effects": _names_json(comparison.effects),
        "performance": [_row_json(row) for row in comparison.performance],
        "frames": [asdict(frames) for frames in comparison.frames],
    }


def _run_json(run: RunFolder) -> dict[str, Any]:
    return {
        "folder": str(run.path),
        "title": run.summary.get("title"),
        "verdict": run.summary.get("verdict"),
        "held": run.summary.get("held"),
        "partial": run.partial,
    }


def _row_json(row: Row) -> dict[str, Any]:
    return {
        "key": row.key,
        "unit": row.unit,
        "values": list(row.values),
        "changes": list(row.changes),
    }


def _names_json(names: Names) -> dict[str, list[int]]:
    """Which runs have it, by their numbers."""
    return {
        one: [number for number, its in enumerate(names.of_run) if one in its]
        for one in names.every
    }
