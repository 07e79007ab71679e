"""What a run answers, and how far another run's answers are from it."""

import io
import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from studies.record import Record
from studies.store import Store

# The files of a run that its answers are taken from.
KEEP = ("frames.csv", "summary.json")

# What tolerances are given for. An answer without one (None) is not asked for.
ANSWERS = ("latency", "misses", "force", "displacement", "accuracy", "stability", "condition")
DEFAULT_TOLERANCE = 0.01
_PORT = re.compile(r"(?:probe\d+_)?port_J")

Tolerances = Mapping[str, float | None]


@dataclass(frozen=True)
class Answers:
    """A run's record with its frames and its summary."""

    record: Record
    frames: pd.DataFrame
    effects: tuple[str, ...]
    struck: int
    spectral: bool

    @cached_property
    def force(self) -> pd.DataFrame | None:
        """The force on each probe by frames, N, three columns a probe; nothing without one."""
        force = self._of_probes("f{}_N")
        return None if force.isna().to_numpy().any() else force

    @cached_property
    def tip(self) -> pd.DataFrame:
        """Where each tip was by frames, m; without [device.dynamics] where it was meant to be."""
        return self._of_probes("tip_{}_m" if self.closed else "{}_m")

    @property
    def ports(self) -> list[str]:
        """The columns of the energy that went through each probe's port, J."""
        return [name for name in self.frames.columns if _PORT.fullmatch(name)]

    def _of_probes(self, name: str) -> pd.DataFrame:
        """The columns x, y, z of a name of the first probe and of the others (probe1_ and on)."""
        column = re.compile(r"(?:probe\d+_)?" + name.format("[xyz]"))
        return self.frames[[c for c in self.frames.columns if column.fullmatch(c)]]

    @property
    def closed(self) -> bool:
        """Whether forces move the device, so that two runs have two trajectories."""
        return "tip_x_m" in self.frames

    def figure(self, name: str) -> float | None:
        """A declared figure as a number, or nothing."""
        value = self.record.metrics.get(name)
        return float(value) if isinstance(value, int | float) else None

    @property
    def fidelity(self) -> dict[str, str | None]:
        """Level by part."""
        start = "fidelity."
        return {
            name.removeprefix(start): None if value is None else str(value)
            for name, value in self.record.metrics.items()
            if name.startswith(start)
        }


def read_answers(store: Store, record: Record) -> Answers:
    """From what the store kept."""
    summary = json.loads(store.file(record.address, "summary.json").read_bytes())
    frames = pd.read_csv(io.BytesIO(store.file(record.address, "frames.csv").read_bytes()))
    return Answers(
        record,
        frames.set_index("frame"),
        tuple(summary["effects"]),
        struck=sum(fault["injected"] for fault in summary["faults"]),
        spectral=summary["condition"] is not None,
    )


@dataclass(frozen=True)
class Influence:
    """How far one run's answers are from another one's; None where neither run has the answer.

    Relative, but for `misses` (a share of the frames) and `accuracy` (a difference of errors, which
    are relative themselves); of several probes the one that differs most, relative to the largest
    of all. `lost` are answers that the other run no longer gives, `verdict` is its own where one of
    both held the budgets and one did not, `unshared` the frames that only one of both has.
    """

    latency: float | None = None
    p99: float | None = None
    misses: float | None = None
    force: float | None = None
    force_rms: float | None = None
    displacement: float | None = None
    accuracy: float | None = None
    stability: float | None = None
    condition: float | None = None
    flags: tuple[str, ...] = ()
    verdict: str = ""
    lost: tuple[str, ...] = ()
    unshared: int = 0
    same_frames: bool = field(default=False)

    def score(self, tolerances: Tolerances) -> float:
        """The largest influence in units of its tolerance; beyond 1 an answer is not kept."""
        return math.inf if self._turned(tolerances) else self.size(tolerances)

    def why(self, tolerances: Tolerances) -> str:
        """Why an answer is not kept, in words."""
        return self._turned(tolerances) or "moves an answer beyond its tolerance"

    def _turned(self, tolerances: Tolerances) -> str:
        """What no tolerance can be given for: an answer lost, another verdict, other flags."""
        asked = [answer for answer in ANSWERS if tolerances[answer] is not None]
        if gone := [answer for answer in asked if answer in self.lost]:
            return f"no longer answers {' and '.join(gone)}"
        if "misses" in asked and self.verdict:
            return f"the budgets are then {self.verdict}"
        if "stability" in asked and self.flags:
            return f"changes flags: {' '.join(self.flags)}"
        return ""

    def size(self, tolerances: Tolerances) -> float:
        """As the score, without what is lost and the flags."""
        worst = 0.0
        for answer in ANSWERS:
            tolerance = tolerances[answer]
            if tolerance is None:
                continue
            value = getattr(self, answer)
            if answer == "latency" and value is not None:
                value = max(value, self.p99 or 0.0)
            if value:
                worst = max(worst, value / tolerance if tolerance > 0 else math.inf)
        return worst


