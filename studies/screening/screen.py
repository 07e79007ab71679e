"""Turns every effect and fidelity level over, one at a time and in pairs, and recommends a set."""

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from studies.errors import InputError, StudyError
from studies.point import Point
from studies.program import Resolved
from studies.record import Record
from studies.screening.answers import (
    KEEP,
    Answers,
    Tolerances,
    influence,
    read_answers,
)
from studies.screening.changes import (
    Change,
    changes_of,
    effort,
    has_table,
    is_less,
    with_needs,
)
from studies.screening.exercise import exercise, not_exercised
from studies.screening.found import One, Recommendation, Screening
from studies.screening.pairs import pairs_of
from studies.session import Session

DEFAULT_PAIRS = 6  # so many changes are paired: 15 runs


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
        found = pairs_of(self.session, base, mattering[:pairs], self.point)
        return Screening(
            base,
            exercise(base),
            choices,
            ones,
            found,
            [one.change.name for one in mattering[pairs:]],
            self._recommend(base, ones),
        )

    def verify(self, file: Path, best: Recommendation) -> None:
        """Run what was written, and hold it to what was judged: the file is what is recommended.

        Throws StudyError where its run is refused, is another one, or leaves a tolerance.
        """
        (record,) = self.session.run([Point(file, keep=KEEP)])
        if not record.done:
            raise StudyError(f"{file}: {record.status}: {record.message}")
        run = read_answers(self.session.store, record)
        moved = influence(best.run, run)
        if not moved.same_frames or moved.flags or record.status != best.run.record.status:
            raise StudyError(f"{file}: its run is not the one that was judged: not verified")
        base = self._base()
        if influence(base, run, self._measured_flags).score(self.tolerances) > 1:
            raise StudyError(f"{file}: an answer is beyond its tolerance: not verified")

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
        records = list(self.session.run([self.point([change]) for change in changes]))
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
                rejected[one.change.name] = one.influence.why(self.tolerances)
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
                    rejected[change.name] = f"with the others, {moved.why(self.tolerances)}"
                    continue
                taken.append(change)
                candidates.remove(one)
                rejected.pop(change.name, None)
                best, found, progress = run, moved, True
        return Recommendation(tuple(taken), best, found, rejected)


def unique(changes: Iterable[Change]) -> list[str]:
    """The overrides of several changes, each once."""
    return list(dict.fromkeys(setting for change in changes for setting in change.overrides))


def _score(one: One, tolerances: Tolerances) -> float:
    return one.influence.score(tolerances) if one.influence else float("inf")
