"""The figures that a table shows of each run: their names checked, their units known."""

import re
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


def declared_name(name: str) -> str:
    """The name as it is declared: of every entry of a list."""
    return re.sub(r"\[[^]]*\]", "[]", name)


def figure_of(name: str, known: Mapping[str, Figure]) -> Figure | None:
    """The declaration of a figure, also of one in a list: resources[M4K].used."""
    return known.get(name) or known.get(declared_name(name))


def check_metric(where: str, name: str, known: Mapping[str, Figure]) -> Figure:
    """The declared figure of that name. Throws InputError with the nearest name."""
    if name in known and "[]" not in name:
        return known[name]
    of_list = figure_of(name, known)
    if of_list and "[]" not in name and f"{of_list.name.rpartition('.')[0]}.type" in known:
        return of_list
    if of_list or any(key.startswith(f"{name}[") for key in known):
        raise InputError(f"{where}: {name}: is a list, expected a figure with one value a run")
    raise InputError(f"{where}: unknown figure {name}{nearest(name, known)}")


def columns_of(metrics: Sequence[str], known: Mapping[str, Figure]) -> list[Column]:
    """The column of each figure."""
    figures = [(name, figure_of(name, known)) for name in metrics]
    return [Column(name, of.unit if of else "", of.help if of else "") for name, of in figures]


def row_of(record: Record, metrics: Sequence[str]) -> dict[str, Value]:
    """The cells of a run besides its point's own."""
    row: dict[str, Value] = {name: record.metrics.get(name) for name in metrics}
    return row | {
        STATUS.name: record.status,
        FLAGS.name: " ".join(record.flags) if record.done else None,
        MESSAGE.name: None if record.done else record.message,
    }
