"""Error against modelled frame time over the settings of the solver."""

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from studies.accuracy import partitions
from studies.accuracy.grid import (
    ITERATIONS,
    MEMORY,
    NODES,
    PASSES,
    SCALING,
    overrides_of,
    own_settings,
)
from studies.accuracy.ladder import resolved_settings
from studies.errors import InputError, StudyError
from studies.point import Point, Value
from studies.record import Record
from studies.session import Session

# The one meaning of error, that of [budget] too: of a frame's own size, 95 % of those in contact.
ERROR = "accuracy.displacement_of_frame.p95"
FORCE_ERROR = "accuracy.force_of_frame.p95"
ERROR_MEANS = "of a frame's own size, 95 % of the frames in contact are within it"
TIME = "deadline.worst_us"
BUDGET = "deadline.budget_us"

UNMEASURED = "not measured"
NO_CONTACT = "no frame in contact"

_KEEP = ("summary.json",)  # for the resources, a list
BREAKDOWN_FLAGS = (
    "negative-curvature",
    "zero-diagonal",
    "scalar-overflow",
    "divergence",
    "wrapped",
)
_MEMORIES = re.compile(r'(accelerator\.(?:\w+_memory|parity_bits)) = "?([\w-]+)"?')
UNFIT = "cannot hold"  # as the program refuses what is too large for a device
# Counted by the sequencer, and done by the host: neither takes room on the device.
_NOT_HELD = (ITERATIONS, PASSES)
# Larger than any of the thesis' time: holds what the scenario's own device does not.
ROOMY = "U280"


@dataclass(frozen=True)
class Design:
    """A choice of settings with what became of it.

    `state` is how a table calls it: fits, late, beyond budget, breaks down, does not fit, not
    measured, or refused. What misses an error budget alone is beyond budget, and not late. What
    does not fit has the figures that it would have on a larger device with the same clock. `tried`
    are the partitions that were tried, 1 to that; none where they are the scenario's own. `own` is
    the scenario itself, and `between` a set that is none of the grid's.
    """

    columns: Mapping[str, Value]
    overrides: tuple[str, ...]
    record: Record
    state: str
    message: str = ""
    tried: int = 0
    own: bool = False
    between: bool = False

    @property
    def time_us(self) -> float | None:
        """Worst latency, µs."""
        return _number(self.record, TIME)

    def error(self, name: str = ERROR) -> float | None:
        """Against the true model; nothing where no frame was compared."""
        return _number(self.record, name) if _number(self.record, "accuracy.frames") else None

    @property
    def own_mesh(self) -> bool:
        """Whether its body is the scenario's: errors on another mesh are against its own model."""
        return self.own or not self.columns.get(NODES)

    def reaches(self, target: float) -> bool:
        """Whether its displacement is that close to the true model's."""
        error = self.error()
        return error is not None and error <= target

    @property
    def usable(self) -> bool:
        """Whether it is a design for this device and this budget."""
        return self.state == "fits" and self.error() is not None and self.time_us is not None


