"""STUDY.toml: what a study asks, declared once, for reading and for docs/study-reference.md."""

import json
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any, Literal, get_args

from pydantic import BaseModel, Field, ValidationError, model_validator

from studies.errors import InputError
from studies.expression import Expression
from studies.file_table import FileTable
from studies.nearest import nearest
from studies.point import Command
from studies.search_tables import SearchTable
from studies.toml_lines import line_of

MOST_POINTS = 1_000_000
_LARGEST_FILE = 1 << 20
Item = bool | int | float | str


class Choice(FileTable):
    """A value of an axis by its name, and what it sets."""

    name: str = Field(description="what it is called in tables")
    set: list[str] = Field(description="KEY=VALUE, as `--set` takes it")


class Axis(FileTable):
    """What is varied: one key of the scenario, or several that change together."""

    key: str = Field(default="", description="a key of the scenario, as `--set` names it")
    keys: list[str] = Field(
        default=[], description="several keys that change together, in place of `key`"
    )
    name: str = Field(default="", description="what the axis is called in tables and constraints")
    values: list[Item | list[Any]] = Field(
        default=[],
        description="the values; of `keys` a list of a value each. Quantities have their unit",
    )
    choice: list[Choice] = Field(
        default=[], description="values that set keys of their own, as `[[axis.choice]]`"
    )
    cumulative: bool = Field(
        default=False, description="whether a choice keeps what those before it have set: a ladder"
    )
    start: Item | None = Field(
        default=None,
        alias="from",
        description="where a range begins, with its unit, in place of `values`",
    )
    to: Item | None = Field(default=None, description="where it ends; it belongs to the range")
    steps: int = Field(
        default=0,
        ge=0,
        le=MOST_POINTS,
        description="how many values a range has; samplers need none",
    )
    scale: Literal["linear", "log"] = Field(default="linear", description="how a range is divided")
    integer: bool = Field(default=False, description="whether a range has whole numbers only")

    @model_validator(mode="after")
    def _check(self) -> "Axis":
        if self.choice:
            if self.key or self.keys or self.values or self.start is not None:
                raise ValueError("expected `choice` without `key`, `values` and `from`")
            if not self.name:
                raise ValueError("expected `name` beside `choice`")
            return self
        if self.cumulative:
            raise ValueError("expected `cumulative` beside `choice` only")
        if bool(self.key) == bool(self.keys):
            raise ValueError("expected either `key` or `keys`")
        if "values" in self.model_fields_set and not self.values:
            raise ValueError("expected one value or more in `values`")
        if bool(self.values) == (self.start is not None):
            raise ValueError("expected either `values` or a range with `from` and `to`")
        if (self.start is None) != (self.to is None):
            raise ValueError("expected both `from` and `to`")
        if self.keys and not self.values:
            raise ValueError("expected `values` beside `keys`: a range has one key")
        for value in self.values:
            if self.keys and not (isinstance(value, list) and len(value) == len(self.keys)):
                raise ValueError(f"expected a list of {len(self.keys)} values for each of `values`")
        return self

    @property
    def label(self) -> str:
        """What it is called."""
        return self.name or self.key or " ".join(self.keys)


class Design(FileTable):
    """Which points of the axes are run."""

    kind: Literal["product", "zip", "latin-hypercube", "sobol"] = Field(
        default="product",
        description="every combination; the axes side by side; or samples that fill the space",
    )
    samples: int = Field(default=0, ge=0, le=MOST_POINTS, description="how many, of a sampler")
    seed: int = Field(default=1, ge=0, description="of a sampler")


class Constraint(FileTable):
    """Points for which it does not hold are not run."""

    that: str = Field(description='a comparison of axes, such as "rows * columns <= 64"')


class Fixed(FileTable):
    """A key that has one value in every point."""

    key: str = Field(description="a key of the scenario, as `--set` names it")
    value: Item | list[Any] = Field(description="its value")


class Picture(FileTable):
    """What is drawn of the results."""

    x: str = Field(description="an axis")
    y: list[str] = Field(
        default=[], description="metrics, a panel each; the first three unless given"
    )
    colour: str = Field(default="", description="an axis that tells the lines apart")


