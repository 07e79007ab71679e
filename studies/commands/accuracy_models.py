"""`hvp study accuracy --models`: what accuracy costs across tissue models, with the mesh apart."""

import argparse
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.accuracy.families import SETTINGS, members
from studies.accuracy.ladder import resolved_settings
from studies.accuracy.measured import LOAD, MEDIAN, NORMS, Measured, Scene, front
from studies.accuracy.mesh_error import ELEMENTS, MeshError, mesh_error
from studies.accuracy.model_answer import (
    DISPLACEMENT,
    FORCE,
    LEFT_OUT,
    best_of_families,
    columns_of,
    describe,
    words,
)
from studies.accuracy.model_picture import NOTICEABLE, draw
from studies.command_line import command_of
from studies.errors import HELD, InputError
from studies.option_paths import check_folder
from studies.point import Value
from studies.program import find_program
from studies.report.study_page import Plot, write_study_report
from studies.results import CSV, Column, write_results
from studies.session import Session
from studies.store import Store
from studies.text_table import count_of, text_table
from studies.whole_file import write_whole

SCENES = Path(__file__).resolve().parents[1] / "accuracy" / "scenes"
NAMES = ("sphere", "block-5", "block-10", "bean")
TRUTHS = ("neo-hookean-log", "neo-hookean-isochoric", "corotational", "fung", "st-venant-kirchhoff")
MOST_NODES = 4000
SETTLED = 0.01
_SMALL = ("object.mesh.nodes=120",)
_SMALL_NODES = 480

_BUDGET = "deadline.period_us"
MESHES = "meshes.csv"
WALL = "wall-clock.csv"
_NORM_HELP = {
    "mean_rel": "mean over the frames compared, of the run's largest",
    "median": "half of the frames in contact are within it, of their own size",
    "p95": "95 % of the frames in contact are within it, of their own size",
    "worst": "the worst frame in contact, of its own size",
}
COLUMNS = (
    Column("scene", "", "the scenario"),
    Column("family", "", "law and who solves"),
    Column("law", "", "of the body"),
    Column("solver", "", "who solves: host.solver"),
    *(Column(name, "", "empty where it does not apply, or is the program's") for name in SETTINGS),
    Column("state", "", "fits, late, does not fit, breaks down, not measured, refused or failed"),
    Column("status", "", "of the run whose times these are"),
    Column("message", "", "why it does not fit or was refused; flags of a breakdown"),
    *(
        Column(name, "", f"error of the {name.split('_', 1)[0]} against the true law: "
               f"{_NORM_HELP[name.split('_', 1)[1]]}")
        for name in NORMS
    ),
    Column("worst_us", "us", "worst latency of a frame"),
    Column("median_us", "us", "median latency"),
    Column("load_worst_us", "us", "worst load of a frame: until all of its work is done"),
    Column("load_median_us", "us", "median load"),
    Column("set_up_us", "us", "simulated time until the servo loop began"),
    Column("memory_share", "", "the board's fullest type of memory; empty without a board"),
    Column("front", "", "on its family's front of worst latency and force_p95"),
    Column("flags", "", "what the run flagged"),
    Column("address", "", "of the run's record in the store"),
)  # fmt: skip
_READING = (
    "Errors are those of law and solver on the scene's own mesh; the mesh's own error stands in "
    "the answer. Of a force the budget is the lower end of what people notice; of time it is the "
    "period. What is late has the error of a host that is not."
)


@dataclass(frozen=True)
class _Of:
    """A scene with what came of it."""

    scene: Scene
    measured: list[Measured]
    mesh: MeshError


def declare(parser: argparse.ArgumentParser) -> None:
    """What the command takes beside the options of `hvp study accuracy`."""
    parser.add_argument(
        "--models",
        action="store_true",
        help="across tissue models, with the mesh's own error apart; without a SCENARIO of the "
        f"project's scenes {', '.join(NAMES)}",
    )
    models = parser.add_argument_group("with --models")
    models.add_argument("--truth", choices=TRUTHS, help=f"the true law; default {TRUTHS[0]}")
    models.add_argument("--small", action="store_true", help="a few members on coarse meshes")
    models.add_argument(
        "--most-nodes", type=int, help=f"of the finest mesh; default {MOST_NODES}", metavar="N"
    )
    models.add_argument(
        "--reference-elements",
        choices=ELEMENTS,
        help=f"of the finer meshes that the mesh's own error is taken from; default {ELEMENTS[0]}",
    )
    models.add_argument(
        "--settled",
        type=float,
        metavar="SHARE",
        help="a doubling of the nodes that moves the force by less ends the refinement of the "
        f"mesh; default {SETTLED:g}",
    )


