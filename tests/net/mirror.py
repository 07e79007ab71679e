"""The mirror image of a scene gives the mirror image of its forces.

Asked of a polyhedron of a few corners: a mesh of its corners alone, with nothing inside, comes out
mirrored when the surface does. A finer one does not: the mesher puts nodes where its order of
work leads it.
"""

import itertools
import math
import random
from collections.abc import Iterator

from laws import Law
from physics import HOST, largest, on_the_host
from run_files import Run
from scenario import Scenario, quantity, vector

Point = tuple[float, float, float]
Triangle = tuple[int, int, int]

# The same sums with other signs, and in the order in which the mesher leaves its tetrahedra.
ORDER_REL = 1e-9
SURFACE = "polyhedron.stl"
CORNERS = (5, 7)


def minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a: Point, b: Point) -> Point:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Point, b: Point) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def hull(points: list[Point]) -> list[Triangle]:
    """The triangles that have all other points behind them, wound outwards."""
    triangles = []
    for i, j, k in itertools.combinations(range(len(points)), 3):
        normal = cross(minus(points[j], points[i]), minus(points[k], points[i]))
        sides = [
            dot(normal, minus(point, points[i]))
            for at, point in enumerate(points)
            if at not in (i, j, k)
        ]
        if max(sides) < 0:
            triangles.append((i, j, k))
        elif min(sides) > 0:
            triangles.append((i, k, j))
    return triangles


def draw_corners(rng: random.Random) -> list[Point]:
    """In millimetres, about 50 from the origin, each of them a corner of the hull."""
    count = rng.randint(*CORNERS)
    while True:
        points: list[Point] = []
        for _ in range(count):
            x, y, z = (rng.gauss(0, 1) for _ in range(3))
            far = rng.uniform(40, 50) / math.hypot(x, y, z)
            points.append((round(x * far, 3), round(y * far, 3), round(z * far, 3)))
        if len({corner for triangle in hull(points) for corner in triangle}) == count:
            return points


def stl(points: list[Point], triangles: list[Triangle]) -> str:
    facets = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in (points[at] for at in triangle))
        + "endloop\nendfacet\n"
        for triangle in triangles
    ]
    return "solid\n" + "".join(facets) + "endsolid\n"


def pressed_polyhedron(rng: random.Random, scenario: Scenario) -> Scenario:
    """Held at its lowest corners, pressed in the middle of its highest face. Millimetres of the
    surface become metres only in the scenario. Contact is found anew in every frame: how long a
    search takes, and so when a pass of the collision process ends, is the mesher's order too."""
    changed = on_the_host(rng, scenario)
    changed.effects.add("contact.fresh")
    loads = ("loads.point", "loads.pressure", "loads.prescribed")
    for name in (*loads, "object.mesh", "object.region"):
        changed.take_out(name)
    points = draw_corners(rng)
    triangles = hull(points)

    def height(triangle: Triangle) -> float:
        return sum(points[at][2] for at in triangle)

    a, b, c = (points[at] for at in max(triangles, key=height))
    normal = cross(minus(b, a), minus(c, a))
    deep = rng.uniform(1, 4) / math.hypot(*normal)
    start = [round((a[i] + b[i] + c[i]) * 1e-3 / 3, 6) for i in range(3)]
    end = [round(start[i] - deep * normal[i] * 1e-3, 6) for i in range(3)]
    changed.files[SURFACE] = stl(points, triangles)
    changed.values |= {
        "object.mesh.shape": '"surface"',
        "object.mesh.surface": f'"{SURFACE}"',
        "object.mesh.nodes": str(len(points)),
        "probe.start": vector(tuple(start)),
    }
    held = quantity(0.45, "number")
    changed.lists["object.anchor"] = [{"kind": '"lowest-fraction"', "fraction": held}]
    seconds = quantity(rng.uniform(20e-3, 100e-3), "time")
    press = {"phase": '"press"', "to": vector(tuple(end)), "duration": seconds}
    changed.lists["probe.motion"] = [press]
    return changed


def first_negated(value: str) -> str:
    """The x of a vector as it is written here."""
    first, comma, rest = value.partition(",")
    quote = '"' if '"' in first else ""
    number = first.lstrip("[").strip(quote)
    number = number[1:] if number.startswith("-") else f"-{number}"
    return f"[{quote}{number}{quote}{comma}{rest}"


def mirrored(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    """At the plane of y and z."""
    changed = scenario.copy()
    lines = []
    for line in changed.files[SURFACE].splitlines():
        word, _space, coordinates = line.partition(" ")
        if word == "vertex":
            x, y, z = coordinates.split()
            line = f"vertex {-float(x)!r} {y} {z}"  # noqa: PLW2901
        lines.append(line)
    # A mirrored triangle is wound the other way: its last two corners change places.
    for at, line in enumerate(lines):
        if line == "endloop":
            lines[at - 2], lines[at - 1] = lines[at - 1], lines[at - 2]
    changed.files[SURFACE] = "\n".join(lines) + "\n"
    for name in ("probe.start", "loads.gravity.acceleration"):
        if name in changed.values:
            changed.values[name] = first_negated(changed.values[name])
    for stroke in changed.lists["probe.motion"]:
        stroke["to"] = first_negated(stroke["to"])
    return changed


def mirrored_force(before: Run, after: Run) -> Iterator[str]:
    one, other = (run.summary["mesh"] for run in (before, after))
    if (one["nodes"], one["tetrahedra"]) != (other["nodes"], other["tetrahedra"]):
        return  # parted in another way
    if not math.isclose(one["min_dihedral_deg"], other["min_dihedral_deg"], rel_tol=ORDER_REL):
        return
    scale = largest(before.frames)
    for old, new in zip(before.frames, after.frames, strict=False):
        if old.force is None or new.force is None:
            continue
        if (-old.tip[0], *old.tip[1:]) != new.tip:
            return  # read at another time: how long a search takes is the mesher's order, too
        image = (-old.force[0], *old.force[1:])
        if math.dist(image, new.force) > ORDER_REL * scale:
            yield f"frame {old.number}: {old.force} N became {new.force} N, not its image"
            return


MIRROR = Law(
    "mirror",
    mirrored,
    mirrored_force,
    prepare=pressed_polyhedron,
    keeps=(*HOST, "object.mesh.nodes"),
)
