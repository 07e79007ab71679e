"""The studies behind the questions, in the order of their list."""

from dataclasses import dataclass
from pathlib import Path

from studies.design import points_of
from studies.errors import InputError
from studies.point import Command, Point
from studies.study_file import load

FOLDER = Path(__file__).resolve().parent

# In the order of the list of questions.
NAMES = (
    "solvers",
    "renewals",
    "partitions",
    "devices",
    "word-lengths",
    "iterations",
    "links",
    "mesh-rate",
    "several-devices",
    "stiffness",
    "jitter",
    "effects-ladder",
    "contacts",
)


@dataclass(frozen=True)
class Question:
    """As its file has it: `points` are the product of the axes, the last one fastest."""

    name: str
    title: str
    scenario: Path
    command: Command
    metrics: tuple[str, ...]
    points: tuple[Point, ...]


def read_question(name: str) -> Question:
    """One of NAMES. Throws InputError for another name."""
    if name not in NAMES:
        raise InputError(f"hvp questions: {name}: expected one of {', '.join(NAMES)}")
    file = FOLDER / f"{name}.toml"
    study = load(file)
    points = points_of(study, file)
    return Question(
        name,
        study.title,
        points[0].scenario,
        study.command,
        tuple(study.metrics),
        tuple(points),
    )
