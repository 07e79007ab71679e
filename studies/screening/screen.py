"""Turns every effect and fidelity level over, one at a time and in pairs, and recommends a set."""

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from studies.errors import InputError, StudyError
from studies.point import Point
from studies.program import Resolved
from studies.record import Record
from studies.screening.answers import (
    KEEP,
    Answers,
    Influence,
    Tolerances,
    influence,
    read_answers,
)
from studies.screening.changes import (
    Change,
    Choices,
    changes_of,
    effort,
    has_table,
    is_less,
    with_needs,
)
from studies.screening.exercise import Exercise, exercise, not_exercised
from studies.session import Session

DEFAULT_PAIRS = 6  # so many changes are paired: 15 runs


@dataclass(frozen=True)
class One:
    """A single change: its run, its influence, and why that may say nothing."""

    change: Change
    record: Record
    influence: Influence | None = None
    idle: str = ""  # why it was not exercised

    def matters(self, tolerances: Tolerances) -> bool:
        """Whether it moves an answer beyond its tolerance."""
        return self.influence is not None and self.influence.score(tolerances) > 1


@dataclass(frozen=True)
class Pair:
    """Two changes at once: what they do beyond the sum of what each does.

    `latency` and `p99` relative to the scenario's own, `force` the largest difference of a frame
    relative to the run's largest; None where a run of the three does not have it.
    """

    changes: tuple[Change, Change]
    record: Record
    latency: float | None = None
    p99: float | None = None
    force: float | None = None


@dataclass(frozen=True)
class Recommendation:
    """The least that keeps every answer, verified by a run of it as a whole."""

    changes: tuple[Change, ...]
    run: Answers
    influence: Influence
    rejected: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Screening:
    """All that was found of a scenario."""

    base: Answers
    exercised: Exercise
    choices: Choices
    ones: list[One]
    pairs: list[Pair]
    unpaired: list[str]
    recommendation: Recommendation


