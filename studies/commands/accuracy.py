"""`hvp study accuracy SCENARIO`: what accuracy costs, of the design and of the simulator."""

import argparse
import platform
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from studies.accuracy.answer import TARGETS, counted, words
from studies.accuracy.between import refine
from studies.accuracy.design import (
    BUDGET,
    ERROR,
    ERROR_MEANS,
    FORCE_ERROR,
    NO_CONTACT,
    UNMEASURED,
    Design,
    DesignStudy,
    front,
)
from studies.accuracy.grid import (
    ITERATIONS,
    MATRIX_BITS,
    MEMORY,
    METHOD,
    NODES,
    PASSES,
    SCALING,
    VECTOR_BITS,
    grid,
)
from studies.accuracy.ladder import Rung, ladders, resolved_settings
from studies.accuracy.partitions import KEY as PARTITIONS
from studies.accuracy.picture import draw
from studies.command_line import command_of
from studies.commands import accuracy_models
from studies.errors import HELD, InputError
from studies.option_paths import check_folder
from studies.point import Value
from studies.program import find_program
from studies.report.study_page import Plot, write_study_report
from studies.results import CSV, Column, write_results
from studies.session import Session
from studies.store import DEFAULT_STORE, Store
from studies.text_table import text_table
from studies.whole_file import write_whole

if TYPE_CHECKING:
    from studies.commands import Subparsers

SETTINGS = (
    METHOD,
    ITERATIONS,
    MATRIX_BITS,
    VECTOR_BITS,
    SCALING,
    PASSES,
    NODES,
    PARTITIONS,
    MEMORY,
)
COLUMNS = (
    *(Column(name, "", "as the scenario has it where empty") for name in SETTINGS),
    Column(
        "state",
        "",
        "fits, late, beyond budget, breaks down, does not fit, not measured, refused, crashed or "
        "timed out",
    ),
    Column("status", "", "of the run; of one on a larger device where it does not fit"),
    Column(
        "message", "", "why it does not fit, was not measured or was refused; flags of a breakdown"
    ),
    Column("worst_us", "us", "worst latency of a frame"),
    Column("displacement_error", "", f"against the true model, {ERROR_MEANS}"),
    Column("force_error", "", "likewise of the contact force"),
    Column("share", "", "the fullest kind of resource, of what the device has"),
    Column("frames", "", "compared with the true model"),
    Column("front", "", "on the Pareto front of time and displacement error"),
    Column("flags", "", "what the run flagged"),
    Column("tried", "", "partitions that were tried: 1 to that"),
    Column("address", "", "of the run's record in the store"),
)
LADDER = "simulator.csv"
_READING = (
    "A symbol for each state; colour is the share that the fullest kind of resource has of the "
    "scenario's device, more than 1 where a set does not fit it: such a set is drawn where a "
    "larger device would have it. Only what fits, is in time and has the scenario's mesh is on the "
    "front."
)


def declare(parser: argparse.ArgumentParser) -> None:
    """The command's arguments."""
    parser.add_argument("scenario", type=Path, metavar="SCENARIO.toml", nargs="?")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings")
    parser.add_argument("--full", action="store_true", help="a wider grid, some 200 runs")
    parser.add_argument("--out", type=Path, help="folder; default studies-out/accuracy-SCENARIO")
    parser.add_argument("--store", type=Path, default=DEFAULT_STORE, help="what has been run")
    parser.add_argument("--jobs", type=int, default=0, help="runs at a time; default one a core")
    parser.add_argument("--repeats", type=int, default=1, help="runs for each wall time")
    accuracy_models.declare(parser)


def run(arguments: argparse.Namespace) -> int:
    """Both curves; without a board the simulator's alone, and exit 2."""
    for name, least in (("jobs", 0), ("repeats", 1)):
        if getattr(arguments, name) < least:
            raise InputError(
                f"--{name}: expected {least} or more, found {getattr(arguments, name)}"
            )
    if arguments.models:
        return accuracy_models.run(arguments)
    accuracy_models.refuse_without_models(arguments)
    if arguments.scenario is None:
        raise InputError("SCENARIO.toml: expected a scenario, or --models")
    out: Path = arguments.out or Path("studies-out") / f"accuracy-{arguments.scenario.stem}"
    check_folder("--out", out)
    check_folder("--store", arguments.store, written=False)
    program = find_program()
    session = Session(program, Store(arguments.store))
    if arguments.jobs:
        session.workers = arguments.jobs
    scenario: Path = arguments.scenario
    settings = tuple(arguments.settings)
    resolved = resolved_settings(session, scenario, settings)
    if isinstance(resolved, str):
        raise InputError(resolved)
    has = tomllib.loads(resolved.text)
    board = "wall" not in has and has.get("host", {}).get("solver", "board") == "board"
    designs: list[Design] = []
    study = DesignStudy(session, scenario, settings)
    if board:
        nodes = has.get("object", {}).get("mesh", {}).get("nodes")
        designs = refine(study, study.run(grid(arguments.full, nodes)), TARGETS)
    out.mkdir(parents=True, exist_ok=True)
    if board:
        _write_design(out, arguments, study, designs, has["accelerator"]["device"])
    rungs = ladders(session, scenario, settings, has, arguments.repeats)
    text = _ladder_text(rungs)
    write_whole(out / LADDER, _ladder_csv(rungs).encode())
    print(f"{text}\nWritten to {out}")
    if not board:
        raise InputError(
            f"{scenario}: host.solver: no board, so no curve of the design: expected a scenario "
            "whose board solves; the simulator's ladder is above"
        )
    return HELD


