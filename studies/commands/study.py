"""`hvp study STUDY.toml`: a base scenario, axes, a table."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from studies.axis import as_quantity
from studies.command_line import command_of as command_line
from studies.command_line import shell_line
from studies.commands import search
from studies.commands.scale_options import add_scale_options, export_array, session_of
from studies.design import points_of
from studies.errors import FAILED, HELD, InputError
from studies.influence import words as influence_words
from studies.metrics import check_metric
from studies.option_paths import check_folder
from studies.point import Point, Value
from studies.program import Program, find_program
from studies.progress import run_with_progress
from studies.store import DEFAULT_STORE
from studies.study_file import Study, load
from studies.study_reference import reference_page
from studies.study_results import Results, outcome_words, write_all
from studies.sweep import all_refused
from studies.text_table import DIGITS, count_of, text_table
from studies.toml_lines import line_of
from studies.worker import command_of

if TYPE_CHECKING:
    from studies.commands import Subparsers

_MOST_ROWS = 40  # on a terminal; results.csv has all


def add_study(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "study",
        help="run a scenario over axes of its keys: a table, pictures, a report",
        epilog="Of a scenario, without a file of a study: hvp study screen (which effects and "
        "fidelity levels its answers need), hvp study accuracy (what accuracy costs in time).",
    )
    parser.add_argument("study", type=Path, nargs="?", metavar="STUDY.toml")
    parser.add_argument(
        "--out", type=Path, metavar="FOLDER", help="in place of studies-out/<study>"
    )
    parser.add_argument(
        "--store", type=Path, default=DEFAULT_STORE, metavar="FOLDER", help="where runs are kept"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="runs at once; one a core")
    parser.add_argument(
        "--retry", action="store_true", help="try runs again that have crashed every time"
    )
    parser.add_argument("--dry-run", action="store_true", help="list the points, run nothing")
    parser.add_argument("--quiet", action="store_true", help="no progress on the terminal")
    parser.add_argument("--reference", action="store_true", help="print docs/study-reference.md")
    add_scale_options(parser)
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    if arguments.reference:
        print(reference_page(), end="")
        return HELD
    if arguments.study is None:
        raise InputError("hvp study: expected STUDY.toml, or screen or accuracy with a scenario")
    if arguments.jobs is not None and arguments.jobs < 1:
        raise InputError(f"--jobs {arguments.jobs}: expected one or more")
    file: Path = arguments.study
    study = load(file)
    if study.search is not None:
        return search.run(arguments, study)
    points = points_of(study, file)
    program = find_program()
    _check_metrics(study, file, program)
    if arguments.dry_run:
        print(_table(study, points))
        print(f"\n{count_of(len(points), 'point')}")
        return HELD
    check_folder("--out", arguments.out or Path("studies-out") / file.stem)
    session = session_of(arguments, study, program)
    if arguments.slurm is not None:
        return export_array(arguments, session, points)
    records = run_with_progress(session, points, arguments.quiet)
    results = Results(study, program, points, records)
    reason = all_refused(results.records)
    if reason is not None:
        raise InputError(f"{file}: {reason}")
    return _report(arguments, results)


def _report(arguments: argparse.Namespace, results: Results) -> int:
    file: Path = arguments.study
    folder = arguments.out or Path("studies-out") / file.stem
    commands = [command_line(arguments, "study")]
    files = write_all(folder, results, file.stem, commands)
    print(_result_table(results))
    print(f"\n{outcome_words(results.ends, results.study.command)}")
    for sentence in influence_words(results.influences):
        print(sentence)
    ends = list(zip(results.points, results.cells["status"], results.cells["message"], strict=True))
    refused = [message for _, status, message in ends if status == "refused"]
    for message in list(dict.fromkeys(refused))[:3]:
        print(f"  refused: {message}")
    print(f"{', '.join(path.name for path in files)} in {folder}")
    failed = [end for end in ends if end[1] in ("crashed", "timed out")]
    if failed:
        count = count_of(len(failed), "run")
        print(f"{count} without an end; --retry tries again. Each by itself:")
    for point, status, message in failed[:10]:
        print(f"  {status}: {message}")
        print(f"    {shell_line(command_of(results.program.path, point)[1:])}")
    return FAILED if failed else HELD


def _check_metrics(study: Study, file: Path, program: Program) -> None:
    known = program.figures(study.command)
    for where, metrics in (("metrics", study.metrics), *(("plot", p.y) for p in study.plot)):
        for metric in metrics:
            line = line_of(file.read_text(encoding="utf-8"), (where,))
            check_metric(f"{file}:{line}: {where}", metric, known)


def _table(study: Study, points: list[Point]) -> str:
    labels = [axis.label for axis in study.axis]
    shown = points[:_MOST_ROWS]
    text = text_table(
        labels, [[_short(point.columns[label]) for label in labels] for point in shown]
    )
    return text + (f"\n… {len(points) - len(shown)} more" if len(points) > len(shown) else "")


def _short(value: Value) -> Value:
    """A quantity of an axis with as many digits as a table shows; results.csv has all."""
    quantity = as_quantity(value) if isinstance(value, str) else None
    if quantity is None:
        return value
    number, unit = quantity
    return min(f"{number:.{DIGITS}g} {unit}".strip(), str(value), key=len)


def _status(results: Results, status: Value) -> Value:
    """`hvp misses` judges nothing."""
    return "answered" if results.study.command == "misses" and status == "held" else status


def _result_table(results: Results) -> str:
    labels = [axis.label for axis in results.study.axis]
    units = {column.name: column.heading for column in results.columns()}
    header = [*labels, *(units.get(name, name) for name in results.metrics), "outcome", "flags"]
    cells = results.cells
    rows = [
        [
            *(_short(cells[label][row]) for label in labels),
            *(cells[name][row] for name in results.metrics),
            cells["verdict"][row] or _status(results, cells["status"][row]),
            None if cells["flags"][row] is None else len(str(cells["flags"][row]).split()),
        ]
        for row in range(min(len(results.points), _MOST_ROWS))
    ]
    more = len(results.points) - len(rows)
    return text_table(header, rows) + (f"\n… {more} more in results.csv" if more > 0 else "")
