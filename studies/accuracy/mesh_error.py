"""The error of a scene's own mesh: the true law on ever finer meshes, pressed and at rest.

The finer meshes are of quadratic elements unless said otherwise, so that what a scene's linear ones
lack is in the error, and the limit is reached with fewer nodes.

Each size of mesh is taken three times, with a tenth of its nodes less, as wanted, and with a tenth
more: how many nodes a tip of a given radius catches differs from mesh to mesh, and so does the
force. Means of three are held against each other. Bodies are brought to rest by explicit steps
with much mass damping, which needs no matrix: increments with the matrix at rest diverge where
fine elements at a tip's edge are strained most.
"""

import csv
import io
import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.accuracy.fields import Field, difference
from studies.accuracy.grid import NODES
from studies.accuracy.ladder import resolved_settings
from studies.accuracy.measured import Scene
from studies.errors import InputError
from studies.point import Point
from studies.progress import run_with_progress
from studies.questions.answer import quantity
from studies.record import Record

_AROUND = (0.9, 1.0, 1.1)
_DIMENSIONS = 3
# What brings a body of some centimetres to rest soonest: near critical for its lowest mode.
_DAMPING = "dynamics.rayleigh_mass=100 1/s"
# A frame is compared with the one so many before it: what it moved in these is not at rest.
_FRAMES_BEFORE = 10
_MOST_MOVED = 1e-2
# Of the meshes that the limit is taken from; the first is the default.
ELEMENTS = ("quadratic", "quadratic-mean-dilatation", "linear")
# Orders that a mesh can have under a tip whose edge is a singularity.
_LEAST_ORDER, _MOST_ORDER = 0.5, 3.0
_FOR_AN_ORDER = 3  # sizes


@dataclass(frozen=True)
class Size:
    """Meshes of about as many nodes: how many they have, the force on each, N, and their kind of
    elements, as object.elements names it."""

    nodes: tuple[int, ...]
    forces: tuple[float, ...]
    elements: str = "linear"

    @property
    def mean(self) -> float:
        """Of the forces, N."""
        return math.fsum(self.forces) / len(self.forces)

    @property
    def scatter(self) -> float:
        """Half of what lies between the least and the largest, N."""
        return (max(self.forces) - min(self.forces)) / 2


@dataclass(frozen=True)
class Limit:
    """What the forces tend to, N: extrapolated with the order that they show, or the finest size's
    mean where they show none. `doubt` is how far that may be off, N."""

    force: float
    doubt: float
    order: float | None = None


@dataclass(frozen=True)
class MeshError:
    """Of the scene's own mesh, as shares of the limit; nothing where it could not be had, with the
    reason in `message`. The limit is that of `sizes`, which have `of_own_size` among them where the
    scene has elements of their kind."""

    sizes: tuple[Size, ...] = ()
    own: float | None = None  # N
    of_own_size: Size | None = None
    limit: Limit | None = None
    displacement: float | None = None
    message: str = ""

    @property
    def force(self) -> float | None:
        """|F - limit| over the limit."""
        if self.own is None or self.limit is None or not self.limit.force:
            return None
        return abs(self.own - self.limit.force) / self.limit.force

    @property
    def band(self) -> tuple[float, float] | None:
        """Between which the force's error lies on meshes of the scene's size, as far as the limit
        is known. The scene's own may be better than its size by chance."""
        if self.force is None or self.limit is None or self.of_own_size is None:
            return None
        errors = [abs(f - self.limit.force) / self.limit.force for f in self.of_own_size.forces]
        doubt = self.limit.doubt / self.limit.force
        return max(0.0, min(errors) - doubt), max(errors) + doubt

    @property
    def words(self) -> str:
        """What it is and what it is from, in a line."""
        band, limit = self.band, self.limit
        if band is None or limit is None or self.force is None:
            return f"The mesh's own error is not known: {self.message}."
        how = (
            f"extrapolated with the observed order {limit.order:.2g}"
            if limit.order is not None
            else "not extrapolated, as they show no order"
        )
        counts = ", ".join(str(round(sum(s.nodes) / len(s.nodes))) for s in self.sizes)
        text = (
            f"The mesh's own error of the force is {self.force:.2g}, and {band[0]:.2g} to "
            f"{band[1]:.2g} for meshes of its size: pressed and at rest, by the true law, {how}, "
            f"from meshes of about {counts} nodes, three each, of {self.sizes[-1].elements} "
            f"elements; the forces of the three finest are "
            f"within {self.sizes[-1].scatter / limit.force:.1g} of their middle"
        )
        if self.displacement is not None:
            text += f"; of the displacement {self.displacement:.2g}, against the finest mesh"
        return f"{text}.{f' {self.message}.' if self.message else ''}"