def _write_design(
    out: Path,
    arguments: argparse.Namespace,
    study: DesignStudy,
    designs: Sequence[Design],
    device: str,
) -> None:
    shares = study.shares(designs)
    answer = words(designs, device)
    table = _rows(designs, shares)
    write_results(out, table, COLUMNS)
    budget = float(str(designs[0].record.metrics[BUDGET]))
    title = f"What accuracy costs: {arguments.scenario.stem} on one {device}"
    draw(out / "accuracy.png", title, designs, shares, budget)
    frame = pd.read_csv(out / CSV, keep_default_na=False, na_values=[""])
    # What a set is on this device, not how the run ended that gave its figures.
    frame["status"] = frame["state"].replace(UNMEASURED, f"{UNMEASURED}: {NO_CONTACT}")
    best = {
        error: [designs.index(design) for design in front(designs, error)]
        for error in (ERROR, FORCE_ERROR)
    }
    plots = [
        Plot(
            "worst_us",
            y,
            colour="share",
            symbol="state",
            title=name,
            help=_READING,
            log_x=True,
            log_y=True,
            budget_x=budget,
            front=best[error],
            mark=0,
        )
        for error, y, name in (
            (ERROR, "displacement_error", "Displacement"),
            (FORCE_ERROR, "force_error", "Contact force"),
        )
    ]
    write_study_report(
        out,
        title=title,
        frame=frame,
        units={column.name: column.unit for column in COLUMNS if column.unit},
        helps={column.name: column.help for column in COLUMNS},
        plots=plots,
        words=answer,
        commands=[command_of(arguments, "study accuracy")],
        versions={"hvp": study.session.program.version, "python": platform.python_version()},
    )
    print("\n".join(answer))
    print(f"{len(designs)} sets: {counted(designs)}.\n")
    shown = [table[0], *(table[i] for i in best[ERROR] if i)]
    names = (*SETTINGS, "state", "worst_us", "displacement_error", "force_error", "share")
    print("The scenario's own, and the Pareto front of what fits and is in time:\n")
    print(text_table(names, [tuple(row.get(name) for name in names) for row in shown]) + "\n")


def _rows(designs: Sequence[Design], shares: Sequence[float | None]) -> list[dict[str, Value]]:
    best = front(designs)
    return [
        dict(design.columns)
        | {
            "state": design.state,
            "status": design.record.status,
            "message": design.message,
            "worst_us": design.time_us,
            "displacement_error": design.error(ERROR),
            "force_error": design.error(FORCE_ERROR),
            "share": share,
            "frames": design.record.metrics.get("accuracy.frames"),
            "front": design in best,
            "flags": " ".join(design.record.flags),
            "tried": design.tried or None,
            "address": design.record.address,
        }
        for design, share in zip(designs, shares, strict=True)
    ]


def _ladder_rows(rungs: Sequence[Rung]) -> list[tuple[Value, ...]]:
    return [
        (
            rung.part,
            rung.level,
            rung.finest,
            rung.influence.latency if rung.influence else None,
            rung.influence.p99 if rung.influence else None,
            rung.influence.force if rung.influence else None,
            rung.cost.per_simulated_s if rung.cost else None,
            "; ".join(filter(None, (rung.message, _loses(rung)))),
        )
        for rung in rungs
    ]


def _loses(rung: Rung) -> str:
    if rung.influence is None or not rung.influence.lost:
        return ""
    return f"loses {' '.join(rung.influence.lost)}"


_LADDER_HEADER = ("part", "level", "finest", "worst", "p99", "force", "wall_s_per_s", "message")


def _ladder_text(rungs: Sequence[Rung]) -> str:
    """The simulator's curve as a table: wall-clock times are of this machine."""
    return (
        "The simulator: deviation from each part's finest level (shares), and wall-clock time a "
        "second simulated on this machine\n\n" + text_table(_LADDER_HEADER, _ladder_rows(rungs))
    )


def _ladder_csv(rungs: Sequence[Rung]) -> str:
    frame = pd.DataFrame(_ladder_rows(rungs), columns=list(_LADDER_HEADER))
    return str(frame.to_csv(index=False))


def add_accuracy(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser("study accuracy", help="what accuracy costs in time")
    declare(parser)
    parser.set_defaults(run=run)
