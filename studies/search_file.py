"""The file of a search: a scenario, the axes that may be changed, what is wanted and demanded."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.errors import InputError
from studies.metrics import check_metric
from studies.point import Point, Value
from studies.program import Figure

_MOST_TRIALS = 100_000


@dataclass(frozen=True)
class Dimension:
    """A key and what it may be; numbers in the order in which neighbours stand."""

    key: str
    values: tuple[Value, ...]

    @property
    def named(self) -> bool:
        """Whether its values are names, which have no order, and not numbers."""
        return any(isinstance(value, str) for value in self.values)

    def override(self, number: int) -> str:
        """As `--set` takes it."""
        value = self.values[number]
        text = str(value).lower() if isinstance(value, bool) else str(value)
        return f"{self.key}={text}"


@dataclass(frozen=True)
class Objective:
    """A figure that is to be as small, or as large, as can be."""

    metric: str
    largest: bool = False


@dataclass(frozen=True)
class Constraint:
    """A figure that has to stay within bounds."""

    metric: str
    at_most: float | None = None
    at_least: float | None = None

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


@dataclass(frozen=True)
class Search:
    """What is looked for."""

    title: str
    scenario: Path
    dimensions: tuple[Dimension, ...]
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...]
    overrides: tuple[str, ...] = ()
    trials: int = 100
    seed: int = 1

    @property
    def combinations(self) -> int:
        """How many points the space has."""
        count = 1
        for dimension in self.dimensions:
            count *= len(dimension.values)
        return count

    def point(self, choice: tuple[int, ...]) -> Point:
        """The run of a choice: for each dimension the number of its value."""
        pairs = list(zip(self.dimensions, choice, strict=True))
        return Point(
            self.scenario,
            self.overrides + tuple(one.override(number) for one, number in pairs),
            {one.key: one.values[number] for one, number in pairs},
        )


def is_search(path: Path) -> bool:
    """Whether a study's file is one of a search: it has [search]."""
    try:
        return "search" in tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False  # whoever reads the study says what is wrong


def read_search(path: Path, known: Mapping[str, Figure]) -> Search:
    """Read a file; `known` are the figures there are. Throws InputError with the line."""
    try:
        text = path.read_bytes().decode()
        return _Reader(path, text, known).search(tomllib.loads(text))
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected UTF-8 text") from error
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"line (\d+)", str(error))
        raise InputError(f"{path}:{line[1] if line else 1}: {error}") from error
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error


@dataclass(frozen=True)
class _Reader:
    path: Path
    text: str
    known: Mapping[str, Figure]

    def search(self, document: dict[str, Any]) -> Search:
        self.keys("", document, ("title", "scenario", "set", "axis", "search"))
        search = self.get("", document, "search", dict)
        self.keys("search", search, ("trials", "seed", "objective", "constraint"))
        trials = self.get("search", search, "trials", int, 100)
        if not 1 <= trials <= _MOST_TRIALS:
            raise self.wrong("trials", f"search.trials: expected 1 to {_MOST_TRIALS}, got {trials}")
        return Search(
            self.get("", document, "title", str, self.path.stem),
            self.path.parent / self.get("", document, "scenario", str),
            self.dimensions(document),
            tuple(self.objective(item) for item in self.tables("search.objective", search)),
            tuple(
                self.constraint(item)
                for item in self.tables("search.constraint", search, needed=False)
            ),
            tuple(
                f"{self.get('set', item, 'key', str)}={self.scalar('set', item, 'value')}"
                for item in self.tables("set", document, needed=False)
            ),
            trials,
            self.get("search", search, "seed", int, 1),
        )

    def dimensions(self, document: dict[str, Any]) -> tuple[Dimension, ...]:
        dimensions: list[Dimension] = []
        for item in self.tables("axis", document):
            self.keys("axis", item, ("key", "values"))
            key = self.get("axis", item, "key", str)
            values = self.get("axis", item, "values", list)
            if not values or not all(isinstance(v, bool | int | float | str) for v in values):
                raise self.wrong(
                    key, f"axis.values of {key}: expected a list of numbers, texts, true and false"
                )
            if any(key == other.key for other in dimensions):
                raise self.wrong(key, f"axis.key: expected one axis a key, got {key} twice")
            dimensions.append(Dimension(key, tuple(values)))
        return tuple(dimensions)

    def objective(self, item: dict[str, Any]) -> Objective:
        where = "search.objective"
        self.keys(where, item, ("metric", "direction"))
        direction = self.get(where, item, "direction", str, "minimise")
        if direction not in ("minimise", "maximise"):
            raise self.wrong(
                direction,
                f'{where}.direction: expected "minimise" or "maximise", got "{direction}"',
            )
        return Objective(self.metric(where, item), direction == "maximise")

    def constraint(self, item: dict[str, Any]) -> Constraint:
        where = "search.constraint"
        self.keys(where, item, ("metric", "at_most", "at_least"))
        metric = self.metric(where, item)
        bounds: dict[str, float] = {}
        for name in ("at_most", "at_least"):
            if name in item:
                if not isinstance(item[name], int | float):
                    raise self.wrong(metric, f"{where}.{name}: expected a number")
                bounds[name] = float(item[name])
        if not bounds:
            raise self.wrong(metric, f"{where} of {metric}: expected at_most, at_least or both")
        return Constraint(metric, bounds.get("at_most"), bounds.get("at_least"))

    def metric(self, where: str, item: dict[str, Any]) -> str:
        name: str = self.get(where, item, "metric", str)
        check_metric(f"{self.path}:{self.line(name)}: {where}.metric", name, self.known)
        return name

    def tables(self, path: str, table: dict[str, Any], needed: bool = True) -> list[dict[str, Any]]:
        name = path.rpartition(".")[2]
        items = table.get(name, [])
        if (
            not isinstance(items, list)
            or (needed and not items)
            or not all(isinstance(item, dict) for item in items)
        ):
            raise self.wrong(name, f"{path}: expected [[{path}]]")
        return items

    def get(self, where: str, table: dict[str, Any], name: str, kind: type, *default: Any) -> Any:
        value = table.get(name, *default) if default else table.get(name)
        names = {str: "a text", int: "a whole number", list: "a list", dict: "a table"}
        if not isinstance(value, kind) or isinstance(value, bool):
            path = f"{where}.{name}".strip(".")
            raise self.wrong(name, f"{path}: expected {names[kind]}")
        return value

    def scalar(self, where: str, table: dict[str, Any], name: str) -> str:
        value = table.get(name)
        if not isinstance(value, bool | int | float | str):
            raise self.wrong(name, f"{where}.{name}: expected a number, a text, true or false")
        return str(value).lower() if isinstance(value, bool) else str(value)

    def keys(self, where: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
        for name in table:
            if name not in known:
                path = f"{where}.{name}".strip(".")
                raise self.wrong(name, f"{path}: unknown key; expected {', '.join(known)}")

    def wrong(self, near: str, message: str) -> InputError:
        return InputError(f"{self.path}:{self.line(near)}: {message}")

    def line(self, near: str) -> int:
        """The first line that has the word."""
        for number, line in enumerate(self.text.splitlines(), 1):
            if near and near in line.partition("#")[0]:
                return number
        return 1