def mesh_error(
    scene: Scene, most_nodes: int, share: float, elements: str = ELEMENTS[0]
) -> MeshError:
    """Meshes of these elements from the scene's number of nodes on, doubled until the force changes
    by less than `share` or `most_nodes` would be exceeded; where the scene has elements of this
    kind itself, from half of its nodes on. Throws InputError where the scene itself is refused."""
    resolved = resolved_settings(scene.session, scene.scenario, scene.settings)
    if isinstance(resolved, str):
        raise InputError(resolved)
    settings = tomllib.loads(resolved.text)
    frames = frames_to_rest(settings)
    body = settings.get("object", {})
    own_nodes = body.get("mesh", {}).get("nodes")
    if frames is None or own_nodes is None:
        return MeshError(message="the scene has no hold in which the force could be taken")
    own = _pressed(scene, own_nodes, frames, body.get("elements", "linear"))
    if isinstance(own, str):
        return MeshError(message=own)
    same = own.size.elements == elements
    found: list[_Pressed] = []
    wanted, message = own_nodes // 2 if same else own_nodes, ""
    while wanted <= max(most_nodes, own_nodes):
        if same and wanted == own_nodes:
            found.append(own)
        else:
            pressed = _pressed(scene, wanted, frames, elements)
            if isinstance(pressed, str):
                message = pressed
                break
            found.append(pressed)
        if wanted >= own_nodes and settled([one.size for one in found], share):
            break
        # The scene's own number itself, which twice the half of an odd one would miss.
        wanted = own_nodes if wanted < own_nodes else 2 * wanted
    sizes = [one.size for one in found]
    apart = None
    if found and found[-1] is not own:
        fields = [
            Field.read(scene.session.store.file(one.middle.address, _step(frames)))
            for one in (own, found[-1])
        ]
        apart = difference(*fields)
    return MeshError(tuple(sizes), own.size.forces[1], own.size, limit_of(sizes), apart, message)


@dataclass(frozen=True)
class _Pressed:
    """The meshes of a size, and the run on the middle one."""

    size: Size
    middle: Record


def _pressed(scene: Scene, wanted: int, frames: int, elements: str) -> _Pressed | str:
    """Brought to rest under the tip, or why a mesh is not."""
    records = _run(scene, wanted, frames, elements)
    failed = [record for record in records if not _at_rest(scene, record, frames)]
    if failed:
        return f"Meshes of about {wanted} nodes are left out: {_why(failed[0])}"
    forces = tuple(_forces(scene, record)[-1] for record in records)
    counts = tuple(int(str(record.metrics["mesh.nodes"])) for record in records)
    return _Pressed(Size(counts, forces, elements), records[1])


def settled(sizes: Sequence[Size], share: float) -> bool:
    """Whether the last doubling moved the mean by less than this share of it."""
    return len(sizes) > 1 and abs(sizes[-1].mean - sizes[-2].mean) < share * abs(sizes[-1].mean)


def limit_of(sizes: Sequence[Size]) -> Limit | None:
    """Richardson's extrapolation of the last three sizes' means, with the order that they show in
    the elements' length, which is the cube root of a node's share of the volume.

    Three sizes show an order where the changes shrink, keep their sign, and are larger than the
    scatter of the finest size; else the limit is the mean of the finest one, and may be off by its
    scatter and by the last change.
    """
    if len(sizes) < 2:  # noqa: PLR2004
        return None
    *_, coarse, fine = (size.mean for size in sizes)
    scatter = sizes[-1].scatter
    plain = Limit(fine, max(scatter, abs(fine - coarse)))
    if len(sizes) < _FOR_AN_ORDER:
        return plain
    before, after = coarse - sizes[-3].mean, fine - coarse
    if before * after <= 0 or abs(after) >= abs(before) or abs(after) <= scatter:
        return plain
    order = math.log2(before / after) * _DIMENSIONS
    if not _LEAST_ORDER <= order <= _MOST_ORDER:
        return plain
    beyond = after / (2 ** (order / _DIMENSIONS) - 1)
    return Limit(fine + beyond, max(scatter, abs(beyond)), order)


def frames_to_rest(scenario: dict[str, Any]) -> int | None:
    """How many frames there are until the end of the first hold after a press; nothing without."""
    probe = scenario.get("probe")
    if not isinstance(probe, dict):
        return None
    time, pressed = 0.0, False
    for stroke in probe.get("motion", ()):
        time += quantity(stroke["duration"])
        pressed = pressed or stroke["phase"] == "press"
        if pressed and stroke["phase"] == "hold":
            return max(1, round(time / quantity(scenario["budget"]["period"])))
    return None


def _run(scene: Scene, wanted: int, frames: int, elements: str) -> list[Record]:
    settings = (
        *scene.settings,
        f"object.elements={elements}",
        "host.solver=explicit",
        f"object.model.kind={scene.truth}",
        "refinement=false",
        "reference=false",
        _DAMPING,
        "dynamics.rayleigh_stiffness=0 s",
        "fidelity.host=untimed",
        f"frames={frames}",
        f"output.deformation_every_frames={max(1, frames - 1)}",
    )
    keep = ("frames.csv", _step(frames))
    points = [
        Point(scene.scenario, (*settings, f"{NODES}={round(factor * wanted)}"), keep=keep)
        for factor in _AROUND
    ]
    return list(run_with_progress(scene.session, points))


def _step(frames: int) -> str:
    return f"deformation_{frames - 1:06}.vtu"


def _forces(scene: Scene, record: Record) -> list[float]:
    """|F| of every frame, N."""
    path: Path = scene.session.store.file(record.address, "frames.csv")
    rows = csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))
    return [float(row["force_N"]) for row in rows]


def _at_rest(scene: Scene, record: Record, frames: int) -> bool:
    if not record.done:
        return False
    forces = _forces(scene, record)
    if len(forces) < frames or not forces[-1]:
        return False
    before = forces[max(0, frames - 1 - _FRAMES_BEFORE)]
    return abs(forces[-1] - before) < _MOST_MOVED * abs(forces[-1])


def _why(record: Record) -> str:
    if not record.done:
        return record.message or record.status
    return " ".join(record.flags) or "the body does not come to rest"
