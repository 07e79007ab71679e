"""One run that a study asks for."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

Value = float | int | bool | str | None
Command = Literal["run", "device", "stability", "misses"]

# What a run writes for somebody who looks at it: a study does not, and asks for it where it does.
# They stand before a point's own overrides.
LEAN = (
    "output.pictures=false",
    "output.remedies=false",
    "output.deformation_every_frames=0",
    "output.trace_frames=0",
)


@dataclass(frozen=True)
class Point:
    """A scenario, what is changed in it, and what is asked of it.

    `columns` are what the point is called in tables: an axis' name and the value it has there.
    `overrides` are KEY=VALUE as `--set` takes them. `keep` names result files that are stored
    besides the figures, such as frames.csv.
    """

    scenario: Path
    overrides: tuple[str, ...] = ()
    columns: dict[str, Value] = field(default_factory=dict, hash=False)
    command: Command = "run"
    arguments: tuple[str, ...] = ()
    includes: tuple[Path, ...] = ()
    keep: tuple[str, ...] = ()

    @property
    def settings(self) -> tuple[str, ...]:
        """All that `--set` is given."""
        return (LEAN if self.command == "run" else ()) + self.overrides
