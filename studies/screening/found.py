"""What a screening has found."""

from dataclasses import dataclass, field

from studies.record import Record
from studies.screening.answers import Answers, Influence, Tolerances
from studies.screening.changes import Change, Choices
from studies.screening.exercise import Exercise


@dataclass(frozen=True)
class One:
    """A single change: its run, its influence, and why that may say nothing."""

    change: Change
    record: Record
    influence: Influence | None = None
    idle: str = ""  # why it was not exercised

    def matters(self, tolerances: Tolerances) -> bool:
        """Whether it moves an answer beyond its tolerance."""
        return self.influence is not None and self.influence.score(tolerances) > 1


@dataclass(frozen=True)
class Pair:
    """Two changes at once: what they do beyond the sum of what each does.

    `latency` and `p99` relative to the scenario's own, `force` the largest difference of a frame
    relative to the run's largest; None where a run of the three does not have it.
    """

    changes: tuple[Change, Change]
    record: Record
    latency: float | None = None
    p99: float | None = None
    force: float | None = None


@dataclass(frozen=True)
class Recommendation:
    """The least that keeps every answer, verified by a run of it as a whole."""

    changes: tuple[Change, ...]
    run: Answers
    influence: Influence
    rejected: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Screening:
    """All that was found of a scenario."""

    base: Answers
    exercised: Exercise
    choices: Choices
    ones: list[One]
    pairs: list[Pair]
    unpaired: list[str]
    recommendation: Recommendation