@dataclass
class DesignStudy:
    """Runs the grid on one scenario."""

    session: Session
    scenario: Path
    overrides: tuple[str, ...]

    @cached_property
    def own(self) -> dict[str, Value]:
        """The scenario's own settings. Throws InputError where it is refused."""
        resolved = resolved_settings(self.session, self.scenario, self.overrides)
        if isinstance(resolved, str):
            raise InputError(resolved)
        return own_settings(tomllib.loads(resolved.text))

    def run(self, points: Sequence[Mapping[str, Value]]) -> list[Design]:
        """Each point on the scenario's device; what that cannot hold again on a larger one.

        The scenario as it is runs before all of them: without it, or where it compares no frame,
        there is nothing that they could be held against.
        A point that changes something has as many partitions as make it fastest of those that fit,
        or one where none does: of all numbers that which takes least of a device.
        Throws InputError where the scenario itself is refused, though a larger device had room for
        it, and where no frame was compared; StudyError where it crashed.
        """
        self._check_scenario()
        tried = [0 for _ in points]
        scaling = {key: value for key, value in self.own.items() if key == SCALING}
        parted = [scaling | dict(columns) if columns else {} for columns in points]
        for index, choice in self._partitions(parted).items():
            parted[index][partitions.KEY] = choice.best or 1
            tried[index] = choice.tried
        records = self._records(self._settings(parted))
        self._try_memories(parted, records)
        return [
            design if design.columns else replace(design, columns=self.own, own=True)
            for design in self._designs(parted, tried)
        ]

    def variants(self, of: Sequence[tuple[Design, Mapping[str, Value]]]) -> list[Design]:
        """Designs with other iterations or passes, which leave its partitions the fastest."""
        parted = [
            {key: value for key, value in design.columns.items() if key != NODES or not design.own}
            | dict(changes)
            for design, changes in of
        ]
        found = self._designs(parted, [design.tried for design, _ in of])
        return [replace(design, between=True) for design in found]

    def _designs(self, parted: Sequence[Mapping[str, Value]], tried: Sequence[int]) -> list[Design]:
        """As they stand, and what the scenario's device cannot hold on a larger one."""
        settings = self._settings(parted)
        records = self._records(settings)
        unfit = [i for i, r in enumerate(records) if UNFIT in r.message]
        roomy = self._records([(*settings[i], f"accelerator.device={ROOMY}") for i in unfit])
        larger = dict(zip(unfit, roomy, strict=True))
        return [
            _design(columns, setting, records[i], larger.get(i), tried[i])
            for i, (columns, setting) in enumerate(zip(parted, settings, strict=True))
        ]

    def _settings(self, points: Sequence[Mapping[str, Value]]) -> list[tuple[str, ...]]:
        refined = bool(self.own[PASSES])
        return [
            (*self.overrides, "reference=true", *overrides_of(columns, refined))
            for columns in points
        ]

    def _try_memories(self, points: Sequence[dict[str, Value]], records: Sequence[Record]) -> None:
        """Give points that do not fit the memory with which they do, of those that the refusal
        names, and the partitions that are fastest with it."""
        groups: dict[tuple[str, ...], list[int]] = {}
        asked: list[tuple[tuple[str, ...], str]] = []
        for index, record in enumerate(records):
            if UNFIT in record.message and points[index]:
                held = _held({k: v for k, v in points[index].items() if k != partitions.KEY})
                if held not in groups:
                    found = _MEMORIES.findall(record.message)
                    asked += [(held, f"{key}={value}") for key, value in found]
                groups.setdefault(held, []).append(index)
        choices = partitions.fastest(
            self.session,
            self.scenario,
            [(*self.overrides, *held, memory) for held, memory in asked],
            self._own_partitions,
        )
        best: dict[tuple[str, ...], tuple[tuple[int, int], int, str]] = {}
        for (held, memory), choice in zip(asked, choices, strict=True):
            if choice.best is not None and choice.clocks is not None:
                entry = (choice.clocks, choice.best, memory)
                best[held] = min(best.get(held, entry), entry)
        for held, (_, number, memory) in best.items():
            for index in groups[held]:
                points[index] |= {partitions.KEY: number, MEMORY: memory}

    @property
    def _own_partitions(self) -> int:
        return int(str(self.own[partitions.KEY]))

    def _check_scenario(self) -> None:
        settings = (*self.overrides, "reference=true")
        (record,) = self._records([settings])
        message = record.message
        if UNFIT in message:
            (record,) = self._records([(*settings, f"accelerator.device={ROOMY}")])
        if not record.done:
            raise StudyError(message) if record.failed else InputError(message)
        if not _number(record, "accuracy.frames"):
            raise InputError(
                f"{self.scenario}: frames: no frame was compared with the true model: expected "
                "frames until the probe touches the body"
            )

    def _partitions(self, points: Sequence[Mapping[str, Value]]) -> dict[int, partitions.Choice]:
        """By the number of each point that changes something.

        Sets that differ in what the board does not hold are asked for once.
        """
        held = {i: _held(columns) for i, columns in enumerate(points) if columns}
        each = list(dict.fromkeys(held.values()))
        choices = partitions.fastest(
            self.session,
            self.scenario,
            [(*self.overrides, *settings) for settings in each],
            self._own_partitions,
        )
        found = dict(zip(each, choices, strict=True))
        return {i: found[settings] for i, settings in held.items()}

    def shares(self, designs: Sequence[Design]) -> list[float | None]:
        """The device's fullest kind of resource by design, 1 is full; nothing where not known."""
        return [self._share(design) for design in designs]

    def _share(self, design: Design) -> float | None:
        if design.state == "does not fit":
            # Of the scenario's own device, as the refusal says: "363 M4K of 255".
            needs = re.findall(r"(\d+) [\w-]+ of (\d+)", design.message)
            return max((int(used) / int(has) for used, has in needs), default=None)
        if not design.record.done:
            return None
        file = self.session.store.file(design.record.address, _KEEP[0])
        resources = json.loads(file.read_bytes())["resources"]
        return max((r["used"] / r["available"] for r in resources if r["available"]), default=None)

    def _records(self, settings: Sequence[tuple[str, ...]]) -> Sequence[Record]:
        return self.session.run([Point(self.scenario, setting, keep=_KEEP) for setting in settings])


def _held(columns: Mapping[str, Value]) -> tuple[str, ...]:
    """The overrides of what a board has to hold."""
    return overrides_of({k: v for k, v in columns.items() if k not in _NOT_HELD}, False)


def _design(
    columns: Mapping[str, Value],
    overrides: tuple[str, ...],
    record: Record,
    larger: Record | None,
    tried: int,
) -> Design:
    if larger is not None:
        used = larger if larger.done else record
        return Design(columns, overrides, used, "does not fit", record.message, tried)
    if not record.done:
        return Design(columns, overrides, record, record.status, record.message, tried)
    broken = (_number(record, "stability.breakdowns") or 0) > 0 or any(
        flag in BREAKDOWN_FLAGS for flag in record.flags
    )
    if broken:
        return Design(columns, overrides, record, "breaks down", " ".join(record.flags), tried)
    if not _number(record, "accuracy.frames"):
        return Design(columns, overrides, record, UNMEASURED, NO_CONTACT, tried)
    return Design(columns, overrides, record, _state(record), tried=tried)


def _state(record: Record) -> str:
    """Of a run whose solves went well."""
    if record.status == "held":
        return "fits"
    late = _number(record, "deadline.misses") or _number(record, "load.misses")
    return "late" if late else "beyond budget"


def front(designs: Sequence[Design], error: str = ERROR) -> list[Design]:
    """The usable designs of the scenario's mesh that none beats in both time and error, fastest
    first."""
    best: list[Design] = []
    usable = [d for d in designs if d.usable and d.own_mesh and d.error(error) is not None]
    for design in sorted(usable, key=lambda d: (d.time_us or 0.0, d.error(error) or 0.0)):
        if not best or (design.error(error) or 0.0) < (best[-1].error(error) or 0.0):
            best.append(design)
    return best


def _number(record: Record, name: str) -> float | None:
    value = record.metrics.get(name)
    return float(value) if isinstance(value, int | float) else None
