"""The space that a search looks through: its axes, and the run of each choice of their values."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from studies.axis import places
from studies.design import beside, fixed_of, levels_of
from studies.errors import InputError
from studies.metrics import check_metric
from studies.point import Point, Value
from studies.program import Figure
from studies.search_tables import Bound, Objective
from studies.study_file import Study
from studies.toml_lines import line_of

# What says which points are run, or what is shown of all of them.
_NOT_BESIDE = ("command", "arguments", "metrics", "design", "constraint", "plot")


@dataclass(frozen=True)
class Dimension:
    """An axis: what its values are called, in the order in which neighbours stand, and what each
    of them sets."""

    key: str
    values: tuple[Value, ...]
    overrides: tuple[tuple[str, ...], ...]

    @property
    def named(self) -> bool:
        """Whether its values are names, which have no order, and not numbers."""
        return not all(isinstance(value, bool) for value in self.values) and isinstance(
            places(self.values)[0][0], str
        )


@dataclass(frozen=True)
class Search:
    """What is looked for."""

    title: str
    scenario: Path
    dimensions: tuple[Dimension, ...]
    objectives: tuple[Objective, ...]
    constraints: tuple[Bound, ...]
    overrides: tuple[str, ...] = ()
    includes: tuple[Path, ...] = ()
    trials: int = 100
    seed: int = 1

    @property
    def combinations(self) -> int:
        """How many points the space has."""
        return math.prod(len(dimension.values) for dimension in self.dimensions)

    @property
    def method(self) -> str:
        """Who proposes points where not all are run."""
        return "TPE" if len(self.objectives) == 1 else "NSGA-II"

    def point(self, choice: tuple[int, ...]) -> Point:
        """The run of a choice: for each dimension the number of its value."""
        pairs = list(zip(self.dimensions, choice, strict=True))
        return Point(
            self.scenario,
            (*self.overrides, *(text for one, number in pairs for text in one.overrides[number])),
            {one.key: one.values[number] for one, number in pairs},
            includes=self.includes,
        )


def search_of(study: Study, file: Path) -> Search:
    """The search of a study that has one. Throws InputError for what has no place beside it."""
    assert study.search is not None
    for name in _NOT_BESIDE:
        if name in study.model_fields_set:
            line = line_of(file.read_text(encoding="utf-8"), (name,))
            raise InputError(f"{file}:{line}: {name}: has no place beside [search]")
    dimensions = []
    for axis in study.axis:
        levels = levels_of(axis, file)
        shown, texts = zip(*levels, strict=True)
        dimensions.append(Dimension(axis.label, shown, texts))
    return Search(
        study.title or file.stem,
        beside(file, study.scenario),
        tuple(dimensions),
        tuple(study.search.objective),
        tuple(study.search.constraint),
        tuple(fixed_of(study)),
        tuple(beside(file, include) for include in study.include),
        study.search.trials,
        study.search.seed,
    )


def check_metrics(search: Search, file: Path, known: Mapping[str, Figure]) -> None:
    """Throws InputError, with the line, for a metric that is none of the figures."""
    for metric, place in _places(search, file):
        check_metric(place, metric, known)


def place_of(search: Search, file: Path, metric: str) -> str:
    """The file, line and key that first ask for a metric."""
    return dict(reversed(_places(search, file)))[metric]


def _places(search: Search, file: Path) -> list[tuple[str, str]]:
    text = file.read_text(encoding="utf-8")
    wanted = [("objective", index, one.metric) for index, one in enumerate(search.objectives)]
    demanded = [("constraint", index, one.metric) for index, one in enumerate(search.constraints)]
    return [
        (
            metric,
            f"{file}:{line_of(text, ('search', where, index, 'metric'))}: search.{where}.metric",
        )
        for where, index, metric in wanted + demanded
    ]
