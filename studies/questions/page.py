"""The pages of the questions: docs/questions/, from results and the text beside each file."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from studies.errors import StudyError
from studies.questions import board, contacts, loop, numbers, renewals, solvers
from studies.questions.answer import Answer, Row, rows_of
from studies.questions.question_file import FOLDER, Question
from studies.record import Record

TOP = FOLDER.parents[1]
PAGES = TOP / "docs" / "questions"
PICTURES = TOP / "docs" / "images" / "questions"

ANSWERS: Mapping[str, Callable[[Sequence[Row]], Answer]] = {
    "solvers": solvers.solvers,
    "renewals": renewals.renewals,
    "partitions": board.partitions,
    "devices": board.devices,
    "word-lengths": numbers.word_lengths,
    "iterations": numbers.iterations,
    "links": loop.links,
    "mesh-rate": board.mesh_rate,
    "several-devices": board.several_devices,
    "stiffness": loop.stiffness,
    "jitter": loop.jitter,
    "effects-ladder": loop.effects_ladder,
    "contacts": contacts.contacts,
}

_MADE = "<!-- Made by `./hvp questions`: do not edit. -->"


def answer(question: Question, records: Sequence[Record]) -> Answer:
    """Throws StudyError for a run without figures: a question has none of those."""
    for record in records:
        if not record.done:
            raise StudyError(f"questions: {question.name}: {record.status}: {record.message}")
    return ANSWERS[question.name](rows_of(question, records))


def page(question: Question, made: Answer) -> str:
    """The page's text; its numbers are computed."""
    asked, reading = _text(question.name, made)
    table = [made.heading, ["---"] * len(made.heading), *made.table]
    return "\n".join(
        [
            f"# {question.title}",
            "",
            _MADE,
            "",
            asked,
            "",
            "<!-- not run: writes into the checkout -->",
            "```sh",
            f"./hvp questions {question.name}",
            "```",
            "",
            f"![{made.chart.title}](../images/questions/{question.name}.png)",
            "",
            *(f"| {' | '.join(cells)} |" for cells in table),
            "",
            reading,
            "",
            f"Runs: `studies/questions/{question.name}.toml`, of "
            f"[{question.scenario.name}](../../scenarios/{question.scenario.name}); "
            f"{len(question.points)} of `hvp {question.command}`. "
            "Tests: `tests/studies/test_questions.py`.",
            "",
        ]
    )


def index(answers: Mapping[str, tuple[Question, Answer]]) -> str:
    """The list of the pages, each with its answer in a line: the first sentence of its reading."""
    lines = [
        f"- [{question.title}]({name}.md): {_text(name, made)[1].splitlines()[0]}"
        for name, (question, made) in answers.items()
    ]
    return "\n".join(
        [
            "# Questions of an architect",
            "",
            _MADE,
            "",
            "What an architect asks before a board exists, each answered by runs. Tables and the",
            "numbers in the text are computed from their results.",
            "",
            *lines,
            "",
        ]
    )


def _text(name: str, made: Answer) -> tuple[str, str]:
    """What is asked, and how to read the answer: the two parts of the text beside the file."""
    template = Path(FOLDER / f"{name}.md").read_text(encoding="utf-8")
    asked, reading = template.split("\n---\n")
    return asked.strip().format(**made.facts), reading.strip().format(**made.facts)
