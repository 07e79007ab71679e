"""`hvp study STUDY.toml` with [search]: the best point of a space, by objectives and bounds."""

import argparse
import sys
from pathlib import Path

from studies.command_line import command_of
from studies.commands.scale_options import session_of
from studies.device_size import FIGURES
from studies.errors import FAILED, HELD, NOT_HELD, InputError
from studies.option_paths import check_folder
from studies.plot import draw_chart
from studies.program import Figure, find_program
from studies.report.study_page import Plot
from studies.report.table_page import write_table_report
from studies.results import write_results
from studies.search import UnmeasuredError, find
from studies.search_picture import axes_of, chart
from studies.search_space import check_metrics, place_of, search_of
from studies.search_text import WITHIN, plan, table, words
from studies.study_file import Study
from studies.sweep import all_refused
from studies.whole_file import write_whole


def run(arguments: argparse.Namespace, study: Study) -> int:
    """Carry it out; returns the exit status: 1 where nothing keeps every bound."""
    file: Path = arguments.study
    search = search_of(study, file)
    program = find_program()
    for option in ("scheduler", "slurm", "array_size"):
        if getattr(arguments, option):
            name = option.replace("_", "-")
            raise InputError(f"--{name}: not of a search, as each run follows from those before it")
    flags = Figure("flags", "", "how many flags the run raised")
    known = program.figures() | FIGURES | {flags.name: flags}
    check_metrics(search, file, known)
    if arguments.dry_run:
        print(plan(search))
        return HELD
    out = arguments.out or Path("studies-out") / file.stem
    check_folder("--out", out)
    session = session_of(arguments, study, program)
    progress = _progress if sys.stderr.isatty() and not arguments.quiet else None
    try:
        found = find(search, session, progress)
    except UnmeasuredError as error:
        raise InputError(f"{place_of(search, file, error.metric)}: {error}") from error
    records = [tried.record for tried in found.tried.values()]
    reason = all_refused(records)
    if reason is not None:
        raise InputError(f"{file}: {reason}")
    text = words(found, known)
    print(text)
    columns, rows = table(found, known)
    files = write_results(out, rows, columns)
    files.append(out / "search.txt")
    write_whole(files[-1], f"{text}\n".encode())
    pair = axes_of(found)
    if pair:
        files.append(out / "plot.png")
        draw_chart(files[-1], chart(found, pair, known))
    order = {choice: row for row, choice in enumerate(found.tried)}
    front = [order[one.choice] for one in found.best]
    files.append(
        write_table_report(
            out,
            title=search.title or file.stem,
            columns=columns,
            rows=rows,
            plots=[Plot(*pair, colour=WITHIN.name, log_x=True, front=front)] if pair else [],
            words=[" ".join(line.split()) for line in text.splitlines()[1:] if line.strip()],
            command=command_of(arguments, "study"),
            program=program,
        )
    )
    print("\nResults in " + ", ".join(str(file) for file in files))
    if found.best:
        return HELD
    return NOT_HELD if any(record.done for record in records) else FAILED


def _progress(points: int) -> None:
    print(f"\r\033[K{points} points\r", end="", file=sys.stderr, flush=True)
