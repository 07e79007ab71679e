"""`search FILE.toml`: the best point of a space, by the file's objectives and constraints."""

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from studies.device_size import FIGURES
from studies.errors import FAILED, HELD, NOT_HELD, InputError
from studies.program import Figure, find_program
from studies.results import write_results, write_whole
from studies.search import find
from studies.search_file import read_search
from studies.search_text import table, words
from studies.session import Session
from studies.store import DEFAULT_STORE, Store
from studies.sweep import refused_alike

if TYPE_CHECKING:
    from studies.commands import Subparsers


def add_search(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser("search", help="look for the best point of a space")
    add_arguments(parser)
    parser.set_defaults(run=run)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the command takes, wherever it is declared."""
    parser.add_argument("file", type=Path, metavar="FILE.toml", help="docs/search.md")
    parser.add_argument("--out", type=Path, metavar="DIR", help="default studies-out/NAME")
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, metavar="DIR")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N")
    parser.add_argument("--time-limit", type=float, metavar="S", help="of one run")


def run(arguments: argparse.Namespace) -> int:
    """Carry it out; returns the exit status: 1 where nothing keeps every bound."""
    program = find_program()
    if arguments.jobs < 1:
        raise InputError(f"--jobs: expected 1 or more, got {arguments.jobs}")
    flags = Figure("flags", "", "how many flags the run raised")
    known = program.figures() | FIGURES | {flags.name: flags}
    search = read_search(arguments.file, known)
    session = Session(program, Store(arguments.store), arguments.jobs, arguments.time_limit)
    found = find(search, session, _progress if sys.stderr.isatty() else None)
    records = [tried.record for tried in found.tried.values()]
    reason = refused_alike(records)
    if reason is not None:
        raise InputError(f"{arguments.file}: {reason}")
    text = words(found, known)
    print(text)
    out = arguments.out or Path("studies-out") / arguments.file.stem
    columns, rows = table(found, known)
    files = write_results(out, rows, columns)
    files.append(out / "search.txt")
    write_whole(files[-1], f"{text}\n".encode())
    print("\nResults in " + ", ".join(str(file) for file in files))
    if found.best:
        return HELD
    crashed = all(record.status in ("crashed", "timed out") for record in records)
    return FAILED if crashed else NOT_HELD


def _progress(points: int) -> None:
    print(f"\r\033[K{points} points\r", end="", file=sys.stderr, flush=True)