def influence(
    base: Answers, other: Answers, measured_flags: frozenset[str] = frozenset()
) -> Influence:
    """Of what `other` has else than `base`, on each answer.

    `measured_flags` are raised by what measures accuracy: without it they are not answered, or by
    other means, which is no change of theirs.
    """
    lost: list[str] = []

    def lose(answer: str, had: object, has: object) -> bool:
        if had is not None and has is None and answer not in lost:
            lost.append(answer)
        return had is not None and has is not None

    # A latency of nanoseconds is no scale for another one.
    least_us = (base.figure("deadline.budget_us") or 1.0) / 100

    def relative(answer: str, name: str, least: float = 0.0) -> float | None:
        had, has = base.figure(name), other.figure(name)
        if not lose(answer, had, has) or had is None or has is None:
            return None
        return _relative(has - had, max(abs(had), least))

    def difference(answer: str, name: str) -> float | None:
        had, has = base.figure(name), other.figure(name)
        if not lose(answer, had, has) or had is None or has is None:
            return None
        return abs(has - had)

    shared = base.frames.index.intersection(other.frames.index)
    force = _force(base, other, shared) if lose("force", base.force, other.force) else None
    if force is None and base.force is not None and "force" not in lost and len(base.frames):
        lost.append("force")  # no frame, or not the probes, in common
    load = relative("latency", "load.worst_us", least_us)
    worst = relative("latency", "deadline.worst_us", least_us)
    accuracies = [
        difference("accuracy", f"accuracy.{name}_of_frame.p95")
        for name in ("displacement", "force")
    ]
    stabilities = [
        relative("stability", "stiffness.stable_N_m"),
        relative("stability", "stiffness.passive_N_m"),
        _port(base, other),
    ]
    displacements = [relative("displacement", "strain.largest"), _tip(base, other, shared)]
    return Influence(
        latency=_largest([worst, load]),
        p99=relative("latency", "deadline.p99_us", least_us),
        misses=_largest([_share(base, other, "deadline"), _share(base, other, "load")]),
        force=force[0] if force else None,
        force_rms=force[1] if force else None,
        displacement=_largest(displacements),
        accuracy=_largest(accuracies),
        stability=_largest(stabilities),
        condition=_spectral(base, other, lost),
        flags=tuple(
            flag
            for flag in _flag_changes(base.record.flags, other.record.flags)
            if "accuracy" not in lost or flag[1:] not in measured_flags
        ),
        verdict="" if other.record.status == base.record.status else other.record.status,
        lost=tuple(lost),
        unshared=len(base.frames.index.symmetric_difference(other.frames.index)),
        same_frames=base.frames.equals(other.frames),
    )


def _relative(change: float, scale: float) -> float:
    if change == 0:
        return 0.0
    return abs(change) / scale if scale > 0 else math.inf


def _largest(values: list[float | None]) -> float | None:
    return max((value for value in values if value is not None), default=None)


def _share(base: Answers, other: Answers, part: str) -> float | None:
    shares = []
    for run in (base, other):
        misses = run.figure(f"{part}.misses")
        frames = run.figure("frames_asked")
        if misses is None or not frames:
            return None
        skipped = run.figure("deadline.skipped_ticks") or 0.0
        shares.append((misses + skipped) / frames)
    return abs(shares[1] - shares[0])


def _force(base: Answers, other: Answers, shared: pd.Index) -> tuple[float, float] | None:
    if base.force is None or other.force is None or not len(shared):
        return None
    own, theirs = base.force.loc[shared].to_numpy(), other.force.loc[shared].to_numpy()
    if own.shape != theirs.shape:
        return None
    change = lengths(theirs - own)
    largest = largest_length(base.force.to_numpy())
    return (
        _relative(float(change.max()), largest),
        _relative(float(np.sqrt(np.mean(change**2, axis=0)).max()), largest),
    )


def lengths(vectors: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Of each probe's three components, a row a frame."""
    each: npt.NDArray[Any] = np.linalg.norm(vectors.reshape(len(vectors), -1, 3), axis=2)
    return each


def largest_length(vectors: npt.NDArray[Any]) -> float:
    """Of all frames and probes."""
    return float(lengths(vectors).max())


def _spectral(base: Answers, other: Answers, lost: list[str]) -> float | None:
    if base.spectral and not other.spectral:
        lost.append("condition")
    return 0.0 if base.spectral and other.spectral else None


def _tip(base: Answers, other: Answers, shared: pd.Index) -> float | None:
    if not (base.closed and other.closed) or not len(shared):
        return None
    own, theirs = base.tip.loc[shared].to_numpy(), other.tip.loc[shared].to_numpy()
    if own.shape != theirs.shape:
        return None
    return _relative(largest_length(theirs - own), float(np.ptp(own, axis=0).max()))


def _port(base: Answers, other: Answers) -> float | None:
    if not base.ports or base.ports != other.ports or not (len(base.frames) and len(other.frames)):
        return None
    own, theirs = base.frames[base.ports], other.frames[other.ports]
    lowest = (theirs.min() - own.min()).abs().max()
    last = (theirs.iloc[-1] - own.iloc[-1]).abs().max()
    return _relative(float(max(lowest, last)), float(own.abs().to_numpy().max()))


def _flag_changes(had: list[str], has: list[str]) -> tuple[str, ...]:
    return tuple(
        [f"+{flag}" for flag in has if flag not in had]
        + [f"-{flag}" for flag in had if flag not in has]
    )
