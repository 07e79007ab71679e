"""`hvp report RUN`: a run's folder as one page for a browser."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from studies.errors import HELD, InputError
from studies.option_paths import check_file
from studies.program import find_program
from studies.report.run_page import write_run_report

if TYPE_CHECKING:
    from studies.commands import Subparsers


def add_report(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser("report", help="a run as one page for a browser: report.html")
    parser.add_argument(
        "folder", type=Path, metavar="RUN", help="a folder that hvp run --out has written"
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE.html", help="instead of report.html in that folder"
    )
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    folder: Path = arguments.folder
    out: Path = arguments.out or folder / "report.html"
    if out.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--out {out}: expected a name that ends in .html")
    if arguments.out:
        check_file("--out", out)
    print(f"Report in {write_run_report(folder, out, find_program())}")
    return HELD
