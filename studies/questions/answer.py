"""What is made of a question's records: a table, a picture, and the numbers of the text."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from studies.plot import Chart, Line
from studies.point import Value
from studies.questions.question_file import Question
from studies.record import Record

Row = dict[str, Any]

NONE = "\N{EN DASH}"
TIMES = "\N{MULTIPLICATION SIGN}"


@dataclass(frozen=True)
class Answer:
    """`facts` fill the page's text by name. The first column of `table` is its heading's."""

    heading: list[str]
    table: list[list[str]]
    chart: Chart
    facts: dict[str, str]


def rows_of(question: Question, records: Sequence[Record]) -> list[Row]:
    """A row a record: the axes' values, the question's metrics, flags, and `status`."""
    rows = []
    for point, record in zip(question.points, records, strict=True):
        metrics: dict[str, Value] = {name: record.metrics.get(name) for name in question.metrics}
        rows.append(point.columns | metrics | {"status": record.status, "flags": record.flags})
    return rows


def values(rows: Sequence[Row], column: str) -> list[Any]:
    """What a column has, each once, in the order of the rows."""
    return list(dict.fromkeys(row[column] for row in rows))


def where(rows: Sequence[Row], /, **equal: Any) -> list[Row]:
    """The rows with these values."""
    return [row for row in rows if all(row[key] == value for key, value in equal.items())]


def line(name: str, rows: Sequence[Row], x: str, y: str) -> Line:
    """One column over another."""
    return Line(name, [row[x] for row in rows], [row[y] for row in rows])


def cross(
    rows: Sequence[Row], down: str, across: str, cell: str, form: str = ".4g"
) -> tuple[list[str], list[list[str]]]:
    """Heading and lines of a table of one metric over two axes."""
    columns = values(rows, across)
    heading = [f"{down} \\ {across}", *(str(column) for column in columns)]
    lines = []
    for value in values(rows, down):
        of_line = {row[across]: row[cell] for row in rows if row[down] == value}
        lines.append([str(value), *(number(of_line.get(column), form) for column in columns)])
    return heading, lines


def number(value: Any, form: str = ".4g") -> str:
    """For people; NONE where there is none."""
    if value is None:
        return NONE
    return str(value) if isinstance(value, str) else format(value, form)


def quantity(text: str) -> float:
    """A time as scenarios have it, s."""
    figure, unit = text.split()
    return float(figure) * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]
