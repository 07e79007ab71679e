"""What the host converts: docs/fixed-point.md. Doubles, each operation rounded by itself."""

import math
from dataclasses import dataclass
from pathlib import Path

from spec_matrix import Matrix
from spec_words import Settings, Vector, limit


@dataclass
class System:
    """A symmetric matrix by its entries, and b. Rows are filled up to nodes of three."""

    rows: int
    entries: dict[tuple[int, int], float]
    b: list[float]

    @property
    def nodes(self) -> int:
        return (self.rows + 2) // 3


def numbers(file: Path) -> list[list[str]]:
    lines = file.read_text(encoding="ascii").splitlines()
    return [line.split() for line in lines[1:] if not line.startswith("%")]


def read_system(matrix: Path, rhs: Path) -> System:
    """Matrix Market: `coordinate real symmetric`, and an `array`. docs/solve.md: the filling."""
    (size, *lines) = numbers(matrix)
    rows = int(size[0])
    lower = sorted((int(i) - 1, int(j) - 1, float(value)) for i, j, value in lines)
    entries: dict[tuple[int, int], float] = {}
    mean = 0.0
    for i, j, value in lower:
        entries[i, j] = entries[j, i] = value
        if i == j:
            mean += value / rows
    system = System(rows, entries, [float(line[0]) for line in numbers(rhs)[1:]])
    for i in range(rows, 3 * system.nodes):
        entries[i, i] = mean
        system.b.append(0.0)
    return system


def to_nearest(value: float) -> int:
    """Ties away from zero."""
    size = math.floor(2 * abs(value)) + 1 >> 1
    return size if value >= 0 else -size


class Host:
    """The words of a system, and what they are worth."""

    def __init__(self, system: System, settings: dict[str, object], displacement_range: float):
        self.system = system
        rows = 3 * system.nodes
        self.scale = [1.0] * rows
        entries = dict(system.entries)
        if settings["matrix_scaling"] == "diagonal":
            self.scale = [1.0 / math.sqrt(entries[i, i]) for i in range(rows)]
            for i, j in entries:
                entries[i, j] *= self.scale[i] * self.scale[j]
        bits = int(str(settings["matrix_bits"]))
        self.matrix_unit = max(map(abs, entries.values())) / limit(bits)
        words = {at: to_nearest(entry / self.matrix_unit) for at, entry in entries.items()}
        self.matrix = self.blocks(words)
        vector_bits = int(str(settings["vector_bits"]))
        if settings["matrix_scaling"] == "diagonal":
            displacement_range /= min(self.scale)
        self.unit = displacement_range / limit(vector_bits)

    def blocks(self, words: dict[tuple[int, int], int]) -> Matrix:
        nodes = self.system.nodes
        pattern = sorted({(i // 3, j // 3) for i, j in words} | {(i, i) for i in range(nodes)})
        row_begin = [sum(1 for i, _ in pattern if i < row) for row in range(nodes + 1)]
        value = [
            words.get((3 * i + e // 3, 3 * j + e % 3), 0) for i, j in pattern for e in range(9)
        ]
        return Matrix(row_begin, [j for _, j in pattern], value)

    def right_hand_side(self, s: Settings) -> tuple[Vector, int]:
        """Words, and how many were clamped."""
        unit = math.ldexp(self.matrix_unit * self.unit, s.h)
        exact = [
            to_nearest((b * scale) / unit)
            for b, scale in zip(self.system.b, self.scale, strict=True)
        ]
        most = limit(s.rhs_bits)
        return [max(-most, min(most, word)) for word in exact], sum(abs(w) > most for w in exact)

    def displacements(self, x: Vector) -> list[float]:
        worth = [scale * (self.unit * word) for scale, word in zip(self.scale, x, strict=True)]
        return worth[: self.system.rows]
