"""The figures that a table shows of each run: their names checked, their units known."""

from collections.abc import Mapping, Sequence

from studies.errors import InputError
from studies.nearest import nearest
from studies.point import Value
from studies.program import Figure
from studies.record import Record
from studies.results import Column

FLAGS = Column("flags", "", "the flags that the run raised")
STATUS = Column("status", "", "held, not held, refused, crashed or timed out")
MESSAGE = Column("message", "", "why there are no figures")


def check_metric(where: str, name: str, known: Mapping[str, Figure]) -> Figure:
    """The declared figure of that name. Throws InputError with the nearest name."""
    if name in known and "[]" not in name:
        return known[name]
    if name in known or any(key.startswith(f"{name}[") for key in known):
        raise InputError(f"{where}: {name}: is a list, expected a figure with one value a run")
    raise InputError(f"{where}: unknown figure {name}{nearest(name, known)}")


def columns_of(metrics: Sequence[str], known: Mapping[str, Figure]) -> list[Column]:
    """The column of each figure."""
    return [Column(name, known[name].unit, known[name].help) for name in metrics]


def row_of(record: Record, metrics: Sequence[str]) -> dict[str, Value]:
    """The cells of a run besides its point's own."""
    row: dict[str, Value] = {name: record.metrics.get(name) for name in metrics}
    return row | {
        STATUS.name: record.status,
        FLAGS.name: " ".join(record.flags) if record.done else None,
        MESSAGE.name: None if record.done else record.message,
    }
