"""Which axis of a sampled study matters: the share of a figure's variance that each explains."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studies.axis import places
from studies.point import Value
from studies.results import Column
from studies.study_file import Study

COLUMNS = (
    Column("figure", "", "of the runs"),
    Column("axis", "", "of the study"),
    Column("share", "", "of the figure's variance that the axis explains by itself (Sobol's S1)"),
    Column("low", "", "of its 95 % interval, by resampling the points"),
    Column("high", "", "likewise"),
    Column("least", "", "mean of the figure in the group of the axis in which it is smallest"),
    Column("largest", "", "and in which it is largest"),
    Column("points", "", "that had the figure"),
)
FEWEST = 20  # points: below, an interval says nothing
_RESAMPLED = 400
_IN_A_GROUP = 10  # points, at least, of an axis with a range
_MOST_GROUPS = 40
_NOTHING = 1e-12  # a spread of rounding

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Influence:
    """Of one axis on one figure."""

    figure: str
    axis: str
    share: float
    low: float
    high: float
    least: float
    largest: float
    points: int

    def row(self) -> dict[str, Value]:
        """Its cells; shares as far as they are told."""
        return {
            "figure": self.figure,
            "axis": self.axis,
            "share": round(self.share, 4),
            "low": round(self.low, 4),
            "high": round(self.high, 4),
            "least": self.least,
            "largest": self.largest,
            "points": self.points,
        }


def influences(
    study: Study, cells: Mapping[str, Sequence[Value]], figures: Sequence[str]
) -> list[Influence]:
    """Of every axis on every figure that varies, the largest share first; none where the points are
    not drawn at random: then axes go together, or few values stand for a range.

    A share is the variance of the figure's means over groups of the axis, over all variance, less
    what as many groups of pure chance would have (Kelley's epsilon squared; Saltelli et al., Global
    Sensitivity Analysis, 2008, section 1.2). A range is divided into groups of equally many points.
    """
    if study.design.kind not in ("latin-hypercube", "sobol"):
        return []
    found: list[Influence] = []
    for name in figures:
        measured = [
            row
            for row, value in enumerate(cells.get(name, []))
            if isinstance(value, int | float)
            and not isinstance(value, bool)
            and math.isfinite(value)
        ]
        y = np.array([cells[name][row] for row in measured], dtype=np.float64)
        if len(y) < FEWEST or not y.std() > _NOTHING * abs(y.mean()):
            continue
        of_figure = [
            _influence(name, axis.label, _groups([cells[axis.label][row] for row in measured]), y)
            for axis in study.axis
        ]
        found += sorted(of_figure, key=lambda influence: -influence.share)
    return found


def words(found: Sequence[Influence]) -> list[str]:
    """A sentence a figure: what explains how much of it."""
    sentences = []
    for figure in dict.fromkeys(influence.figure for influence in found):
        of_figure = [influence for influence in found if influence.figure == figure]
        sure = [influence for influence in of_figure if influence.low > 0]
        parts = [
            f"{i.axis} {100 * i.share:.0f} % ({100 * i.low:.0f} to {100 * i.high:.0f}; means from "
            f"{i.least:.3g} to {i.largest:.3g})"
            for i in sure
        ]
        rest = 1 - sum(influence.share for influence in sure)
        others = [influence.axis for influence in of_figure if influence.low <= 0]
        sentence = f"Of the variance of {figure} " + (
            f"{', '.join(parts)}; the other {100 * max(rest, 0):.0f} % are axes together and what "
            "groups of an axis do not tell"
            if parts
            else "no axis explains by itself more than chance would"
        )
        if others and parts:
            sentence += f". Not told from chance: {', '.join(others)}"
        sentences.append(sentence + ".")
    return sentences


def _groups(values: Sequence[Value]) -> NDArray[np.intp]:
    """The group of each point. Few different values are a group each."""
    different = list(dict.fromkeys(values))
    numbers, _ = places(values)
    of_numbers = [number for number in numbers if isinstance(number, int | float)]
    most = max(2, min(_MOST_GROUPS, len(values) // _IN_A_GROUP))
    if len(of_numbers) < len(values) or len(different) <= most:
        return np.array([different.index(value) for value in values], dtype=np.intp)
    order = np.argsort(np.array(of_numbers, dtype=np.float64), kind="stable")
    groups = np.empty(len(values), dtype=np.intp)
    groups[order] = np.arange(len(values)) * most // len(values)
    return groups


def _influence(figure: str, axis: str, groups: NDArray[np.intp], y: Floats) -> Influence:
    random = np.random.default_rng(1)
    again = [
        _share(groups[rows], y[rows])
        for rows in (random.integers(0, len(y), len(y)) for _ in range(_RESAMPLED))
    ]
    # A resampled point stands twice, which looks like an effect of its group: the shares are too
    # large by as much in the mean, and the interval is moved back.
    share = _share(groups, y)
    low, high = np.quantile(again, [0.025, 0.975]) - (float(np.mean(again)) - share)
    means = [float(y[groups == group].mean()) for group in np.unique(groups)]
    return Influence(
        figure,
        axis,
        min(max(share, 0.0), 1.0),
        min(max(float(low), 0.0), 1.0),
        min(max(float(high), 0.0), 1.0),
        min(means),
        max(means),
        len(y),
    )


def _share(groups: NDArray[np.intp], y: Floats) -> float:
    """Kelley's epsilon squared; below zero where there is less than chance."""
    total = float(((y - y.mean()) ** 2).sum())
    count = np.bincount(groups).astype(np.float64)
    sums = np.bincount(groups, weights=y)
    there = count > 0
    number, all_points = int(there.sum()), len(y)
    if not total > 0 or number < 2 or all_points <= number:  # noqa: PLR2004
        return 0.0
    within = total - float((count[there] * (sums[there] / count[there] - y.mean()) ** 2).sum())
    return 1 - within / (all_points - number) * (all_points - 1) / total
