"""`./hvp questions [NAME…] [--check | --wall]`: the pages of docs/questions/."""

import argparse
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from studies.errors import HELD, NOT_HELD, InputError
from studies.option_paths import check_folder
from studies.plot import draw_chart
from studies.program import find_program
from studies.questions.page import PAGES, PICTURES, answer, index, page
from studies.questions.question_file import NAMES, read_question
from studies.questions.wall import wall_table
from studies.results import write_results
from studies.session import Session
from studies.store import Store
from studies.text_table import text_table
from studies.whole_file import write_whole

if TYPE_CHECKING:
    from studies.commands import Subparsers


def add_questions(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "questions", help="write the pages of docs/questions/ from runs, or check them"
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}")
    parser.add_argument("--check", action="store_true", help="write nothing, say what is stale")
    parser.add_argument(
        "--wall",
        type=int,
        metavar="N",
        help="write no page: what each run costs in wall-clock time here, of N runs each",
    )
    parser.add_argument("--out", type=Path, default=Path("studies-out"), help="of --wall's tables")
    parser.add_argument("--store", type=Path, help="a folder of records that is kept")
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    names = arguments.names or NAMES
    questions = [read_question(name) for name in names]
    if arguments.wall is not None and arguments.wall < 1:
        raise InputError(f"--wall: expected 1 or more, found {arguments.wall}")
    if arguments.store:
        check_folder("--store", arguments.store, written=False)
    if arguments.wall is not None:
        check_folder("--out", arguments.out)
    made = {}
    with tempfile.TemporaryDirectory(prefix="hvp-questions-") as folder:
        session = Session(find_program(), Store(arguments.store or Path(folder)))
        for question in questions:
            records = session.run(question.points)
            if arguments.wall is not None:
                columns, rows = wall_table(question, records, session.program, arguments.wall)
                names = [column.name for column in columns]
                print(text_table(names, [[row[name] for name in names] for row in rows]))
                write_results(arguments.out / f"{question.name}-wall", rows, columns)
                continue
            made[question.name] = (question, answer(question, records))
    if arguments.wall is not None:
        return HELD
    files = {PAGES / f"{name}.md": page(*its) for name, its in made.items()}
    if not arguments.names:
        files[PAGES / "README.md"] = index(made)
    if arguments.check:
        stale = [
            path
            for path, text in files.items()
            if not path.is_file() or path.read_text(encoding="utf-8") != text
        ]
        for path in stale:
            print(f"{path}: stale: ./hvp questions renews it", file=sys.stderr)
        return NOT_HELD if stale else HELD
    PAGES.mkdir(parents=True, exist_ok=True)
    PICTURES.mkdir(parents=True, exist_ok=True)
    for path, text in files.items():
        write_whole(path, text.encode())
    for name, (_, its) in made.items():
        draw_chart(PICTURES / f"{name}.png", its.chart)
    return HELD
