"""Writes bean.stl, the project's own non-convex surface, beside this file.

The unit sphere, a subdivided icosahedron, is stretched to an ellipsoid and bent along a
parabola: (x, y, z) becomes (40 x, 20 y + 25 x² - 4.5, 20 z) in millimetres, a bean of
80 x 49 x 40 mm with a hollow of 9 mm in its upper side. Only +, -, *, / and square roots are
used, so the file is the same wherever it is written.

    python3 scenarios/surfaces/make_bean.py
"""

from __future__ import annotations

import math
from pathlib import Path

Point = tuple[float, float, float]
Triangle = tuple[int, int, int]

# Each of the icosahedron's 20 faces becomes FREQUENCY² triangles: 500, near what a body of 500
# nodes wants on its surface.
FREQUENCY = 5

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0
CORNERS: list[Point] = [
    (-1.0, GOLDEN, 0.0),
    (1.0, GOLDEN, 0.0),
    (-1.0, -GOLDEN, 0.0),
    (1.0, -GOLDEN, 0.0),
    (0.0, -1.0, GOLDEN),
    (0.0, 1.0, GOLDEN),
    (0.0, -1.0, -GOLDEN),
    (0.0, 1.0, -GOLDEN),
    (GOLDEN, 0.0, -1.0),
    (GOLDEN, 0.0, 1.0),
    (-GOLDEN, 0.0, -1.0),
    (-GOLDEN, 0.0, 1.0),
]
FACES: list[Triangle] = [
    *((0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11)),
    *((1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8)),
    *((3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9)),
    *((4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)),
]


def sphere(frequency: int) -> tuple[list[Point], list[Triangle]]:
    """A geodesic sphere of radius 1, triangles outward."""
    points: list[Point] = []
    triangles: list[Triangle] = []
    # A point is known by the corners it is mixed from and their weights, not by its rounded
    # coordinates, so that neighbouring faces share it exactly.
    index_of: dict[tuple[tuple[int, int], ...], int] = {}

    def point(face: Triangle, weights: Triangle) -> int:
        mix = tuple(sorted((c, w) for c, w in zip(face, weights, strict=True) if w))
        if mix not in index_of:
            x, y, z = (sum(w * CORNERS[c][axis] for c, w in mix) for axis in range(3))
            length = math.sqrt(x * x + y * y + z * z)
            index_of[mix] = len(points)
            points.append((x / length, y / length, z / length))
        return index_of[mix]

    for face in FACES:
        for i in range(frequency):
            for j in range(frequency - i):
                k = frequency - i - j
                triangles.append(
                    (
                        point(face, (k, i, j)),
                        point(face, (k - 1, i + 1, j)),
                        point(face, (k - 1, i, j + 1)),
                    )
                )
                if k > 1:
                    triangles.append(
                        (
                            point(face, (k - 1, i + 1, j)),
                            point(face, (k - 2, i + 1, j + 1)),
                            point(face, (k - 1, i, j + 1)),
                        )
                    )
    return points, triangles


def bend(point: Point) -> Point:
    x, y, z = point
    return 40.0 * x, 20.0 * y + 25.0 * x * x - 4.5, 20.0 * z


def normal(a: Point, b: Point, c: Point) -> Point:
    u = (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    v = (c[0] - a[0], c[1] - a[1], c[2] - a[2])
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    return n[0] / length, n[1] / length, n[2] / length


def number(value: float) -> str:
    """Six decimals, a nanometre; no negative zero."""
    return f"{round(value, 6) + 0.0:.6f}"


def stl(points: list[Point], triangles: list[Triangle]) -> str:
    """The one place for a comment in STL is the rest of its first line."""
    lines = ["solid bean, millimetres; made for this project by scenarios/surfaces/make_bean.py"]
    for triangle in triangles:
        corners = [points[i] for i in triangle]
        lines.append("facet normal " + " ".join(map(number, normal(*corners))))
        lines.append(" outer loop")
        lines.extend("  vertex " + " ".join(map(number, corner)) for corner in corners)
        lines.append(" endloop")
        lines.append("endfacet")
    lines.append("endsolid bean")
    return "\n".join(lines) + "\n"


def main() -> None:
    points, triangles = sphere(FREQUENCY)
    text = stl([bend(p) for p in points], triangles)
    Path(__file__).with_name("bean.stl").write_text(text, encoding="ascii")


if __name__ == "__main__":
    main()
