"""A run of the program with a hard case's settings, and what it says of the loop."""

import csv
import json
import math
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plant_case import SCENE

REFUSED = 2
MILLIMETRE = 1e-3
WINDOW_S = 0.25  # of models/plant/loop_quality.h
FELT_M = 0.2e-6
SETTLES = 0.99


@dataclass(frozen=True)
class LoopRun:
    refusal: str  # empty: it ran
    summary: dict[str, Any]
    frames: list[dict[str, str]]
    said: str

    @property
    def loops(self) -> list[dict[str, Any]]:
        loops: list[dict[str, Any]] = self.summary["loop"]
        return loops

    @property
    def flags(self) -> list[str]:
        flags: list[str] = self.summary["stability"]["flags"]
        return flags

    @property
    def rests(self) -> bool:
        """As the program says."""
        return all(
            loop["oscillation_measured"]
            and loop["oscillation"] is None
            and loop["moves_on_m_s"] is None
            for loop in self.loops
        )

    def moves_in_the_end(self) -> bool:
        """As the positions of the last two quarters of a second say, where they are enough."""
        period_s = self.summary["deadline"]["period_us"] * 1e-6
        window = max(32, math.ceil(WINDOW_S / period_s))
        for axis in ("tip_x_m", "tip_y_m", "tip_z_m"):
            places = [float(frame[axis]) for frame in self.frames]
            before, last = places[-2 * window : -window], places[-window:]
            moved = max(last) - min(last)
            if moved > FELT_M and moved > SETTLES * (max(before) - min(before)):
                return True
        return False

    def ending(self) -> str:
        """Of the device that ends worst."""
        for loop in self.loops:
            cycle = loop["oscillation"]
            if cycle:
                grows = " and grows" if cycle["grows"] else ""
                amplitude = length(cycle["amplitude_m"])
                return f"swings by {amplitude} at {cycle['frequency_hz']:.0f} Hz{grows}"
        for loop in self.loops:
            if loop["moves_on_m_s"] is not None:
                return f"moves on at {loop['moves_on_m_s']:.2g} m/s"
        if self.moves_in_the_end():
            return "moves on, slowly"
        return "rests" if self.rests else "not seen to rest"


def two_digits(value: float) -> str:
    """Without an exponent."""
    return f"{float(f'{value:.2g}'):g}"


def length(metres: float) -> str:
    if metres >= MILLIMETRE:
        return f"{two_digits(metres * 1e3)} mm"
    return f"{two_digits(metres * 1e6)} um"


def run(program: Path, settings: tuple[str, ...]) -> LoopRun:
    with tempfile.TemporaryDirectory() as folder:
        scenario = Path(folder) / "plant.toml"
        scenario.write_text(SCENE, encoding="utf-8")
        results = Path(folder) / "results"
        command = [str(program), "run", str(scenario), "--out", str(results)]
        # The flags' own texts are wanted, not what a run tries of its own accord.
        for setting in (*settings, "output.remedies=false", "output.pictures=false"):
            command += ["--set", setting]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == REFUSED:
            return LoopRun(done.stderr.strip().replace(folder + "/", ""), {}, [], "")
        if done.returncode not in (0, 1):
            raise SystemExit(f"{' '.join(command)}: {done.returncode}\n{done.stderr}")
        with (results / "frames.csv").open(encoding="utf-8", newline="") as lines:
            frames = list(csv.DictReader(lines))
        summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
        return LoopRun("", summary, frames, done.stdout)
