"""[search] of a study's file: what is wanted of the best point, and what is demanded."""

from typing import Literal

from pydantic import Field, model_validator

from studies.file_table import FileTable
from studies.point import Value

MOST_TRIALS = 100_000
_METRIC = (
    "a figure of docs/results-reference.md, `flags` (how many the run raised), or a size of the "
    "device: `device.logic_cells`, `device.multipliers`, `device.memory_bits`"
)


class Objective(FileTable):
    """A figure that is to be as small, or as large, as can be; of several the answer is all points
    that no other is better than in every one."""

    metric: str = Field(description=_METRIC)
    direction: Literal["minimise", "maximise"] = Field(
        default="minimise", description="which way is better"
    )

    @property
    def largest(self) -> bool:
        """Whether more is better."""
        return self.direction == "maximise"


class Bound(FileTable):
    """A figure that has to stay within bounds: either, or both."""

    metric: str = Field(description="as of an objective; yes counts as 1")
    at_most: float | None = Field(default=None, description="the largest value that will do")
    at_least: float | None = Field(default=None, description="the smallest")

    @model_validator(mode="after")
    def _check(self) -> "Bound":
        if self.at_most is None and self.at_least is None:
            raise ValueError("expected `at_most`, `at_least` or both")
        return self

    def violation(self, value: Value) -> float:
        """By how much it does not, relative to the bound; 0 where it does."""
        number = float(value) if isinstance(value, int | float) else 0.0
        over = number - self.at_most if self.at_most is not None else 0.0
        under = self.at_least - number if self.at_least is not None else 0.0
        bound = self.at_most if over >= under else self.at_least
        return max(over, under, 0.0) / (abs(bound or 0.0) or 1.0)

    @property
    def text(self) -> str:
        """In words."""
        bounds = []
        if self.at_most is not None:
            bounds.append(f"at most {self.at_most:g}")
        if self.at_least is not None:
            bounds.append(f"at least {self.at_least:g}")
        return f"{self.metric} {' and '.join(bounds)}"


class SearchTable(FileTable):
    """With it, `hvp study` looks for the best point of the axes in place of running all of them;
    `metrics`, `command`, `arguments`, `design`, `constraint` and `plot` have no place beside it."""

    trials: int = Field(
        default=100, ge=1, le=MOST_TRIALS, description="how many points may be proposed"
    )
    seed: int = Field(default=1, ge=0, description="of the proposals")
    objective: list[Objective] = Field(min_length=1, description="what is wanted")
    constraint: list[Bound] = Field(default=[], description="what is demanded")
