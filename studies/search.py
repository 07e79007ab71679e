"""Looks for the best point of a space: all of it where it is small, else Optuna and neighbours."""

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from itertools import product

import optuna
from optuna.trial import Trial

from studies.device_size import size
from studies.errors import InputError
from studies.point import Value
from studies.record import Record
from studies.search_space import Search
from studies.search_tables import Bound
from studies.session import Session

Choice = tuple[int, ...]

_NO_RESULT = 1e6  # the violation of what was refused or crashed: behind all that ran
_WORST = 1e300  # its objectives, which are of no use to anybody
_TOGETHER = 4  # proposals at a time, whatever the number of workers: the same search anywhere
_DEVICE = "accelerator.device"


@dataclass(frozen=True)
class Tried:
    """A point of the space with what is known of it. `objectives`: the smaller the better."""

    choice: Choice
    record: Record
    figures: dict[str, Value]
    objectives: tuple[float, ...]
    violations: tuple[float, ...]

    @property
    def feasible(self) -> bool:
        """Whether it has every figure asked for, within the bounds."""
        return sum(self.violations) == 0.0

    @property
    def rank(self) -> tuple[object, ...]:
        """What is better comes first; feasible points by their objectives, others by how far off
        they are, and the first of the space where nothing else decides."""
        if self.feasible:
            return (0, *self.objectives, self.choice)
        return (1, sum(self.violations), self.choice)

    def dominates(self, other: "Tried") -> bool:
        """No objective worse, and one better."""
        pairs = list(zip(self.objectives, other.objectives, strict=True))
        return all(a <= b for a, b in pairs) and any(a < b for a, b in pairs)


@dataclass
class Found:
    """All that was tried, in that order, and the best of it."""

    search: Search
    tried: dict[Choice, Tried] = field(default_factory=dict)
    proposals: int = 0  # by Optuna, repeated ones included
    steps: int = 0  # rounds of neighbours

    @property
    def complete(self) -> bool:
        """Whether the whole space was tried."""
        return len(self.tried) == self.search.combinations

    @property
    def best(self) -> list[Tried]:
        """The best point, or with several objectives those that none dominates."""
        feasible = sorted((t for t in self.tried.values() if t.feasible), key=lambda t: t.rank)
        if len(self.search.objectives) == 1:
            return feasible[:1]
        return [one for one in feasible if not any(other.dominates(one) for other in feasible)]


def find(search: Search, session: Session, progress: Callable[[int], None] | None = None) -> Found:
    """Carry a search out. `progress` is told how many points are known."""
    found = Found(search)

    def run(choices: Iterable[Choice]) -> None:
        new = [choice for choice in dict.fromkeys(choices) if choice not in found.tried]
        records = session.run([search.point(choice) for choice in new])
        for choice, record in zip(new, records, strict=True):
            found.tried[choice] = judge(search, choice, record)
        if progress:
            progress(len(found.tried))

    if search.combinations <= search.trials:
        all_choices = list(product(*(range(len(d.values)) for d in search.dimensions)))
        run(all_choices[:_TOGETHER])
        _require_measured(found)
        run(all_choices)
        return found
    _propose(found, run)
    while new := [c for c in _neighbours_of_best(found) if c not in found.tried]:
        run(new)
        found.steps += 1
    return found


class UnmeasuredError(InputError):
    """What a search judges by is in none of its first runs."""

    def __init__(self, metric: str, runs: int) -> None:
        why = (
            ": no frame in contact was compared with the true model, or there is no [reference]"
            if metric.startswith("accuracy.")
            else ""
        )
        super().__init__(f"{metric}: was not measured in any of the first {runs} runs{why}")
        self.metric = metric


