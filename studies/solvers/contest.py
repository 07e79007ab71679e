"""The solvers that are tried on a scenario, and what each cannot do."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.errors import InputError
from studies.point import Point
from studies.program import Program, Refused, Resolved

SOLVER = "host.solver"
PRECISION = "host.precision"
MODEL = "host.model"
LAUNCH = "host.gpu.launch"
BOARD = "board"
_PASSES = "refinement"
# Effects that draw what a frame takes.
_DRAWN = (
    "host.jitter",
    "host.wake_up",
    "host.interrupt_latencies",
    "bus.traffic",
    "bus.graphics_traffic",
    "bus.read_latencies",
    "bus.pcie.root_complex_latencies",
)
# Hosts that the program has figures for.
HOSTS = ("thesis-pc", "desktop-2026")
MEASURED = "measured"


@dataclass(frozen=True)
class Solver:
    """A way to solve a frame. `limits` is what it cannot do, whatever the scenario."""

    name: str
    precision: str = ""
    limits: str = ""
    launch: str = ""  # of a GPU, which then makes the solve

    @property
    def label(self) -> str:
        """As tables call it."""
        gpu = f"GPU, {self.launch}" if self.launch else ""
        return ", ".join(filter(None, (self.name, self.precision, gpu)))

    @property
    def overrides(self) -> tuple[str, ...]:
        """For `--set`."""
        chosen = [f"{SOLVER}={self.name}"]
        if self.precision:
            chosen.append(f"{PRECISION}={self.precision}")
        if self.launch:
            chosen.append(f"{LAUNCH}={self.launch}")
        return tuple(chosen)


SOLVERS = (
    Solver(BOARD, limits="a matrix that changes takes a transfer of it"),
    Solver("cg", "double", "its error is that of its iterations"),
    Solver("cg", "single", "as in double precision; 7 digits"),
    Solver("cholesky", limits="new factors where the matrix changes"),
    Solver("inverse", "double", "a new inverse where the matrix changes; memory n²"),
    Solver("inverse", "single", "as in double precision; 7 digits"),
    Solver("condensed", "double", "contact at the surface alone; a new inverse as above"),
    Solver("condensed", "single", "as in double precision; 7 digits"),
    Solver("superposition", "double", "a static linear body, contact at the surface alone"),
    Solver("superposition", "single", "as in double precision; 7 digits"),
    Solver("cg", "double", "its error is that of its iterations", "graph"),
    Solver("cg", "single", "as in double precision; 7 digits", "persistent"),
    Solver("inverse", "double", "a new inverse where the matrix changes; memory n²", "graph"),
    Solver("inverse", "single", "as in double precision; 7 digits", "persistent"),
)


def solvers_of(host: str) -> tuple[Solver, ...]:
    """Those that are tried on a host: the thesis' PC has no GPU to compute with."""
    return tuple(one for one in SOLVERS if host != HOSTS[0] or not one.launch)


@dataclass(frozen=True)
class Entry:
    """A solver on a host. `drawn`: what a frame takes is, so that a miss has a probability."""

    host: str
    solver: Solver
    point: Point
    drawn: bool = False


@dataclass(frozen=True)
class Contest:
    """All that is tried, and what the hosts do without."""

    entries: tuple[Entry, ...]
    left_out: tuple[str, ...]


def without_board(reference: Mapping[str, Any], scenario: Mapping[str, Any]) -> tuple[str, ...]:
    """What a scenario has to leave for a host to solve it: effects that need a board, how frames
    get there, and passes that mend a board's words."""
    changes = []
    for effect in reference["effects"]:
        needs_board = any(
            need["key"] == SOLVER and need["values"] == [BOARD] for need in effect["needs"]
        )
        # The passes are a host's own too where the body is not linear; the declaration is of one
        # that is.
        if needs_board and effect["path"] != _PASSES and _has(scenario, effect["path"]):
            changes.append(f"{effect['path']}={'[]' if effect['list'] else 'false'}")
    defaults = {key["path"]: key["default"] for key in reference["keys"]}
    transfer = scenario.get("transfer", {})
    for key in ("method", "notification", "packed"):
        plain = defaults[f"transfer.{key}"]
        if transfer.get(key, plain) != plain:
            changes.append(f"transfer.{key}={str(plain).lower()}")
    law = scenario.get("object", {}).get("model", {}).get("kind", "linear")
    if law == "linear" and _PASSES in scenario:
        changes.append(f"{_PASSES}=false")
    if scenario.get("host", {}).get("pipeline_depth"):
        changes.append("host.pipeline_depth=0")
    return tuple(changes)


def _has(scenario: Mapping[str, Any], path: str) -> bool:
    table: Any = scenario
    for part in path.split("."):
        if not isinstance(table, dict) or part not in table:
            return False
        table = table[part]
    return bool(table)


def contest(
    program: Program, scenario: Path, settings: tuple[str, ...], measured: Path | None
) -> Contest:
    """Every solver on every host. Throws InputError for the scenario itself, for a change of what
    is compared, and for a file that no measurement wrote."""
    for setting in settings:
        key = setting.partition("=")[0].strip()
        if key in (SOLVER, PRECISION, MODEL):
            raise InputError(f"--set {setting}: is what is compared: expected another key")
    if measured:
        _require_measured(measured)
    # Whoever solves is held against the true model,
    # in every frame: an error that is formed over a tenth of the frames says nothing of the others.
    settings = (*settings, "reference=true", "reference.every_frames=1")
    resolved = next(program.resolve(scenario, [settings]))
    if isinstance(resolved, Refused):
        raise InputError(resolved.message)
    assert isinstance(resolved, Resolved)
    tables = tomllib.loads(resolved.text)
    if tables.get("host", {}).get("solver") == "explicit":
        raise InputError(
            f"{scenario}: host.solver: explicit steps solve nothing: expected a scenario that does"
        )
    without = without_board(program.reference, tables)
    drawn = any(_has(tables, effect) for effect in _DRAWN)
    hosts: list[tuple[str, tuple[str, ...], tuple[Path, ...]]] = [
        (name, (f"{MODEL}={name}",), ()) for name in HOSTS
    ]
    if measured:
        hosts.append((MEASURED, (), (measured,)))
    found = []
    for name, of_host, includes in hosts:
        for solver in solvers_of(name):
            changes = solver.overrides if solver.name == BOARD else (*without, *solver.overrides)
            point = Point(scenario, (*settings, *of_host, *changes), {}, includes=includes)
            found.append(Entry(name, solver, point, drawn or name == MEASURED))
    return Contest(tuple(found), tuple(change.partition("=")[0] for change in without))


def _require_measured(file: Path) -> None:
    try:
        host = tomllib.loads(file.read_text(encoding="utf-8")).get("host", {})
    except (OSError, ValueError) as error:
        raise InputError(f"--host {file}: {error}") from error
    if not isinstance(host, dict) or host.get("model") != MEASURED:
        raise InputError(
            f'--host {file}: expected a file with host.model = "{MEASURED}", as hvp measure host '
            "writes it"
        )