def refuse_without_models(arguments: argparse.Namespace) -> None:
    """Throws InputError for an option that needs --models."""
    for name in ("truth", "small", "most_nodes", "reference_elements", "settled"):
        if getattr(arguments, name) not in (None, False):
            raise InputError(f"--{name.replace('_', '-')}: belongs to --models")


def run(arguments: argparse.Namespace) -> int:
    """Every scene with every member, then finer meshes; writes tables, picture and page."""
    most_nodes, share = _checked(arguments)
    out: Path = arguments.out or Path("studies-out") / "accuracy-models"
    check_folder("--out", out)
    check_folder("--store", arguments.store, written=False)
    session = Session(find_program(), Store(arguments.store))
    if arguments.jobs:
        session.workers = arguments.jobs
    truth: str = arguments.truth or TRUTHS[0]
    settings = (*(_SMALL if arguments.small else ()), *arguments.settings)
    if arguments.scenario:
        files = [arguments.scenario]
    else:
        files = [SCENES / f"{name}.toml" for name in (NAMES[:1] if arguments.small else NAMES)]
    scenes = [Scene(session, file, settings, truth) for file in files]
    for scene in scenes:
        resolved = resolved_settings(session, scene.scenario, settings)
        if isinstance(resolved, str):
            raise InputError(resolved)
    found = [
        _Of(
            scene,
            scene.run(members(arguments.small)),
            mesh_error(scene, most_nodes, share, arguments.reference_elements or ELEMENTS[0]),
        )
        for scene in scenes
    ]
    _check(found)
    out.mkdir(parents=True, exist_ok=True)
    _write(out, arguments, found, truth)
    print(f"Written to {out}")
    return HELD


def _checked(arguments: argparse.Namespace) -> tuple[int, float]:
    if arguments.full:
        raise InputError("--full: does not go with --models: expected --small or neither")
    if arguments.repeats != 1:
        raise InputError("--repeats: does not go with --models, which measures no wall times anew")
    most_nodes = arguments.most_nodes
    if most_nodes is None:
        most_nodes = _SMALL_NODES if arguments.small else MOST_NODES
    if most_nodes < 1:
        raise InputError(f"--most-nodes: expected 1 or more, found {most_nodes}")
    share = SETTLED if arguments.settled is None else arguments.settled
    if not 0 <= share < 1:
        raise InputError(f"--settled: expected a share from 0 to 1, found {share:g}")
    return most_nodes, share


def _check(found: Sequence[_Of]) -> None:
    for of in found:
        if not any(m.drawn for m in of.measured):
            reason = next((m.message for m in of.measured if m.message), "no frame in contact")
            raise InputError(
                f"{of.scene.scenario}: no member has an error that could be shown: expected a "
                f"scenario of a soft body that is touched; the first says: {reason}"
            )


def _write(out: Path, arguments: argparse.Namespace, found: Sequence[_Of], truth: str) -> None:
    table = [row for of in found for row in _rows(of)]
    write_results(out, table, COLUMNS)
    write_whole(out / MESHES, _meshes_csv(found).encode())
    write_whole(out / WALL, _wall_csv(found).encode())
    period = max(
        float(str(m.record.metrics[_BUDGET])) for of in found for m in of.measured if m.drawn
    )
    draw(out / "models.png", [(of.scene.name, of.measured, of.mesh) for of in found], period)
    for of in found:
        answer = words(of.scene.name, of.measured, of.mesh, truth)
        _page(out, arguments, of, answer, period)
        print("\n".join(answer) + "\n")
        _print(of)
    print(LEFT_OUT + "\n")


