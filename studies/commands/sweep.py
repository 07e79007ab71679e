"""`hvp sweep SCENARIO KEY=a,b,c …`: a table, CSV and a plot without a study file."""

import argparse
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from studies.axis import parse_axis
from studies.budgets import budget_of, one_value
from studies.command_line import command_of
from studies.errors import FAILED, HELD, InputError
from studies.metrics import FLAGS, MESSAGE, check_metric
from studies.option_paths import check_file, check_folder, folder_name
from studies.plot import draw_chart, drawable
from studies.point import Value
from studies.program import Program, find_program
from studies.progress import run_with_progress
from studies.report.study_page import Plot
from studies.report.table_page import write_table_report
from studies.results import Column, write_results
from studies.session import Session
from studies.store import DEFAULT_STORE, Store
from studies.study_results import outcome_words
from studies.sweep import DEFAULT_METRICS, Sweep, all_refused, chart, measured, numeric, table
from studies.text_table import text_table

if TYPE_CHECKING:
    from studies.commands import Subparsers


def add_sweep(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser("sweep", help="run a scenario with every value of a key")
    parser.add_argument("scenario", type=Path, metavar="SCENARIO")
    parser.add_argument(
        "axes",
        nargs="+",
        metavar="KEY=VALUES",
        help="a,b,c or from:to:steps or from:to:steps:log; of several keys every combination",
    )
    parser.add_argument("--zip", action="store_true", help="first values together, then second …")
    parser.add_argument(
        "--metrics", action="append", metavar="NAME,…", help="figures of summary.json"
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    parser.add_argument("--include", action="append", default=[], type=Path, metavar="FILE")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="default studies-out/sweep-SCENARIO+KEY"
    )
    parser.add_argument("--plot", type=Path, metavar="FILE", help="default sweep.png in DIR")
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, metavar="DIR")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N")
    parser.add_argument("--time-limit", type=float, metavar="S", help="of one run")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Carry it out; returns the exit status."""
    program = find_program()
    sweep = _sweep_of(arguments, program)
    known = program.figures()
    asked = [name.strip() for name in ",".join(arguments.metrics or ()).split(",") if name.strip()]
    asked = [name for name in asked if name != FLAGS.name]  # every table has them
    for name in asked:
        check_metric("--metrics", name, known)
    if arguments.jobs < 1:
        raise InputError(f"--jobs: expected 1 or more, got {arguments.jobs}")
    if arguments.time_limit is not None and not arguments.time_limit > 0:
        raise InputError(f"--time-limit: expected more than 0 s, got {arguments.time_limit:g}")
    # Another question is another folder.
    asked_of = [arguments.scenario.stem, *arguments.settings, *(axis.key for axis in sweep.axes)]
    out = arguments.out or Path("studies-out") / f"sweep-{folder_name(asked_of)}"
    check_folder("--out", out)
    check_folder("--store", arguments.store, written=False)
    picture = arguments.plot or out / "sweep.png"
    if not drawable(picture):
        raise InputError(f"--plot {picture}: expected a name that ends in .png, .pdf or .svg")
    if arguments.plot:
        check_file("--plot", picture)

    session = Session(program, Store(arguments.store), arguments.jobs, arguments.time_limit)
    records = list(run_with_progress(session, sweep.points()))
    reason = all_refused(records)
    if reason is not None:
        raise InputError(reason)
    metrics = asked or measured(DEFAULT_METRICS, records)
    columns, rows = table(sweep, records, metrics, known)
    print(_text(columns, rows))
    for name in asked:
        if not measured([name], records):
            print(f"{name}: no run has this figure")
    files = write_results(out, rows, columns)
    drawn = chart(_title(arguments, sweep), sweep, records, metrics, known)
    if drawn.panels:
        draw_chart(picture, drawn)
        files.append(picture)
    files.append(
        write_table_report(
            out,
            title=_title(arguments, sweep),
            columns=columns,
            rows=rows,
            plots=[
                Plot(
                    sweep.axes[0].key,
                    name,
                    colour=sweep.axes[1].key if len(sweep.axes) > 1 and not sweep.zipped else None,
                    budget=one_value(r.metrics.get(budget_of(name) or "") for r in records),
                )
                for name in numeric(metrics, records)
            ],
            words=[outcome_words((r.status, bool(r.flags)) for r in records)],
            command=command_of(arguments, "sweep"),
            program=program,
        )
    )
    print("\nResults in " + ", ".join(str(file) for file in files))
    ended = {record.status for record in records}
    return FAILED if ended & {"crashed", "timed out"} else HELD


def _sweep_of(arguments: argparse.Namespace, program: Program) -> Sweep:
    whole = {key["path"] for key in program.reference["keys"] if key["type"] == "integer"}
    axes = tuple(
        parse_axis(text, whole_numbers=text.partition("=")[0].strip() in whole)
        for text in arguments.axes
    )
    for axis in () if arguments.zip else axes:
        for text, count in Counter(axis.texts).items():
            if count > 1:
                raise InputError(f"{axis.key}: {text} stands there twice; with --zip it may")
    keys = [axis.key for axis in axes]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError(f"{key}: expected one axis a key, got {keys.count(key)}")
    return Sweep(
        arguments.scenario,
        axes,
        arguments.zip,
        tuple(arguments.settings),
        tuple(arguments.include),
    )


def _text(columns: Sequence[Column], rows: Sequence[Mapping[str, Value]]) -> str:
    """The table without what no run has, and below it why runs have no figures."""
    shown = [
        column
        for column in columns
        if column != MESSAGE and any(row.get(column.name) not in (None, "") for row in rows)
    ]
    cells = [[row.get(column.name) for column in shown] for row in rows]
    reasons = Counter(str(row[MESSAGE.name]) for row in rows if row.get(MESSAGE.name))
    lines = [text_table([column.heading for column in shown], cells), ""]
    lines += [f"{runs} without figures: {reason}" for reason, runs in reasons.items()]
    return "\n".join(lines).rstrip()


def _title(arguments: argparse.Namespace, sweep: Sweep) -> str:
    changed = f" [{', '.join(arguments.settings)}]" if arguments.settings else ""
    return f"{arguments.scenario.stem}{changed}: {', '.join(axis.key for axis in sweep.axes)}"
