"""What differs between two runs frame by frame. Frames are held against each other by their tick's
time, not by their number: with other periods, frames of one number are of other times."""

import re
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from studies.run_folder import RunFolder

Column = npt.NDArray[np.float64]
_FORCE = re.compile(r"(probe\d+_)?fx_N")


@dataclass(frozen=True)
class Where:
    """Two values of the frames of one tick, and by how much they differ.

    `frame` and `other_frame` are the frames' numbers in the first and in the other run. Forces are
    in N, and `difference` is that of the vectors; latencies in µs.
    """

    frame: int
    other_frame: int
    time_us: float
    values: tuple[float, float]
    difference: float
    probe: int = 0


@dataclass(frozen=True)
class FrameDifferences:
    """Of one run against the first. What could not be compared is None, `left_out` says why."""

    frames: tuple[int, int] = (0, 0)
    common: int = 0  # frames of ticks that both have
    first_force: Where | None = None
    largest_force: Where | None = None
    largest_latency: Where | None = None
    forces_compared: bool = False
    left_out: tuple[str, ...] = ()

    @property
    def differ(self) -> bool:
        return (
            bool(self.left_out)
            or self.frames != (self.common, self.common)
            or self.first_force is not None
            or self.largest_latency is not None
        )


def compare_frames(base: RunFolder, other: RunFolder) -> FrameDifferences:
    """Hold the frames of a run against those of another."""
    if base.frames is None or other.frames is None:
        without = [str(run.path) for run in (base, other) if run.frames is None]
        return FrameDifferences(left_out=(f"no frames.csv in {' and '.join(without)}",))
    both = base.frames.merge(other.frames, on="born_us", suffixes=("", "_other"))
    sizes = (len(base.frames), len(other.frames))
    if both.empty:
        return FrameDifferences(sizes, left_out=("no tick that both have a frame of",))
    latencies = both["latency_us"].to_numpy(float), both["latency_us_other"].to_numpy(float)
    later = np.abs(latencies[1] - latencies[0])
    row = int(np.argmax(later))
    probes, left_out = _probes(both, base.frames, other.frames)
    first, largest = _forces(both, probes)
    return FrameDifferences(
        sizes,
        len(both),
        first,
        largest,
        _where(both, row, latencies, later) if later[row] > 0 else None,
        bool(probes),
        left_out,
    )


def _probes(
    both: pd.DataFrame, base: pd.DataFrame, other: pd.DataFrame
) -> tuple[list[str], tuple[str, ...]]:
    """The prefixes of those probes whose force both have, and what is said of the others."""
    prefixes: list[str] = []
    left_out: list[str] = []
    for column in (name for name in both.columns if _FORCE.fullmatch(name)):
        prefix = column.removesuffix("fx_N")
        whose = f"of {prefix.removesuffix('_')} " if prefix else ""
        missing = [
            which
            for which, table in (("first", base), ("other", other))
            if column not in table or table[column].isna().all()
        ]
        if len(missing) == 1:
            left_out.append(f"no forces {whose}in the {missing[0]} run")
        elif not missing:
            prefixes.append(prefix)
    return prefixes, tuple(left_out)


def _forces(both: pd.DataFrame, probes: list[str]) -> tuple[Where | None, Where | None]:
    first: Where | None = None
    largest: Where | None = None
    for prefix in probes:
        probe = int(prefix.removeprefix("probe").removesuffix("_")) if prefix else 0
        components = [f"{prefix}f{axis}_N" for axis in "xyz"]
        here = both[components].to_numpy(dtype=float)
        there = both[[f"{name}_other" for name in components]].to_numpy(dtype=float)
        sizes = np.linalg.norm(here, axis=1), np.linalg.norm(there, axis=1)
        distance = np.nan_to_num(np.linalg.norm(there - here, axis=1), nan=0.0)
        if not distance.any():
            continue
        met = _where(both, int(np.argmax(distance > 0)), sizes, distance, probe)
        if first is None or met.time_us < first.time_us:
            first = met
        met = _where(both, int(np.argmax(distance)), sizes, distance, probe)
        if largest is None or met.difference > largest.difference:
            largest = met
    return first, largest


def _where(
    both: pd.DataFrame, row: int, values: tuple[Column, Column], difference: Column, probe: int = 0
) -> Where:
    one = both.iloc[row]
    return Where(
        int(one["frame"]),
        int(one["frame_other"]),
        float(one["born_us"]),
        (float(values[0][row]), float(values[1][row])),
        float(difference[row]),
        probe,
    )
