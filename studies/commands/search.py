"""`hvp study STUDY.toml` with [search]: the best point of a space, by objectives and bounds."""

import argparse
import sys
from pathlib import Path

from studies.command_line import command_of
from studies.device_size import FIGURES
from studies.errors import FAILED, HELD, NOT_HELD, InputError
from studies.program import Figure, find_program
from studies.report.study_page import Plot
from studies.report.table_page import write_table_report
from studies.results import write_results
from studies.search import find
from studies.search_file import read_search
from studies.search_text import WITHIN, table, words
from studies.session import Session
from studies.store import Store
from studies.sweep import refused_alike
from studies.whole_file import write_whole


def run(arguments: argparse.Namespace) -> int:
    """Carry it out; returns the exit status: 1 where nothing keeps every bound."""
    program = find_program()
    file: Path = arguments.study
    for option in ("scheduler", "slurm", "array_size", "dry_run"):
        if getattr(arguments, option):
            name = option.replace("_", "-")
            raise InputError(f"--{name}: not of a search, as each run follows from those before it")
    flags = Figure("flags", "", "how many flags the run raised")
    known = program.figures() | FIGURES | {flags.name: flags}
    search = read_search(file, known)
    session = Session(program, Store(arguments.store.absolute()), again=arguments.retry)
    if arguments.jobs is not None:
        session.workers = arguments.jobs
    found = find(
        search, session, _progress if sys.stderr.isatty() and not arguments.quiet else None
    )
    records = [tried.record for tried in found.tried.values()]
    reason = refused_alike(records)
    if reason is not None:
        raise InputError(f"{file}: {reason}")
    text = words(found, known)
    print(text)
    out = arguments.out or Path("studies-out") / file.stem
    columns, rows = table(found, known)
    files = write_results(out, rows, columns)
    files.append(out / "search.txt")
    write_whole(files[-1], f"{text}\n".encode())
    numbers = [
        column.name
        for column in columns
        if any(type(row.get(column.name)) in (int, float) for row in rows)
    ]
    # What is wanted, and the bound that comes last: between these the choice is.
    axes = {one.key for one in search.dimensions}
    measures = [name for name in numbers if name not in axes]
    pair = [measures[0], measures[-1]] if len(measures) > 1 else []
    files.append(
        write_table_report(
            out,
            title=search.title or file.stem,
            columns=columns,
            rows=rows,
            plots=[Plot(pair[0], pair[1], colour=WITHIN.name, log_x=True)] if pair else [],
            words=[" ".join(line.split()) for line in text.splitlines()[1:] if line.strip()],
            command=command_of(arguments, "study"),
            program=program,
        )
    )
    print("\nResults in " + ", ".join(str(file) for file in files))
    if found.best:
        return HELD
    crashed = all(record.status in ("crashed", "timed out") for record in records)
    return FAILED if crashed else NOT_HELD


def _progress(points: int) -> None:
    print(f"\r\033[K{points} points\r", end="", file=sys.stderr, flush=True)