@dataclass
class Screener:
    """Runs a screening of one scenario."""

    session: Session
    scenario: Path
    overrides: tuple[str, ...]
    tolerances: Tolerances

    def screen(self, pairs: int = DEFAULT_PAIRS) -> Screening:
        """Throws InputError where the scenario itself is refused."""
        base = self._base()
        program = self.session.program
        choices = changes_of(program.reference, base.effects, base.fidelity)
        ones = self._singles(base, choices.changes)
        # What brings others with it, or takes an answer away, has no sum to differ from.
        mattering = sorted(
            (
                one
                for one in ones
                if one.matters(self.tolerances)
                and one.influence is not None
                and not one.influence.lost
                and not one.change.along
            ),
            key=lambda one: -one.influence.size(self.tolerances) if one.influence else 0.0,
        )
        found = self._pairs(base, mattering[:pairs])
        return Screening(
            base,
            exercise(base),
            choices,
            ones,
            found,
            [one.change.name for one in mattering[pairs:]],
            self._recommend(base, ones),
        )

    def settings_of(self, changes: Sequence[Change]) -> list[str]:
        """The scenario's overrides and changes for a file of its own.

        An effect that an override has brought and a change takes away again is not named: a file
        cannot leave out what its base does not have.
        """
        (resolved,) = self.session.program.resolve(self.scenario, [()])
        own = tomllib.loads(resolved.text) if isinstance(resolved, Resolved) else {}
        gone = [c.key for c in changes if c.kind == "off" and not has_table(c.key, own)]
        return [
            setting
            for setting in (*self.overrides, *unique(changes))
            if not any(setting.startswith((f"{key}=", f"{key}.", f"{key}[")) for key in gone)
        ]

    @property
    def _measured_flags(self) -> frozenset[str]:
        """Flags that the tolerances of [reference] raise, as these are declared."""
        reference = self.session.program.reference
        helps = [key["help"] for key in reference["keys"] if key["effect"] == "reference"]
        return frozenset(
            flag["name"] for flag in reference["flags"] if any(flag["name"] in h for h in helps)
        )

    def point(self, changes: Iterable[Change] = (), name: str = "") -> Point:
        """The scenario under changes."""
        return Point(
            self.scenario,
            (*self.overrides, *unique(changes)),
            {"change": name},
            keep=KEEP,
        )

    def _base(self) -> Answers:
        (record,) = self.session.run([self.point()])
        if record.status == "refused":
            raise InputError(record.message)
        if not record.done:
            raise StudyError(f"the scenario itself: {record.status}: {record.message}")
        return read_answers(self.session.store, record)

    def _singles(self, base: Answers, changes: Sequence[Change]) -> list[One]:
        records = self.session.run([self.point([change]) for change in changes])
        tried = list(changes)
        reference, settings = self.session.program.reference, self._settings()
        again = [i for i, record in enumerate(records) if record.status == "refused"]
        for i in again:
            tried[i] = with_needs(changes[i], reference, base.effects, settings)
        again = [i for i in again if tried[i].along]
        for i, record in zip(
            again, self.session.run([self.point([tried[i]]) for i in again]), strict=True
        ):
            if record.status == "refused":
                tried[i] = changes[i]
            else:
                records[i] = record
        # What comes along with an effect is no influence of that effect.
        befores = self._befores(base, [tried[i] for i in again])
        return [
            self._one(befores.get(change, base), change, record)
            for change, record in zip(tried, records, strict=True)
        ]

    def _settings(self) -> dict[str, Any]:
        point = self.point()
        (resolved,) = self.session.program.resolve(self.scenario, [point.settings])
        return tomllib.loads(resolved.text) if isinstance(resolved, Resolved) else {}

    def _befores(self, base: Answers, changes: Sequence[Change]) -> dict[Change, Answers]:
        coming = [change for change in changes if change.kind == "on" and change.along]
        records = self.session.run([self.point(change.along) for change in coming])
        return {
            change: read_answers(self.session.store, record) if record.done else base
            for change, record in zip(coming, records, strict=True)
        }

    def _one(self, before: Answers, change: Change, record: Record) -> One:
        if not record.done:
            return One(change, record)
        run = read_answers(self.session.store, record)
        found = influence(before, run, self._measured_flags)
        idle = not_exercised(change.key, (exercise(before), exercise(run)))
        return One(change, record, found, idle if found.score(self.tolerances) == 0 else "")

    def _pairs(self, base: Answers, ones: Sequence[One]) -> list[Pair]:
        both = [
            (a, b)
            for a, b in combinations(ones, 2)
            if not {c.key for c in _all(a.change)} & {c.key for c in _all(b.change)}
        ]
        records = self.session.run([self.point([a.change, b.change]) for a, b in both])
        return [
            self._pair(base, a, b, record) for (a, b), record in zip(both, records, strict=True)
        ]

    def _pair(self, base: Answers, a: One, b: One, record: Record) -> Pair:
        changes = (a.change, b.change)
        if not record.done:
            return Pair(changes, record)
        store = self.session.store
        runs = [base, *(read_answers(store, r) for r in (a.record, b.record, record))]
        return Pair(
            changes,
            record,
            _interaction(runs, "deadline.worst_us"),
            _interaction(runs, "deadline.p99_us"),
            _force_interaction(runs),
        )

    def _recommend(self, base: Answers, ones: Sequence[One]) -> Recommendation:
        """Takes away as long as every answer stays within its tolerance, least influence first.

        What was refused by itself is tried again once something else has gone. Each step is a run
        of the whole set, so what is recommended has been run as it stands.
        """
        rejected: dict[str, str] = {}
        candidates: list[One] = []
        for one in ones:
            if not is_less(one.change, base.fidelity):
                continue
            if one.idle:
                rejected[one.change.name] = f"not exercised: {one.idle}"
            elif one.influence is not None and one.matters(self.tolerances):
                rejected[one.change.name] = "moves an answer beyond its tolerance"
            else:
                candidates.append(one)
        candidates.sort(
            key=lambda one: (
                _score(one, self.tolerances),
                effort(one.change.value) if one.change.kind == "level" else 0,
                one.change.name,
            )
        )
        taken: list[Change] = []
        best, found = base, influence(base, base)
        progress = True
        while progress:
            progress = False
            for one in list(candidates):
                change = replace(one.change, along=())
                if any(change.key == other.key for other in taken):
                    candidates.remove(one)
                    continue
                (record,) = self.session.run([self.point([*taken, change])])
                if not record.done:
                    rejected[change.name] = record.message
                    continue
                run = read_answers(self.session.store, record)
                moved = influence(base, run, self._measured_flags)
                if moved.score(self.tolerances) > 1:
                    rejected[change.name] = "with the others, moves an answer beyond its tolerance"
                    continue
                taken.append(change)
                candidates.remove(one)
                rejected.pop(change.name, None)
                best, found, progress = run, moved, True
        return Recommendation(tuple(taken), best, found, rejected)


def unique(changes: Iterable[Change]) -> list[str]:
    """The overrides of several changes, each once."""
    return list(dict.fromkeys(setting for change in changes for setting in change.overrides))


def _all(change: Change) -> tuple[Change, ...]:
    return (change, *change.along)


def _score(one: One, tolerances: Tolerances) -> float:
    return one.influence.score(tolerances) if one.influence else float("inf")


def _interaction(runs: Sequence[Answers], name: str) -> float | None:
    values = [run.figure(name) for run in runs]
    base, a, b, both = values
    if base is None or a is None or b is None or both is None:
        return None
    scale = base or runs[0].figure("deadline.budget_us") or 1.0
    return (both - a - b + base) / scale


def _force_interaction(runs: Sequence[Answers]) -> float | None:
    forces = [run.force for run in runs]
    if any(force is None for force in forces):
        return None
    shared = runs[0].frames.index
    for run in runs[1:]:
        shared = shared.intersection(run.frames.index)
    if not len(shared):
        return None
    base, a, b, both = (force.loc[shared].to_numpy() for force in forces if force is not None)
    largest = float(np.linalg.norm(base, axis=1).max())
    if largest == 0:
        return None
    return float(np.linalg.norm(both - a - b + base, axis=1).max()) / largest