def _require_measured(found: Found) -> None:
    """Throws UnmeasuredError where all runs so far have figures, and none what is asked for: the
    others would be as many runs for nothing."""
    done = [tried for tried in found.tried.values() if tried.record.done]
    asked = [one.metric for one in found.search.objectives]
    asked += [one.metric for one in found.search.constraints]
    for metric in asked:
        if done and all(tried.figures.get(metric) is None for tried in done):
            raise UnmeasuredError(metric, len(done))


def judge(search: Search, choice: Choice, record: Record) -> Tried:
    """What a record says of a point: figures that are missing violate what asks for them."""
    # How large a device is stands in its table, also where nothing fits on it.
    figures: dict[str, Value] = {**size(_device(search, choice, record), search.scenario)}
    if record.done:
        figures |= record.metrics | {"flags": len(record.flags)}
    objectives = []
    for objective in search.objectives:
        value = figures.get(objective.metric)
        number = float(value) if isinstance(value, int | float) else None
        objectives.append(_WORST if number is None else -number if objective.largest else number)
    known = [figures.get(one.metric) is not None for one in search.objectives]
    violations = [_violation(one, figures) for one in search.constraints]
    violations.append(0.0 if record.done and all(known) else _NO_RESULT)
    return Tried(choice, record, figures, tuple(objectives), tuple(violations))


def _violation(constraint: Bound, figures: dict[str, Value]) -> float:
    value = figures.get(constraint.metric)
    return _NO_RESULT if value is None else constraint.violation(value)


def _device(search: Search, choice: Choice, record: Record) -> str:
    # An axis may set it beside other keys; what is set last is what the scenario has.
    for override in reversed(search.point(choice).overrides):
        if override.startswith(f"{_DEVICE}="):
            return override.partition("=")[2].strip('"')
    return str(record.metrics.get("board.device", ""))


def neighbours(search: Search, choice: Choice) -> list[Choice]:
    """One step on one axis each: numbers up or down, names to any other, as they have no order."""
    found = []
    for axis, dimension in enumerate(search.dimensions):
        for number in range(len(dimension.values)):
            away = abs(number - choice[axis])
            if away == 1 or (away > 1 and dimension.named):
                found.append((*choice[:axis], number, *choice[axis + 1 :]))
    return found


def _neighbours_of_best(found: Found) -> list[Choice]:
    best = found.best or [min(found.tried.values(), key=lambda tried: tried.rank)]
    return [step for one in best for step in neighbours(found.search, one.choice)]


def _propose(found: Found, run: Callable[[Iterable[Choice]], None]) -> None:
    """Optuna's part: TPE for one objective, NSGA-II for several."""
    search = found.search
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        study = optuna.create_study(
            sampler=_sampler(search), directions=["minimize"] * len(search.objectives)
        )
        while found.proposals < search.trials:
            count = min(_TOGETHER, search.trials - found.proposals)
            asked = [study.ask() for _ in range(count)]
            choices = [_suggest(search, trial) for trial in asked]
            run(choices)
            if found.proposals == 0:
                _require_measured(found)
            for trial, choice in zip(asked, choices, strict=True):
                tried = found.tried[choice]
                for number, violation in enumerate(tried.violations):
                    trial.set_constraint(f"bound {number}", violation)
                study.tell(trial, list(tried.objectives))
            found.proposals += count


def _sampler(search: Search) -> optuna.samplers.BaseSampler:
    if len(search.objectives) == 1:
        return optuna.samplers.TPESampler(seed=search.seed, constant_liar=True)
    return optuna.samplers.NSGAIISampler(
        seed=search.seed,
        population_size=max(_TOGETHER, min(50, search.trials // 5)),
    )


def _suggest(search: Search, trial: Trial) -> Choice:
    """Numbers have an order that the sampler may use; names have none."""
    choice = []
    for dimension in search.dimensions:
        places = range(len(dimension.values))
        if dimension.named:
            choice.append(trial.suggest_categorical(dimension.key, list(places)))
        else:
            choice.append(trial.suggest_int(dimension.key, 0, places[-1]))
    return tuple(choice)
