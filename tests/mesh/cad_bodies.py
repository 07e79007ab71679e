"""Meshes bodies as CAD programs write them, with many counts of nodes.

Prisms of 6 to 128 sides, rods, plates, rings and L-shapes, turned in space: few points, and long
facets with short ends. A request is met within a tenth of its count, or the count that the refusal
offers is one that is met.

    python3 tests/mesh/cad_bodies.py build/release/app/hvp            a share of the counts
    python3 tests/mesh/cad_bodies.py build/release/app/hvp --all      twenty counts of each body
"""

import argparse
import math
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

Point = tuple[float, float, float]
Flat = tuple[float, float]
COUNTS = [round(80 * (1500 / 80) ** (i / 19)) for i in range(20)]
ACCEPTED = 0.10
LONGEST_S = 300


@dataclass(frozen=True)
class Body:
    name: str
    outline: tuple[Flat, ...]  # counter-clockwise, mm
    caps: tuple[tuple[int, int, int], ...]  # its triangles
    height: float
    hole: tuple[Flat, ...] = ()


def circle(sides: int, radius: float) -> tuple[Flat, ...]:
    turn = 2 * math.pi / sides
    return tuple((radius * math.cos(i * turn), radius * math.sin(i * turn)) for i in range(sides))


def fan(points: int) -> tuple[tuple[int, int, int], ...]:
    return tuple((0, i, i + 1) for i in range(1, points - 1))


def prism(sides: int, radius: float, height: float) -> Body:
    name = f"prism of {sides} sides, {2 * radius:g} mm wide, {height:g} mm high"
    return Body(name, circle(sides, radius), fan(sides), height)


def box(x: float, y: float, height: float) -> Body:
    outline = ((0.0, 0.0), (x, 0.0), (x, y), (0.0, y))
    return Body(f"box of {x:g} x {y:g} x {height:g} mm", outline, fan(4), height)


def angle(arm: float, width: float, height: float) -> Body:
    outline = (
        (0.0, 0.0),
        (arm, 0.0),
        (arm, width),
        (width, width),
        (width, arm),
        (0.0, arm),
    )
    caps = ((3, 0, 1), (3, 1, 2), (3, 4, 5), (3, 5, 0))
    return Body(f"angle of {arm:g} mm", outline, caps, height)


def ring(sides: int, radius: float, hole: float, height: float) -> Body:
    outline = circle(sides, radius)
    caps = []
    for i in range(sides):
        j = (i + 1) % sides
        caps += [(i, j, sides + i), (j, sides + j, sides + i)]
    return Body(f"ring of {sides} sides", outline, tuple(caps), height, circle(sides, hole))


BODIES = (
    prism(6, 25, 20),
    prism(12, 25, 20),
    prism(32, 25, 20),
    prism(64, 25, 20),
    prism(128, 25, 20),
    prism(16, 5, 100),
    prism(48, 60, 4),
    box(200, 8, 8),
    box(100, 80, 4),
    box(27, 29, 4),
    angle(60, 12, 15),
    ring(24, 40, 25, 10),
    ring(64, 40, 30, 15),
)


def turned(p: Point) -> Point:
    """By 40 degrees about z and 27 about x, so that no facet lies along an axis."""
    a, b = math.radians(40), math.radians(27)
    x = p[0] * math.cos(a) - p[1] * math.sin(a)
    y = p[0] * math.sin(a) + p[1] * math.cos(a)
    return (x, y * math.cos(b) - p[2] * math.sin(b), y * math.sin(b) + p[2] * math.cos(b))


def triangles_of(body: Body) -> list[tuple[Point, Point, Point]]:
    flat = (*body.outline, *body.hole)
    low = [turned((x, y, 0.0)) for x, y in flat]
    high = [turned((x, y, body.height)) for x, y in flat]
    triangles = [(high[a], high[b], high[c]) for a, b, c in body.caps]
    triangles += [(low[c], low[b], low[a]) for a, b, c in body.caps]

    def wall(begin: int, points: int, outward: bool) -> None:
        for i in range(points):
            a, b = begin + i, begin + (i + 1) % points
            if not outward:
                a, b = b, a
            triangles.append((low[a], low[b], high[b]))
            triangles.append((low[a], high[b], high[a]))

    wall(0, len(body.outline), True)
    wall(len(body.outline), len(body.hole), False)
    return triangles


def stl(body: Body) -> str:
    lines = ["solid body"]
    for triangle in triangles_of(body):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(f"{component:.7g}" for component in p) for p in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid body", ""])


def mesh(program: Path, file: Path, nodes: int) -> tuple[int, str]:
    """The mesh's nodes, or none and why."""
    command = [str(program), "mesh", str(file), "--nodes", str(nodes), "--quiet"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST_S)
    found = re.search(r"^nodes +(\d+)", ended.stdout, re.MULTILINE)
    return (int(found[1]) if found else 0), ended.stderr.strip()


def look_at(program: Path, body: Body, file: Path, nodes: int) -> tuple[str, bool]:
    """What is wrong, if anything, and whether the request itself was met."""
    got, refusal = mesh(program, file, nodes)
    if got:
        off = abs(got - nodes) / nodes
        wrong = f"{body.name}, {nodes} nodes: got {got}" if off > ACCEPTED else ""
        return wrong, not wrong
    offered = re.search(r"expected (\d+), of which a mesh was made", refusal)
    if offered is None:
        return f"{body.name}, {nodes} nodes: {refusal}", False
    count = int(offered[1])
    got, refusal = mesh(program, file, count)
    if got and abs(got - count) <= ACCEPTED * count:
        return "", False
    return f"{body.name}: {count} were offered for {nodes}, and then {refusal or got}", False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--all", action="store_true", help="twenty counts of each body")
    parser.add_argument("--share", type=int, default=10, help="else one in so many")
    arguments = parser.parse_args()
    cases = [(body, nodes) for body in BODIES for nodes in COUNTS]
    if not arguments.all:
        cases = cases[:: arguments.share - 1]
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(os.cpu_count()) as pool:
        files = {body: Path(folder) / f"{n}.stl" for n, body in enumerate(BODIES)}
        for body, file in files.items():
            file.write_text(stl(body), encoding="utf-8")
        asked = [
            pool.submit(look_at, arguments.program, body, files[body], nodes)
            for body, nodes in cases
        ]
        ended = [one.result() for one in asked]
    complaints = [wrong for wrong, _ in ended if wrong]
    for complaint in complaints:
        print(complaint)
    met = sum(hit for _, hit in ended)
    print(
        f"{len(ended)} meshes asked for, {met} met within {ACCEPTED:.0%}, {len(complaints)} wrong"
    )
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
