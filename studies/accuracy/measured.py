"""What became of each family's members: errors in several norms, and what they cost."""

import csv
import io
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from studies.accuracy.design import BREAKDOWN_FLAGS, NO_CONTACT, UNFIT, UNMEASURED
from studies.accuracy.families import Member
from studies.point import Point, Value
from studies.progress import run_with_progress
from studies.record import Record
from studies.session import Session
from studies.store import Store

# A column: the figure of the run that it shows.
NORMS: Mapping[str, str] = {
    f"{what}_{short}": f"accuracy.{what}{figure}"
    for what in ("displacement", "force")
    for short, figure in (
        ("mean_rel", "_rel"),
        ("median", "_of_frame.median"),
        ("p95", "_of_frame.p95"),
        ("worst", "_of_frame.worst"),
    )
}
WORST = "deadline.worst_us"
MEDIAN = "deadline.p50_us"
LOAD = "load.worst_us"

_FRAMES = "frames.csv"
_SUMMARY = "summary.json"
_PERFORMANCE = "performance.json"  # of the machine at hand: wall-clock times
_KEEP = (_FRAMES, _SUMMARY, _PERFORMANCE)
# For what the scene's device does not hold. It has the same types of memory as the thesis' board,
# so that a scene may name them.
_ROOMY = "EP2S180"
# A host that is never late: what a late member's error would be if there were one.
_FAST = "host.sustained_rate=1 Tflop/s"
_FAST_SOLVER = "host.solver_rate=0 flop/s"  # the same; a key that only a host that solves has
_NO_MEMORY = ("multipliers", "logic", "registers")


@dataclass(frozen=True)
class Measured:
    """A member with its run. `state`: fits, late, breaks down, does not fit, not measured, refused,
    crashed or timed out.

    The figures of what does not fit are those on a larger device with the same clock. A late
    member has its own times, and in `accurate` the errors of a host that is not late: frames that
    are skipped would else be errors of time and not of the model.
    """

    member: Member
    record: Record
    accurate: Record
    state: str
    message: str = ""
    load_median_us: float | None = None
    memory_share: float | None = None
    set_up_s: float | None = None
    peak_memory_mb: float | None = None

    @property
    def worst_us(self) -> float | None:
        """Worst latency of a frame, µs."""
        return _number(self.record, WORST)

    def error(self, norm: str) -> float | None:
        """In one of NORMS; nothing where no frame was compared."""
        known = _number(self.accurate, "accuracy.frames")
        return _number(self.accurate, NORMS[norm]) if known else None

    @property
    def drawn(self) -> bool:
        """Whether it has a place on a curve: it may be too slow or too large for this device."""
        return self.state in ("fits", "late", "does not fit")


@dataclass(frozen=True)
class Scene:
    """A scenario with what every run of it changes, and the law that is taken as true."""

    session: Session
    scenario: Path
    settings: tuple[str, ...]
    truth: str

    @property
    def name(self) -> str:
        """As its file is called."""
        return self.scenario.stem

    def run(self, members: Sequence[Member]) -> list[Measured]:
        """Every member; what does not fit or is late a second time."""
        settings = [(*self._compared, *member.overrides) for member in members]
        first = self._records(settings)
        unfit = [i for i, record in enumerate(first) if UNFIT in record.message]
        larger = [(*settings[i], f"accelerator.device={_ROOMY}") for i in unfit]
        records = dict(enumerate(first)) | dict(zip(unfit, self._records(larger), strict=True))
        settings = [
            (*chosen, f"accelerator.device={_ROOMY}") if i in unfit else chosen
            for i, chosen in enumerate(settings)
        ]
        late = [i for i, record in records.items() if record.done and _late(record)]
        fast = self._records([(*settings[i], *_fast(members[i])) for i in late])
        accurate = records | dict(zip(late, fast, strict=True))
        return [
            self._measured(member, first[i], records[i], accurate[i])
            for i, member in enumerate(members)
        ]

    @property
    def _compared(self) -> tuple[str, ...]:
        return (*self.settings, "reference=true", f"reference.model={self.truth}")

    def _records(self, settings: Sequence[tuple[str, ...]]) -> list[Record]:
        points = [Point(self.scenario, chosen, keep=_KEEP) for chosen in settings]
        return list(run_with_progress(self.session, points))

    def _measured(
        self, member: Member, first: Record, record: Record, accurate: Record
    ) -> Measured:
        if not record.done or not accurate.done:
            failed = accurate if record.done else record
            return Measured(
                member, record, accurate, failed.status, first.message or failed.message
            )
        unfit = UNFIT in first.message
        broken = bool(_number(accurate, "stability.breakdowns")) or any(
            flag in BREAKDOWN_FLAGS for flag in accurate.flags
        )
        message = first.message if unfit else ""
        if broken:
            state, message = "breaks down", " ".join(accurate.flags)
        elif not _number(accurate, "accuracy.frames"):
            state, message = UNMEASURED, NO_CONTACT
        elif unfit:
            state = "does not fit"
        else:
            state = "late" if _late(record) else "fits"
        store = self.session.store
        performance = json.loads(store.file(record.address, _PERFORMANCE).read_bytes())
        return Measured(
            member,
            record,
            accurate,
            state,
            message,
            _median_load(store, record),
            fullest_asked(first.message) if unfit else _memory(store, record),
            performance["build_scene_s"],
            performance["peak_memory_mb"],
        )


def _fast(member: Member) -> tuple[str, ...]:
    return (_FAST,) if member.solver == "board" else (_FAST, _FAST_SOLVER)


def front(of: Sequence[Measured], norm: str) -> list[Measured]:
    """Those that none of them beats in both time and error, fastest first."""
    best: list[Measured] = []
    known = [
        (m.worst_us, error, m)
        for m in of
        if m.drawn and (error := m.error(norm)) and m.worst_us is not None
    ]
    least = float("inf")
    for _, error, measured in sorted(known, key=lambda item: item[:2]):
        if error < least:
            best.append(measured)
            least = error
    return best


def fullest_asked(message: str) -> float | None:
    """The fullest memory that a refusal names, as a share of the device's: "324 M4K of 255"."""
    needs = re.findall(r"(\d+) ([\w-]+) of (\d+)", message)
    shares = [int(used) / int(has) for used, kind, has in needs if kind not in _NO_MEMORY]
    return max(shares, default=None)


def _memory(store: Store, record: Record) -> float | None:
    """The fullest type of memory on the board; nothing where there is no board."""
    resources = json.loads(store.file(record.address, _SUMMARY).read_bytes())["resources"]
    return max(
        (
            r["used"] / r["available"]
            for r in resources or ()
            if r["available"] and r["type"] not in _NO_MEMORY
        ),
        default=None,
    )


def _median_load(store: Store, record: Record) -> float:
    text = store.file(record.address, _FRAMES).read_text(encoding="utf-8")
    return median(float(row["load_us"]) for row in csv.DictReader(io.StringIO(text)))


def _late(record: Record) -> bool:
    return bool(_number(record, "deadline.misses") or _number(record, "load.misses"))


def _number(record: Record, name: str) -> float | None:
    value: Value = record.metrics.get(name)
    return float(value) if isinstance(value, int | float) else None
