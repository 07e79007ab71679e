"""What is known of a point once it has been run: a line of every table."""

import json
import sys
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

from studies.point import Value

Status = Literal["held", "not held", "refused", "crashed", "timed out"]


@dataclass(frozen=True)
class Record:
    """Of one run.

    `refused` is wrong input, with the line that says so; `crashed` a signal or an exit status that
    hvp does not have for results. `metrics` are the scalars of the command's JSON by their dotted
    names. `wall_s` is the host's time, s: the only thing that differs between two runs of one
    program and scenario.
    """

    address: str
    status: Status
    exit: int
    message: str = ""
    verdict: str = ""
    flags: list[str] = field(default_factory=list)
    metrics: dict[str, Value] = field(default_factory=dict)
    wall_s: float = 0.0

    @property
    def failed(self) -> bool:
        """Whether it has no figures through no fault of its input."""
        return self.status in ("crashed", "timed out")

    @property
    def done(self) -> bool:
        """Whether it has figures."""
        return self.status in ("held", "not held")

    def to_json(self) -> str:
        """One JSON object with sorted keys, so that equal records are equal bytes."""
        return json.dumps(asdict(self), sort_keys=True, allow_nan=False, ensure_ascii=False) + "\n"

    @staticmethod
    def from_json(text: str) -> "Record":
        """Inverse of to_json. Throws ValueError for what is none."""
        try:
            record = Record(**json.loads(text))
            names = {sys.intern(name): value for name, value in record.metrics.items()}
            return replace(record, metrics=names)
        except (TypeError, AttributeError) as error:
            raise ValueError(str(error)) from error


def flatten(value: Any, path: str = "") -> dict[str, Value]:
    """The scalars of nested tables by their dotted names.

    Of lists those are taken whose entries are each of a type, as resources[M4K].used; the others
    are distributions, or as long as the run.
    """
    if isinstance(value, dict):
        flat: dict[str, Value] = {}
        for key, item in value.items():
            flat |= flatten(item, f"{path}.{key}" if path else key)
        return flat
    if isinstance(value, list):
        typed = [item for item in value if isinstance(item, dict) and "type" in item]
        return {
            name: figure
            for item in typed
            for name, figure in flatten(
                {key: of for key, of in item.items() if key != "type"}, f"{path}[{item['type']}]"
            ).items()
        }
    return {sys.intern(path): value}  # ten thousand records have the same names
