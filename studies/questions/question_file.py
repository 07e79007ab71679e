"""A question's file: the scenario, what is fixed, the axes, and the points that follow."""

import itertools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast, get_args

from studies.errors import InputError
from studies.point import Command, Point, Value

FOLDER = Path(__file__).resolve().parent

# In the order of the list of questions.
NAMES = (
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
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    document = tomllib.loads(text)
    command = document.get("command", "run")
    if command not in get_args(Command):
        raise InputError(f"{name}.toml: command: expected one of {', '.join(get_args(Command))}")
    scenario = (FOLDER / document["scenario"]).resolve()
    fixed = tuple(f"{item['key']}={_toml(item['value'])}" for item in document.get("set", []))
    axes = [_choices(axis) for axis in document["axis"]]
    points = []
    for combination in itertools.product(*axes):
        columns: dict[str, Value] = {}
        overrides = list(fixed)
        for column, value, settings in combination:
            columns[column] = value
            overrides += settings
        points.append(Point(scenario, tuple(overrides), columns, command=cast(Command, command)))
    return Question(
        name, document["title"], scenario, command, tuple(document["metrics"]), tuple(points)
    )


def _choices(axis: Mapping[str, Any]) -> list[tuple[str, Value, tuple[str, ...]]]:
    """Of an axis: its name, the value in tables, and what is set for it."""
    name = axis["name"]
    if "choice" not in axis:
        return [(name, value, (f"{axis['key']}={_toml(value)}",)) for value in axis["values"]]
    found: list[tuple[str, Value, tuple[str, ...]]] = []
    settings: tuple[str, ...] = ()
    for choice in axis["choice"]:
        own = tuple(choice["set"])
        # A ladder keeps what the rungs below have set; the last of two wins.
        settings = settings + own if axis.get("cumulative") else own
        latest = {setting.split("=", 1)[0]: setting for setting in settings}
        found.append((name, choice["name"], tuple(latest.values())))
    return found


def _toml(value: Value) -> str:
    """As `--set` takes it: text without quotes."""
    return str(value).lower() if isinstance(value, bool) else str(value)