class Study(FileTable):
    """A base scenario, axes, and what is asked of each run."""

    title: str = Field(default="", description="one line for the report")
    scenario: str = Field(description="the base scenario, from the study's own folder")
    include: list[str] = Field(default=[], description="files of a few keys that are laid over it")
    command: Command = Field(default="run", description="which command of hvp runs a point")
    arguments: list[str] = Field(default=[], description="more of its command line, a word each")
    set: list[str | Fixed] = Field(
        default=[], description="KEY=VALUE for every point, as `--set` takes it; or as `[[set]]`"
    )
    metrics: list[str] = Field(
        default=[], description="figures of docs/results-reference.md that tables and plots show"
    )
    time_limit_s: float | None = Field(default=None, gt=0, description="how long a run may take, s")
    retries: int = Field(default=1, ge=0, le=100, description="more tries for a run that crashed")
    axis: list[Axis] = Field(default=[], description="what is varied")
    design: Design = Field(default=Design(), description="which points")
    constraint: list[Constraint] = Field(default=[], description="which of them are left out")
    plot: list[Picture] = Field(default=[], description="pictures")
    search: SearchTable | None = Field(
        default=None, description="looks for the best point in place of running all"
    )


def load(file: Path) -> Study:
    """Read and check a study. Throws InputError: FILE:LINE: key: what was expected."""
    try:
        with file.open("rb") as stream:
            data = stream.read(_LARGEST_FILE + 1)
    except OSError as error:
        raise InputError(f"{file}: {error.strerror}; expected a study file") from error
    if len(data) > _LARGEST_FILE:
        raise InputError(f"{file}: expected at most {_LARGEST_FILE} bytes")
    try:
        text = data.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: not UTF-8 at byte {error.start}") from error
    return parse(text, file)


def parse(text: str, file: Path) -> Study:
    """The same for a text; `file` is what errors call it."""
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{file}: {error}") from error
    except RecursionError as error:
        raise InputError(f"{file}: expected lists and tables less deep") from error
    try:
        study = Study.model_validate(tree)
    except ValidationError as error:
        raise _refusal(text, file, error) from error
    if not study.axis:
        raise InputError(f"{file}: axis: expected at least one [[axis]]")
    labels = [axis.label for axis in study.axis]
    for index, label in enumerate(labels):
        if label in labels[:index]:
            where = line_of(text, ("axis", index))
            raise InputError(f"{file}:{where}: axis: expected one axis called '{label}'")
    if study.design.kind == "product":
        _refuse_equal_values(study, text, file)
    for index, constraint in enumerate(study.constraint):
        try:
            Expression(constraint.that, labels)
        except ValueError as error:
            where = line_of(text, ("constraint", index, "that"))
            raise InputError(f"{file}:{where}: constraint.that: {error}") from error
    for index, picture in enumerate(study.plot):
        for key in ("x", "colour"):
            found = getattr(picture, key)
            if found and found not in labels:
                where = line_of(text, ("plot", index, key))
                hint = nearest(found, labels)
                raise InputError(f"{file}:{where}: plot.{key}: no axis '{found}'{hint}")
    return study


def _refuse_equal_values(study: Study, text: str, file: Path) -> None:
    """Of every combination they would be the same runs twice."""
    for index, axis in enumerate(study.axis):
        counts = Counter(map(json.dumps, axis.values))
        twice = next((value for value, count in counts.items() if count > 1), None)
        if twice is not None:
            where = line_of(text, ("axis", index, "values"))
            raise InputError(f"{file}:{where}: axis.values: {twice} stands there twice")


def _refusal(text: str, file: Path, error: ValidationError) -> InputError:
    """The first thing that is wrong, by its line."""
    described = []
    for item in error.errors():
        # The forms of an item of `set` are no part of its name.
        location = tuple(part for part in item["loc"] if part not in ("str", Fixed.__name__))
        key = ".".join(str(part) for part in location if isinstance(part, str)) or "study"
        message = item["msg"].removeprefix("Value error, ")
        if item["type"] == "extra_forbidden":
            message = f"unknown key{nearest(str(location[-1]), _known(location))}"
        elif item["type"] == "missing":
            message = "is missing"
        described.append((line_of(text, location), key, message))
    line, key, message = min(described)
    # Control characters of a user's file do not reach the terminal.
    return InputError("".join(c for c in f"{file}:{line}: {key}: {message}" if c.isprintable()))


def _known(location: tuple[int | str, ...]) -> list[str]:
    """The keys of the table that a location is in."""
    table: type[BaseModel] = Study
    for part in location[:-1]:
        field = table.model_fields.get(str(part))
        table = (_table_of(field.annotation) if field else None) or table
    return [field.alias or name for name, field in table.model_fields.items()]


def _table_of(kind: Any) -> type[BaseModel] | None:
    """The table that a type has in it: itself, or that of a list's items."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next(filter(None, map(_table_of, get_args(kind))), None)
