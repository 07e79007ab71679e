"""What runs cost in wall-clock time on this machine. No part of what a study's bytes are."""

import json
import statistics
from collections.abc import Mapping
from dataclasses import dataclass, replace

from studies.point import Point
from studies.program import Program
from studies.worker import execute

# A run that takes longer is long enough to be timed once, s.
_LONG_S = 3.0


@dataclass(frozen=True)
class Cost:
    """Of a run: the median of its repeats, and the shortest and the longest, s.

    `wall_s` is the program's own account of set-up and simulation, `simulate_s` the simulation's
    part of it; `per_simulated_s` that by the simulated time.
    """

    wall_s: float
    least_s: float
    most_s: float
    simulate_s: float
    per_simulated_s: float
    repeats: int


def measure(program: Program, points: Mapping[str, Point], repeats: int) -> dict[str, Cost]:
    """One run at a time, round after round, so that a slower minute meets all points alike."""
    taken: dict[str, list[tuple[float, float, float]]] = {name: [] for name in points}
    for _ in range(repeats):
        for name, point in points.items():
            rounds = taken[name]
            if rounds and rounds[0][0] > _LONG_S:
                continue
            _, files = execute(program.path, replace(point, keep=("performance.json",)), "")
            if "performance.json" in files:
                figures = json.loads(files["performance.json"])
                simulate = figures["simulate_s"]
                rounds.append(
                    (figures["build_scene_s"] + simulate, simulate, figures["simulated_s"])
                )
    return {name: _cost(rounds) for name, rounds in taken.items() if rounds}


def _cost(rounds: list[tuple[float, float, float]]) -> Cost:
    walls = [wall for wall, _, _ in rounds]
    simulate = statistics.median(simulate for _, simulate, _ in rounds)
    simulated = rounds[0][2]
    return Cost(
        statistics.median(walls),
        min(walls),
        max(walls),
        simulate,
        simulate / simulated if simulated > 0 else 0.0,
        len(rounds),
    )
