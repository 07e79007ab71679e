"""The solvers that are tried on a scenario, and what each cannot do."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.errors import InputError
from studies.point import Point
from studies.program import Program, Refused, Resolved

SOLVER = "host.solver"
PRECISION = "host.precision"
MODEL = "host.model"
BOARD = "board"
_PASSES = "refinement"
# Hosts that the program has figures for.
HOSTS = ("thesis-pc", "desktop-2026")
MEASURED = "measured"


@dataclass(frozen=True)
class Solver:
    """A way to solve a frame. `limits` is what it cannot do, whatever the scenario."""

    name: str
    precision: str = ""
    limits: str = ""

    @property
    def label(self) -> str:
        """As tables call it."""
        return f"{self.name}, {self.precision}" if self.precision else self.name

    @property
    def overrides(self) -> tuple[str, ...]:
        """For `--set`."""
        chosen = [f"{SOLVER}={self.name}"]
        if self.precision:
            chosen.append(f"{PRECISION}={self.precision}")
        return tuple(chosen)


SOLVERS = (
    Solver(BOARD, limits="a matrix that changes takes a transfer of it"),
    Solver("cg", limits="its error is that of its iterations"),
    Solver("cholesky", limits="new factors where the matrix changes"),
    Solver("inverse", "double", "a new inverse where the matrix changes; memory n²"),
    Solver("inverse", "single", "as in double precision; 7 digits"),
    Solver("condensed", "double", "contact at the surface alone; a new inverse as above"),
    Solver("condensed", "single", "as in double precision; 7 digits"),
    Solver("superposition", "double", "a static linear body, contact at the surface alone"),
    Solver("superposition", "single", "as in double precision; 7 digits"),
)


@dataclass(frozen=True)
class Entry:
    """A solver on a host."""

    host: str
    solver: Solver
    point: Point


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


def entries(
    program: Program, scenario: Path, settings: tuple[str, ...], measured: Path | None
) -> Iterator[Entry]:
    """Every solver on every host. Throws InputError for the scenario itself."""
    resolved = next(program.resolve(scenario, [settings]))
    if isinstance(resolved, Refused):
        raise InputError(resolved.message)
    assert isinstance(resolved, Resolved)
    without = without_board(program.reference, tomllib.loads(resolved.text))
    hosts: list[tuple[str, tuple[str, ...], tuple[Path, ...]]] = [
        (name, (f"{MODEL}={name}",), ()) for name in HOSTS
    ]
    if measured:
        hosts.append((MEASURED, (), (measured,)))
    for name, of_host, includes in hosts:
        for solver in SOLVERS:
            changes = solver.overrides if solver.name == BOARD else (*without, *solver.overrides)
            yield Entry(
                name,
                solver,
                Point(scenario, (*settings, *of_host, *changes), {}, includes=includes),
            )
