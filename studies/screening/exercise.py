"""What a run has exercised: an effect that had no occasion to act has not been shown to be idle."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.screening.answers import Answers

# A tip that moves by less in a frame than this share of its way's extent rests.
_REST = 1e-6


@dataclass(frozen=True)
class Exercise:
    """What happened in a run."""

    frames: int
    contact: int
    moving: int
    reversals: int
    struck: int
    late: int

    def words(self) -> str:
        """One line."""
        return (
            f"{self.frames} frames, {self.contact} in contact, {self.moving} with the tip moving, "
            f"{self.reversals} reversals of its motion, {self.late} late, "
            f"{self.struck} faults struck"
        )


def exercise(run: Answers) -> Exercise:
    """Of a run's frames."""
    steps = np.diff(run.tip.to_numpy(dtype=float), axis=0)
    extent = float(np.ptp(run.tip.to_numpy(dtype=float), axis=0).max()) if len(run.tip) else 0.0
    still = np.abs(steps) <= _REST * extent
    reversals = 0
    for axis in range(steps.shape[1]):
        signs = np.sign(steps[~still[:, axis], axis])
        reversals += int(np.count_nonzero(np.diff(signs)))
    in_contact = round((run.figure("contact.share") or 0.0) * len(run.frames))
    return Exercise(
        frames=len(run.frames),
        contact=in_contact,
        moving=int(np.count_nonzero(~still.all(axis=1))),
        reversals=reversals,
        struck=run.struck,
        late=int(run.figure("deadline.misses") or 0),
    )


# What has to happen for a part's effects to act, by the beginnings of their names: what a body or
# a wall does shows in contact alone, what a device does in motion. Of the others every frame is an
# occasion.
_OCCASIONS: tuple[tuple[str, Callable[[Exercise], bool], str], ...] = (
    ("device.friction", lambda e: e.reversals > 0, "the motion never reversed"),
    ("device.", lambda e: e.moving > 0, "the tip never moved"),
    ("hand", lambda e: e.moving > 0, "the tip never moved"),
    ("fault", lambda e: e.struck > 0, "no fault struck"),
    ("wall", lambda e: e.contact > 0, "no frame in contact"),
    ("loads.", lambda e: e.contact > 0, "no frame in contact"),
    ("dynamics", lambda e: e.contact > 0, "no frame in contact"),
    ("contact.", lambda e: e.contact > 0, "no frame in contact"),
    ("refinement", lambda e: e.contact > 0, "no frame in contact"),
    ("reference", lambda e: e.contact > 0, "no frame in contact"),
    ("fidelity.numbers", lambda e: e.contact > 0, "no frame in contact"),
)


def not_exercised(key: str, runs: tuple[Exercise, ...]) -> str:
    """Why an effect had no occasion to act in any of the runs; nothing where it had one."""
    for start, happened, why in _OCCASIONS:
        if key.startswith(start):
            return "" if any(happened(run) for run in runs) else why
    return "" if any(run.frames for run in runs) else "no frame"
