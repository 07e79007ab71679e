"""`hvp study screen SCENARIO`: which effects and fidelity levels the scenario's answers need."""

import argparse
import platform
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from studies.command_line import command_of
from studies.errors import HELD, InputError, StudyError
from studies.option_paths import check_folder
from studies.point import Point
from studies.program import find_program
from studies.report.study_page import Plot, write_study_report
from studies.results import CSV, write_results
from studies.screening.answers import ANSWERS, DEFAULT_TOLERANCE
from studies.screening.found import Screening
from studies.screening.scenario_file import scenario_text
from studies.screening.screen import DEFAULT_PAIRS, Screener
from studies.screening.tables import (
    COLUMNS,
    RECOMMENDED,
    recommendation_words,
    rows,
    screening_text,
    timing_csv,
)
from studies.screening.timing import Cost, measure
from studies.session import Session
from studies.store import DEFAULT_STORE, Store
from studies.whole_file import write_whole

if TYPE_CHECKING:
    from studies.commands import Subparsers


def declare(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.toml")
    parser.add_argument(
        "--tolerance",
        action="append",
        default=[],
        metavar="ANSWER=SHARE",
        help="how far an answer may move, as 1%% or 0.01, or any; several by commas; "
        f"{', '.join(ANSWERS)}; 1%% each unless said",
    )
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    parser.add_argument("--out", type=Path, help="folder; default studies-out/screen-SCENARIO")
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, help="what has been run")
    parser.add_argument("--jobs", type=int, default=0, help="runs at a time; default one a core")
    parser.add_argument(
        "--pairs", type=int, default=DEFAULT_PAIRS, help="so many changes are tried two by two"
    )
    parser.add_argument(
        "--repeats", type=int, default=3, help="runs for each wall time; 0: none is measured"
    )


def run(arguments: argparse.Namespace) -> int:
    """Screen, write the results and print them."""
    tolerances = read_tolerances(arguments.tolerance)
    for name in ("jobs", "pairs", "repeats"):
        if getattr(arguments, name) < 0:
            raise InputError(f"--{name}: expected 0 or more, found {getattr(arguments, name)}")
    scenario: Path = arguments.scenario
    out: Path = arguments.out or Path("studies-out") / f"screen-{scenario.stem}"
    check_folder("--out", out)
    check_folder("--store", arguments.store, written=False)
    program = find_program()
    session = Session(program, Store(arguments.store))
    if arguments.jobs:
        session.workers = arguments.jobs
    screener = Screener(session, scenario, tuple(arguments.settings), tolerances)
    found = screener.screen(arguments.pairs)
    best = found.recommendation
    overrides = screener.settings_of(best.changes)
    out.mkdir(parents=True, exist_ok=True)
    recommended = out / RECOMMENDED
    comment = "What the scenario's answers need, by `hvp study screen`."
    write_whole(recommended, scenario_text(scenario, out, comment, overrides).encode())
    try:
        screener.verify(recommended, best)
    except StudyError:
        recommended.unlink()  # so that nobody takes it for one
        raise
    costs: dict[str, Cost] = {}
    if arguments.repeats:
        points = {"scenario": screener.point(), "recommended": Point(recommended)}
        points |= {
            one.change.name: screener.point([one.change]) for one in found.ones if one.record.done
        }
        costs = measure(program, points, arguments.repeats)
        write_whole(out / "timing.csv", timing_csv(costs).encode())
    write_results(out, rows(found), COLUMNS)
    text = screening_text(scenario, found, tolerances, costs)
    _report(out, arguments, found, recommendation_words(found, tolerances, costs), program.version)
    print(f"{text}\nWritten to {out}")
    return HELD


def read_tolerances(texts: list[str]) -> dict[str, float | None]:
    """A tolerance by answer. Throws InputError."""
    tolerances: dict[str, float | None] = dict.fromkeys(ANSWERS, DEFAULT_TOLERANCE)
    for text in ",".join(texts).split(",") if texts else []:
        answer, _, value = (part.strip() for part in text.partition("="))
        if answer not in ANSWERS:
            raise InputError(
                f"--tolerance: {answer}: expected one of {', '.join(ANSWERS)}, found '{answer}'"
            )
        tolerances[answer] = None if value == "any" else _share(answer, value)
    return tolerances


def _share(answer: str, text: str) -> float:
    try:
        value = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise InputError(
            f"--tolerance: {answer}: expected a share such as 1% or 0.01, or any, found '{text}'"
        )
    return value


def _report(
    out: Path, arguments: argparse.Namespace, found: Screening, words: list[str], version: str
) -> None:
    frame = pd.read_csv(out / CSV, keep_default_na=False, na_values=[""])
    write_study_report(
        out,
        title=f"Screening of {arguments.scenario.name}",
        frame=frame,
        units={column.name: column.unit for column in COLUMNS if column.unit},
        helps={column.name: column.help for column in COLUMNS},
        plots=[Plot("worst", "force", title="What a change does to latency and to force")],
        words=[*words, f"Exercised: {found.exercised.words()}."],
        commands=[command_of(arguments, "study screen")],
        versions={"hvp": version, "python": platform.python_version()},
    )


def add_screen(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "study screen", help="which effects and fidelity levels the answers need"
    )
    declare(parser)
    parser.set_defaults(run=run)
