"""Files for hvp-servo (driver/linux/guest/servo_frames.h): a small system, and what it answers."""

import random
import struct
from pathlib import Path

NODES = 40
HEAD_WORDS = 4
RECORD_WORDS = 12
HVP_IOC_C_DYNAMIC_SCALING = 1


def _chain() -> tuple[list[int], list[int], list[int]]:
    """A chain of nodes: symmetric, diagonally dominant, in 12-bit numbers."""
    row_begin, column, value = [0], [], []
    for row in range(NODES):
        for other in (row - 1, row, row + 1):
            if not 0 <= other < NODES:
                continue
            column.append(other)
            diagonal = 1500 + 7 * (row % 11) if other == row else -400
            beside = 30 if other == row else 10
            value += [diagonal if i % 4 == 0 else beside for i in range(9)]
        row_begin.append(len(column))
    return row_begin, column, value


def write_frames(path: Path, frames: int, period_ns: int = 2_000_000) -> None:
    row_begin, column, value = _chain()
    draw = random.Random(1)
    words = [0x46505648, 1, NODES, len(column), frames, period_ns, 0, 0]
    #        method, start, iterations, residual (2), replace, shift, flags, headroom, threshold,
    words += [0, 0, 25, 0, 0, 0, 11, HVP_IOC_C_DYNAMIC_SCALING, 1, 0]
    #        step, matrix, vector, rhs, scalar, coefficient bits, alpha, beta, division, shift
    words += [0, 12, 16, 0, 0, 16, 0, 0, 0, 0]
    words += row_begin + column + value
    for _ in range(frames):
        words += [0] + [draw.randrange(-4095, 4096) for _ in range(3 * NODES)]
    path.write_bytes(struct.pack(f"<{len(words)}I", *(w & 0xFFFFFFFF for w in words)))


class Output:
    """What hvp-servo wrote: each frame's times, in ns, and its U."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        words = struct.unpack(f"<{len(data) // 4}i", data)
        size = RECORD_WORDS + 3 * words[2]
        if (len(words) - HEAD_WORDS) % size != 0:
            raise ValueError(f"{path}: {len(data)} bytes are not whole frames")
        self.times: list[tuple[int, ...]] = []  # due, woken, started, ended, read
        self.solutions: list[tuple[int, ...]] = []
        for at in range(HEAD_WORDS, len(words), size):
            self.times.append(struct.unpack_from("<5Q", data, 4 * at))
            self.solutions.append(words[at + RECORD_WORDS : at + size])