def _page(
    out: Path, arguments: argparse.Namespace, of: _Of, answer: Sequence[str], period: float
) -> None:
    """One a scene: errors of different bodies do not belong into one plot."""
    frame = pd.read_csv(out / CSV, keep_default_na=False, na_values=[""])
    write_study_report(
        out / of.scene.name,
        title=f"What accuracy costs, across models: {of.scene.name}",
        frame=frame[frame["scene"] == of.scene.name].reset_index(drop=True),
        units={column.name: column.unit for column in COLUMNS if column.unit},
        helps={column.name: column.help for column in COLUMNS},
        plots=[
            _plot(norm, colour, period)
            for norm in (FORCE, DISPLACEMENT)
            for colour in ("law", "solver")
        ],
        words=[*answer, LEFT_OUT],
        commands=[command_of(arguments, "study accuracy")],
        versions={
            "hvp": of.scene.session.program.version,
            "python": platform.python_version(),
        },
    )


def _plot(norm: str, colour: str, period: float) -> Plot:
    what, of = norm.split("_")
    return Plot(
        "worst_us",
        norm,
        colour=colour,
        title=f"{what.capitalize()} by {colour}: {_NORM_HELP[of]}",
        help=_READING,
        log_x=True,
        log_y=True,
        budget=NOTICEABLE[0] if what == "force" else None,
        budget_x=period,
    )


def _print(of: _Of) -> None:
    best = best_of_families(of.measured)
    states = pd.Series([m.state for m in of.measured]).value_counts().sort_index()
    counts = ", ".join(f"{count} {state}" for state, count in states.items())
    print(f"{of.scene.name}: {count_of(len(of.measured), 'member')}: {counts}. The fronts:\n")
    names = ("member", "state", "force_p95", "displacement_p95", "worst_us", "memory")
    rows = [
        (describe(m), m.state, m.error(FORCE), m.error(DISPLACEMENT), m.worst_us, m.memory_share)
        for m in best
    ]
    print(text_table(names, rows) + "\n")


def _rows(of: _Of) -> list[dict[str, Value]]:
    families: dict[str, list[Measured]] = {}
    for one in of.measured:
        families.setdefault(one.member.family, []).append(one)
    best = [m for members in families.values() for m in front(members, FORCE)]
    return [_row(of.scene.name, one, any(one is m for m in best)) for one in of.measured]


def _row(scene: str, one: Measured, on_front: bool) -> dict[str, Value]:
    figures = one.record.metrics
    row: dict[str, Any] = {
        "scene": scene,
        "family": one.member.family,
        "law": one.member.law,
        "solver": one.member.solver,
        **columns_of(one),
        "state": one.state,
        "status": one.record.status,
        "message": one.message,
        **{norm: one.error(norm) for norm in NORMS},
        "worst_us": one.worst_us,
        "median_us": figures.get(MEDIAN),
        "load_worst_us": figures.get(LOAD),
        "load_median_us": one.load_median_us,
        "set_up_us": figures.get("set_up_us"),
        "memory_share": one.memory_share,
        "front": on_front,
        "flags": " ".join(one.accurate.flags),
        "address": one.record.address,
    }
    return row


def _meshes_csv(found: Sequence[_Of]) -> str:
    """Every mesh of the true law, and what its size's force tends to."""
    rows: list[tuple[str, str, int, float, float | None]] = []
    for of in found:
        limit = of.mesh.limit.force if of.mesh.limit else None
        own = of.mesh.of_own_size
        apart = [own] if own is not None and own not in of.mesh.sizes else []
        for size in (*apart, *of.mesh.sizes):
            rows += [
                (of.scene.name, size.elements, nodes, force, limit)
                for nodes, force in zip(size.nodes, size.forces, strict=True)
            ]
    frame = pd.DataFrame(rows, columns=["scene", "elements", "nodes", "force_N", "limit_N"])
    return str(frame.to_csv(index=False))


def _wall_csv(found: Sequence[_Of]) -> str:
    """What the simulator took on the machine that made the record: no figure of the design."""
    rows = [
        (of.scene.name, describe(m), m.set_up_s, m.record.wall_s, m.peak_memory_mb)
        for of in found
        for m in of.measured
    ]
    columns = ["scene", "member", "set_up_s", "run_s", "peak_memory_mb"]
    return str(pd.DataFrame(rows, columns=columns).to_csv(index=False))
