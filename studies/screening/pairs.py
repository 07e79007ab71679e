"""Changes two by two: what both do beyond the sum of what each does."""

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations

from studies.point import Point
from studies.record import Record
from studies.screening.answers import Answers, largest_length, read_answers
from studies.screening.changes import Change
from studies.screening.found import One, Pair
from studies.session import Session


def pairs_of(
    session: Session,
    base: Answers,
    ones: Sequence[One],
    point: Callable[[Iterable[Change]], Point],
) -> list[Pair]:
    """Run every two that have no key in common. `point` is the scenario under changes."""
    both = [
        (a, b)
        for a, b in combinations(ones, 2)
        if not {c.key for c in _all(a.change)} & {c.key for c in _all(b.change)}
    ]
    records = session.run([point([a.change, b.change]) for a, b in both])
    return [
        _pair(session, base, a, b, record) for (a, b), record in zip(both, records, strict=True)
    ]


def _all(change: Change) -> tuple[Change, ...]:
    return (change, *change.along)


def _pair(session: Session, base: Answers, a: One, b: One, record: Record) -> Pair:
    changes = (a.change, b.change)
    if not record.done:
        return Pair(changes, record)
    runs = [base, *(read_answers(session.store, r) for r in (a.record, b.record, record))]
    return Pair(
        changes,
        record,
        _interaction(runs, "deadline.worst_us"),
        _interaction(runs, "deadline.p99_us"),
        _force_interaction(runs),
    )


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
    largest = largest_length(base)
    if largest == 0 or len({force.shape for force in (base, a, b, both)}) > 1:
        return None
    return largest_length(both - a - b + base) / largest
