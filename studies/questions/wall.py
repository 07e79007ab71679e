"""What each run of a question costs in wall-clock time: of a machine, and so on no page."""

from collections.abc import Sequence

from studies.errors import InputError
from studies.point import Value
from studies.program import Program
from studies.questions.answer import rows_of
from studies.questions.question_file import Question
from studies.record import Record
from studies.results import Column
from studies.screening.timing import measure

WALL = Column("wall_s_per_s", "", "s of wall-clock time a second simulated: the median of repeats")
_SPREAD = (
    Column("wall_least_s", "s", "the shortest of the runs, set-up and simulation"),
    Column("wall_most_s", "s", "the longest of them"),
)


def wall_table(
    question: Question, records: Sequence[Record], program: Program, repeats: int
) -> tuple[list[Column], list[dict[str, Value]]]:
    """A row a run: what tells it apart, the question's figures, and what it takes.

    Throws InputError for a question whose command simulates nothing.
    """
    if question.command != "run":
        raise InputError(
            f"--wall: {question.name}: expected a question of hvp run, found one of hvp "
            f"{question.command}, which simulates nothing that could be timed"
        )
    costs = measure(
        program, {str(number): point for number, point in enumerate(question.points)}, repeats
    )
    axes = list(dict.fromkeys(name for point in question.points for name in point.columns))
    columns = [*(Column(name) for name in axes), *(Column(name) for name in question.metrics)]
    rows: list[dict[str, Value]] = []
    for number, row in enumerate(rows_of(question, records)):
        cost = costs[str(number)]
        rows.append(
            {column.name: row[column.name] for column in columns}
            | {
                WALL.name: cost.per_simulated_s,
                _SPREAD[0].name: cost.least_s,
                _SPREAD[1].name: cost.most_s,
            }
        )
    return [*columns, WALL, *_SPREAD], rows
