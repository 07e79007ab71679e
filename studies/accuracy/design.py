"""Error against modelled frame time over the settings of the solver."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from studies.errors import InputError
from studies.point import Point, Value
from studies.record import Record
from studies.session import Session

ERROR = "accuracy.displacement_rel"
FORCE_ERROR = "accuracy.force_rel"
TIME = "deadline.worst_us"
BUDGET = "deadline.budget_us"
TARGETS = (1e-1, 1e-2, 1e-3)

_KEEP = ("summary.json",)  # for the resources, a list
_METHODS = ("cg", "jacobi-pcg")
_ITERATIONS = (15, 30, 60, 120)
_WORDS = ((12, 16), (18, 24), (24, 32))
_BREAKDOWN_FLAGS = (
    "negative-curvature",
    "zero-diagonal",
    "scalar-overflow",
    "divergence",
    "wrapped",
)
# Larger than any of the thesis' time: holds what the scenario's own device does not.
ROOMY = "U280"


@dataclass(frozen=True)
class Design:
    """A choice of settings with what became of it.

    `state` is how a table calls it: fits, late, breaks down, does not fit, or refused. `shares` are
    the largest share of a kind of the device's resources. What does not fit has the figures that it
    would have on a larger device with the same clock.
    """

    columns: Mapping[str, Value]
    overrides: tuple[str, ...]
    record: Record
    state: str
    message: str = ""

    @property
    def time_us(self) -> float | None:
        """Worst latency, µs."""
        return _number(self.record, TIME)

    def error(self, name: str = ERROR) -> float | None:
        """Against the true model; nothing where no frame was compared."""
        return _number(self.record, name) if _number(self.record, "accuracy.frames") else None

    @property
    def usable(self) -> bool:
        """Whether it is a design for this device and this budget."""
        return self.state == "fits" and self.error() is not None and self.time_us is not None


def grid(full: bool, nodes: int | None) -> list[dict[str, Value]]:
    """Settings to be tried, the scenario's own (no setting) first."""
    methods = (*_METHODS, "block-jacobi-pcg") if full else _METHODS
    iterations = (8, *_ITERATIONS, 240) if full else _ITERATIONS
    points: list[dict[str, Value]] = [{}]
    points += [_columns(*chosen) for chosen in product(methods, iterations, _WORDS, (0, 2))]
    scaled = product(["cg"], iterations if full else (30, 60), _WORDS)
    points += [_columns(*chosen) | {"solver.matrix_scaling": "diagonal"} for chosen in scaled]
    if nodes:
        sizes = (nodes // 4, nodes // 2, 2 * nodes) if full else (nodes // 2,)
        coarse = product(["cg"], (30, 60), _WORDS, (0,), sizes)
        points += [
            _columns(*chosen[:4]) | {"object.mesh.nodes": chosen[4]}
            for chosen in coarse
            if chosen[4] >= _LEAST_NODES
        ]
    return points


_LEAST_NODES = 40


def _columns(
    method: str, iterations: int, words: tuple[int, int], passes: int = 0
) -> dict[str, Value]:
    return {
        "solver.method": method,
        "solver.iterations": iterations,
        "solver.matrix_bits": words[0],
        "solver.vector_bits": words[1],
        "refinement.passes": passes,
    }


def overrides_of(columns: Mapping[str, Value], has_refinement: bool) -> tuple[str, ...]:
    """For `--set`: no passes means no refinement at all."""
    settings = []
    for key, value in columns.items():
        if key == "refinement.passes" and not value:
            settings += ["refinement=false"] if has_refinement else []
        else:
            settings.append(f"{key}={value}")
    return tuple(settings)


@dataclass
class DesignStudy:
    """Runs the grid on one scenario."""

    session: Session
    scenario: Path
    overrides: tuple[str, ...]

    def run(self, points: Sequence[Mapping[str, Value]], has_refinement: bool) -> list[Design]:
        """Each point on the scenario's device; what that cannot hold again on a larger one.

        Throws InputError where the scenario itself is refused, and where no frame was compared.
        """
        settings = [
            (*self.overrides, "reference=true", *overrides_of(columns, has_refinement))
            for columns in points
        ]
        records = self._records(settings)
        if records[0].status == "refused":
            raise InputError(records[0].message)
        unfit = [i for i, r in enumerate(records) if "cannot hold" in r.message]
        roomy = self._records([(*settings[i], f"accelerator.device={ROOMY}") for i in unfit])
        larger = dict(zip(unfit, roomy, strict=True))
        designs = [
            _design(columns, setting, records[i], larger.get(i))
            for i, (columns, setting) in enumerate(zip(points, settings, strict=True))
        ]
        if not any(design.error() is not None for design in designs):
            raise InputError(
                f"{self.scenario}: frames: no frame was compared with the true model: expected "
                "frames until the probe touches the body"
            )
        return designs

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

    def _records(self, settings: Sequence[tuple[str, ...]]) -> list[Record]:
        return self.session.run([Point(self.scenario, setting, keep=_KEEP) for setting in settings])


def _design(
    columns: Mapping[str, Value],
    overrides: tuple[str, ...],
    record: Record,
    larger: Record | None,
) -> Design:
    if larger is not None:
        used = larger if larger.done else record
        return Design(columns, overrides, used, "does not fit", record.message)
    if not record.done:
        return Design(columns, overrides, record, record.status, record.message)
    broken = (_number(record, "stability.breakdowns") or 0) > 0 or any(
        flag in _BREAKDOWN_FLAGS for flag in record.flags
    )
    if broken:
        return Design(columns, overrides, record, "breaks down", " ".join(record.flags))
    return Design(columns, overrides, record, "fits" if record.status == "held" else "late")


def front(designs: Sequence[Design], error: str = ERROR) -> list[Design]:
    """The usable designs that no other one beats in both time and error, fastest first."""
    best: list[Design] = []
    usable = [d for d in designs if d.usable and d.error(error) is not None]
    for design in sorted(usable, key=lambda d: (d.time_us or 0.0, d.error(error) or 0.0)):
        if not best or (design.error(error) or 0.0) < (best[-1].error(error) or 0.0):
            best.append(design)
    return best


def words(designs: Sequence[Design], device: str) -> list[str]:
    """What each accuracy costs at least, the question that the study answers."""
    budget = _number(designs[0].record, BUDGET)
    lines = []
    for target in TARGETS:
        reaching = [d for d in designs if (d.error() or 0.0) <= target and d.error() is not None]
        usable = [d for d in reaching if d.usable]
        if usable:
            best = min(usable, key=lambda d: d.time_us or 0.0)
            lines.append(
                f"A displacement error of {target:g} costs at least {_ms(best)} on this device "
                f"({device}), of {len(designs)} sets with the scenario's other keys; the cheapest "
                f"is {describe(best)}: error {best.error():.2g}, "
                f"force {_text(best.error(FORCE_ERROR))}."
            )
            faster = [d for d in reaching if (d.time_us or 0.0) < (best.time_us or 0.0)]
            if faster:
                lines.append(
                    f"{len(faster)} sets would be faster and are none here, as they do not fit, "
                    "are late or break down; with another accelerator.partitions or memory some "
                    "may fit: their rows say what does."
                )
        elif reaching:
            best = min(reaching, key=lambda d: d.time_us or 0.0)
            lines.append(
                f"A displacement error of {target:g}: none of these sets reaches it on this device "
                f"({device}) within the budget; the nearest {best.state}: {_ms(best)} with "
                f"{describe(best)}."
            )
        else:
            lines.append(f"A displacement error of {target:g}: no set of these reaches it.")
    own = designs[0]
    lines.append(
        f"The scenario itself: {_ms(own)}, error {_text(own.error())}, force "
        f"{_text(own.error(FORCE_ERROR))}; budget {(budget or 0) / 1000:g} ms."
    )
    return lines


def describe(design: Design) -> str:
    """A design's settings in few words."""
    if not design.columns:
        return "the scenario's own"
    c = design.columns
    text = (
        f"{c['solver.method']}, {c['solver.iterations']} iterations, "
        f"{c['solver.matrix_bits']}/{c['solver.vector_bits']} bits"
    )
    if c.get("refinement.passes"):
        text += f", refined in {c['refinement.passes']} passes"
    if c.get("solver.matrix_scaling"):
        text += ", diagonal scaling"
    if c.get("object.mesh.nodes"):
        text += f", {c['object.mesh.nodes']} nodes"
    return text


def _ms(design: Design) -> str:
    return f"{design.time_us / 1000:.3g} ms" if design.time_us is not None else "no time"


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}"


def _number(record: Record, name: str) -> float | None:
    value = record.metrics.get(name)
    return float(value) if isinstance(value, int | float) else None
