"""The sets of settings whose accuracy is held against their time, and the scenario's own."""

from collections.abc import Mapping
from itertools import product
from typing import Any

from studies.accuracy.partitions import KEY as PARTITIONS
from studies.point import Value

METHOD = "solver.method"
ITERATIONS = "solver.iterations"
MATRIX_BITS = "solver.matrix_bits"
VECTOR_BITS = "solver.vector_bits"
SCALING = "solver.matrix_scaling"
PASSES = "refinement.passes"
NODES = "object.mesh.nodes"
MEMORY = "memory"  # a column whose value is KEY=VALUE: another memory for one of the structures

_METHODS = ("cg", "jacobi-pcg")
_ITERATIONS = (15, 30, 60, 120)
_WORDS = ((12, 16), (18, 24), (24, 32))
_LEAST_NODES = 40


def grid(full: bool, nodes: int | None) -> list[dict[str, Value]]:
    """Settings to be tried, the scenario's own (no setting) first."""
    methods = (*_METHODS, "block-jacobi-pcg") if full else _METHODS
    iterations = (8, *_ITERATIONS, 240) if full else _ITERATIONS
    points: list[dict[str, Value]] = [{}]
    points += [_columns(*chosen) for chosen in product(methods, iterations, _WORDS, (0, 2))]
    scaled = product(["cg"], iterations if full else (30, 60), _WORDS, (0, 2))
    points += [_columns(*chosen) | {SCALING: "diagonal"} for chosen in scaled]
    if nodes:
        sizes = (nodes // 4, nodes // 2, 2 * nodes) if full else (nodes // 2,)
        coarse = product(["cg"], (30, 60), _WORDS, (0,), sizes)
        points += [
            _columns(*chosen[:4]) | {NODES: chosen[4]}
            for chosen in coarse
            if chosen[4] >= _LEAST_NODES
        ]
    return points


def _columns(
    method: str, iterations: int, words: tuple[int, int], passes: int = 0
) -> dict[str, Value]:
    return {
        METHOD: method,
        ITERATIONS: iterations,
        MATRIX_BITS: words[0],
        VECTOR_BITS: words[1],
        PASSES: passes,
    }


def overrides_of(columns: Mapping[str, Value], has_refinement: bool) -> tuple[str, ...]:
    """For `--set`: no passes means no refinement at all."""
    settings = []
    for key, value in columns.items():
        if key == PASSES and not value:
            settings += ["refinement=false"] if has_refinement else []
        elif key == MEMORY:
            settings.append(str(value))
        else:
            settings.append(f"{key}={value}")
    return tuple(settings)


def own_settings(scenario: Mapping[str, Any]) -> dict[str, Value]:
    """Those of a scenario as it is resolved. No passes: it has no refinement."""
    own: dict[str, Value] = {PASSES: 0}
    for key in (METHOD, ITERATIONS, MATRIX_BITS, VECTOR_BITS, SCALING, PASSES, NODES, PARTITIONS):
        value: Any = scenario
        for part in key.split("."):
            value = value.get(part) if isinstance(value, Mapping) else None
        if isinstance(value, int | str):
            own[key] = value
    return own
