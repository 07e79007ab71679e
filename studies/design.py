"""Which points of a study's axes are run."""

import itertools
import json
import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studies.axis import as_quantity
from studies.errors import InputError
from studies.expression import Expression
from studies.point import Point, Value
from studies.study_file import MOST_POINTS, Axis, Design, Study

# A setting of an axis: what tables show, and KEY=VALUE for each of its keys.
Setting = tuple[Value, tuple[str, ...]]


def points_of(study: Study, file: Path) -> list[Point]:
    """The points in the order of the table. Throws InputError."""
    settings = list(_designed(study, file))
    constraints = [
        Expression(item.that, [axis.label for axis in study.axis]) for item in study.constraint
    ]
    fixed = fixed_of(study)
    points = []
    for combination in settings:
        columns = {
            axis.label: shown for axis, (shown, _) in zip(study.axis, combination, strict=True)
        }
        try:
            if not all(constraint.holds(columns) for constraint in constraints):
                continue
        except ValueError as error:
            raise InputError(f"{file}: constraint: {error}") from error
        overrides = [*fixed, *(text for _, texts in combination for text in texts)]
        points.append(
            Point(
                beside(file, study.scenario),
                tuple(overrides),
                columns,
                study.command,
                tuple(study.arguments),
                tuple(beside(file, include) for include in study.include),
            )
        )
    if not points:
        raise InputError(f"{file}: constraint: no point is left of {len(settings)}")
    return points


def fixed_of(study: Study) -> list[str]:
    """What is set in every point, KEY=VALUE."""
    return [
        item if isinstance(item, str) else _override(item.key, item.value) for item in study.set
    ]


def beside(file: Path, name: str) -> Path:
    """A file that the study names: from the study's folder, in as few words as there are."""
    return Path(os.path.normpath(file.parent / name))


def _designed(study: Study, file: Path) -> Iterator[tuple[Setting, ...]]:
    design = study.design
    if design.kind in ("latin-hypercube", "sobol"):
        if design.samples < 1:
            raise InputError(f"{file}: design.samples: expected how many points are sampled")
        yield from _sampled(study.axis, design, file)
        return
    levels = [levels_of(axis, file) for axis in study.axis]
    sizes = [len(level) for level in levels]
    if design.kind == "zip":
        if len(set(sizes)) != 1:
            raise InputError(f"{file}: axis: expected as many values of each, found {sizes}")
        yield from zip(*levels, strict=True)
        return
    if math.prod(sizes) > MOST_POINTS:
        raise InputError(f"{file}: axis: {math.prod(sizes)} points, expected at most {MOST_POINTS}")
    yield from itertools.product(*levels)


def levels_of(axis: Axis, file: Path) -> list[Setting]:
    """The values of an axis and what each sets. Throws InputError."""
    if axis.choice:
        return _chosen(axis)
    if axis.values:
        return [_listed(axis, value) for value in axis.values]
    if axis.steps < 1:
        raise InputError(f"{file}: axis.steps: expected how many values '{axis.label}' has")
    places = [0.0] if axis.steps == 1 else [i / (axis.steps - 1) for i in range(axis.steps)]
    # Rounding to whole numbers may make two of one.
    settings = [_ranged(axis, place, file) for place in places]
    return list(dict.fromkeys(settings))


def _sampled(axes: Sequence[Axis], design: Design, file: Path) -> Iterator[tuple[Setting, ...]]:
    # Most of a second that only those wait for who sample.
    from scipy.stats import qmc  # noqa: PLC0415

    sampler: qmc.QMCEngine
    if design.kind == "sobol":
        sampler = qmc.Sobol(len(axes), rng=np.random.default_rng(design.seed))
        # A power of two keeps Sobol's balance; the table has those that were asked for.
        sample = sampler.random_base2(max(design.samples - 1, 0).bit_length())[: design.samples]
    else:
        sampler = qmc.LatinHypercube(len(axes), rng=np.random.default_rng(design.seed))
        sample = sampler.random(design.samples)
    chosen = {axis.label: _chosen(axis) for axis in axes if axis.choice}
    for row in sample:
        yield tuple(
            chosen[axis.label][min(int(place * len(axis.choice)), len(axis.choice) - 1)]
            if axis.choice
            else _listed(
                axis, axis.values[min(int(place * len(axis.values)), len(axis.values) - 1)]
            )
            if axis.values
            else _ranged(axis, float(place), file)
            for axis, place in zip(axes, row, strict=True)
        )


def _chosen(axis: Axis) -> list[Setting]:
    found: list[Setting] = []
    texts: tuple[str, ...] = ()
    for choice in axis.choice:
        texts = (*texts, *choice.set) if axis.cumulative else tuple(choice.set)
        # Of a key that is set twice the last value counts, as on a command line.
        found.append((choice.name, tuple({text.split("=", 1)[0]: text for text in texts}.values())))
    return found


def _listed(axis: Axis, value: Any) -> Setting:
    if axis.keys:
        texts = tuple(_override(key, item) for key, item in zip(axis.keys, value, strict=True))
        return " ".join(_plain(item) for item in value), texts
    shown = value if isinstance(value, bool | int | float | str) else _plain(value)
    return shown, (_override(axis.key, value),)


def _ranged(axis: Axis, place: float, file: Path) -> Setting:
    """The value at a place from 0 to 1 of a range."""
    (low, unit), (high, unit_to) = _number(axis, axis.start, file), _number(axis, axis.to, file)
    if unit != unit_to:
        raise InputError(f"{file}: axis.to: expected '{unit}' as in `from`, found '{unit_to}'")
    if axis.scale == "log":
        if low <= 0 or high <= 0:
            raise InputError(f"{file}: axis.from: expected more than 0 on a logarithmic scale")
        number = math.exp(math.log(low) + place * (math.log(high) - math.log(low)))
    else:
        number = low + place * (high - low)
    # Twelve digits: what rounding adds is no part of a setting.
    value: Value = round(number) if axis.integer else float(f"{number:.12g}")
    if unit:
        value = f"{value} {unit}"
    return value, (_override(axis.key, value),)


def _number(axis: Axis, end: Value, file: Path) -> tuple[float, str]:
    if isinstance(end, str):
        quantity = as_quantity(end)
        if quantity is not None:
            return quantity
    elif not isinstance(end, bool) and end is not None:
        return float(end), ""
    raise InputError(f"{file}: axis '{axis.label}': expected a number in a range, found '{end}'")


def _override(key: str, value: Any) -> str:
    return f"{key}={_toml(value)}"


def _toml(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    return repr(value)


def _plain(value: Any) -> str:
    return value if isinstance(value, str) else _toml(value)
