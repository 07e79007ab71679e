"""What a run answers, and how far another run's answers are from it."""

import io
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pandas as pd

from studies.record import Record
from studies.store import Store

# The files of a run that its answers are taken from.
KEEP = ("frames.csv", "summary.json")

# What tolerances are given for. An answer without one (None) is not asked for.
ANSWERS = ("latency", "misses", "force", "displacement", "accuracy", "stability", "condition")
DEFAULT_TOLERANCE = 0.01

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
        """The force on the probe by frames, N; nothing where nobody computed one."""
        force = self.frames[["fx_N", "fy_N", "fz_N"]]
        return None if force.isna().to_numpy().any() else force

    @cached_property
    def tip(self) -> pd.DataFrame:
        """Where the tip was by frames, m; without [device.dynamics] where it was meant to be."""
        kind = "tip_" if "tip_x_m" in self.frames else ""
        return self.frames[[f"{kind}{axis}_m" for axis in "xyz"]]

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
    are relative themselves). `lost` are answers that the other run no longer gives, `unshared` the
    frames that only one of both has.
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
    lost: tuple[str, ...] = ()
    unshared: int = 0
    same_frames: bool = field(default=False)

    def score(self, tolerances: Tolerances) -> float:
        """The largest influence in units of its tolerance; beyond 1 an answer is not kept."""
        asked = [answer for answer in ANSWERS if tolerances[answer] is not None]
        if any(answer in self.lost for answer in asked) or ("stability" in asked and self.flags):
            return math.inf
        return self.size(tolerances)

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
    load = relative("latency", "load.worst_us", least_us)
    worst = relative("latency", "deadline.worst_us", least_us)
    accuracies = [
        difference("accuracy", f"accuracy.{name}") for name in ("displacement_rel", "force_rel")
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
    own = base.force.loc[shared].to_numpy()
    change = np.linalg.norm(other.force.loc[shared].to_numpy() - own, axis=1)
    largest = float(np.linalg.norm(base.force.to_numpy(), axis=1).max())
    return (
        _relative(float(change.max()), largest),
        _relative(float(np.sqrt(np.mean(change**2))), largest),
    )


def _spectral(base: Answers, other: Answers, lost: list[str]) -> float | None:
    if base.spectral and not other.spectral:
        lost.append("condition")
    return 0.0 if base.spectral and other.spectral else None


def _tip(base: Answers, other: Answers, shared: pd.Index) -> float | None:
    if not (base.closed and other.closed) or not len(shared):
        return None
    own = base.tip.loc[shared].to_numpy()
    change = np.linalg.norm(other.tip.loc[shared].to_numpy() - own, axis=1)
    return _relative(float(change.max()), float(np.ptp(own, axis=0).max()))


def _port(base: Answers, other: Answers) -> float | None:
    if "port_J" not in base.frames or "port_J" not in other.frames:
        return None
    own, theirs = base.frames["port_J"], other.frames["port_J"]
    scale = float(own.abs().max())
    lowest = abs(float(theirs.min()) - float(own.min()))
    return _relative(max(lowest, abs(float(theirs.iloc[-1]) - float(own.iloc[-1]))), scale)


def _flag_changes(had: list[str], has: list[str]) -> tuple[str, ...]:
    return tuple(
        [f"+{flag}" for flag in has if flag not in had]
        + [f"-{flag}" for flag in had if flag not in has]
    )
