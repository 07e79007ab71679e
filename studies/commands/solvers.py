"""`hvp study solvers SCENARIO`: the board or a core of the host, and in which way."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from studies.budgets import budget_of, one_value
from studies.command_line import command_of
from studies.errors import HELD, InputError
from studies.option_paths import check_folder
from studies.program import find_program
from studies.record import Record
from studies.report.study_page import Plot
from studies.report.table_page import write_table_report
from studies.results import write_results
from studies.session import Session
from studies.solvers.contest import contest
from studies.solvers.decision import COLUMNS, FORCE, LOAD, Outcome, require_figures, row, words
from studies.store import DEFAULT_STORE, Store
from studies.text_table import text_table

if TYPE_CHECKING:
    from studies.commands import Subparsers

_SHOWN = (
    "host",
    "solver",
    "status",
    "worst_us",
    "p999_us",
    LOAD,
    "miss_high",
    FORCE,
    "displacement_error",
    "memory_bytes",
    "set_up_us",
    "flags",
)


def declare(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.toml")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    parser.add_argument(
        "--host", type=Path, metavar="HOST.toml", help="one more host: what hvp measure host wrote"
    )
    parser.add_argument("--out", type=Path, help="folder; default studies-out/solvers-SCENARIO")
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, help="what has been run")
    parser.add_argument("--jobs", type=int, default=0, help="runs at a time; default one a core")


def run(arguments: argparse.Namespace) -> int:
    """Run every solver on every host, write the results and print them."""
    if arguments.jobs < 0:
        raise InputError(f"--jobs: expected 0 or more, found {arguments.jobs}")
    scenario: Path = arguments.scenario
    out: Path = arguments.out or Path("studies-out") / f"solvers-{scenario.stem}"
    check_folder("--out", out)
    check_folder("--store", arguments.store, written=False)
    program = find_program()
    session = Session(program, Store(arguments.store))
    if arguments.jobs:
        session.workers = arguments.jobs
    held = contest(program, scenario, tuple(arguments.settings), arguments.host)
    records = session.run([entry.point for entry in held.entries])
    outcomes = [Outcome(entry, record) for entry, record in zip(held.entries, records, strict=True)]
    require_figures(outcomes, scenario)
    answer = words(outcomes, held.left_out)
    rows = [row(outcome) for outcome in outcomes]
    write_results(out, rows, COLUMNS)
    write_table_report(
        out,
        title=f"Who solves {scenario.name}",
        columns=COLUMNS,
        rows=rows,
        plots=[
            Plot(
                LOAD,
                FORCE,
                title="Work of the worst period, and error of the force",
                budget=_budget(records, "accuracy.force_of_frame.p95"),
                budget_x=_budget(records, "load.worst_us"),
            )
        ],
        words=answer,
        command=command_of(arguments, "study solvers"),
        program=program,
    )
    headings = [column.heading for column in COLUMNS if column.name in _SHOWN]
    print("\n".join(answer))
    print(text_table(headings, [[cells[name] for name in _SHOWN] for cells in rows]))
    print(f"Written to {out}")
    return HELD


def _budget(records: Sequence[Record], metric: str) -> float | None:
    return one_value(record.metrics.get(budget_of(metric) or "") for record in records)


def add_solvers(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "study solvers", help="the board or a core of the host, and in which way"
    )
    declare(parser)
    parser.set_defaults(run=run)
