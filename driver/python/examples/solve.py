# SPDX-License-Identifier: Apache-2.0
"""Solves a chain of springs on a board, and again with numpy: how far are they apart?

    python solve.py ADDRESS

ADDRESS is a device file (/dev/hvp0) or a board behind a socket (vfio-user:PATH, of `hvp serve`).
A chain of 12 nodes is held at its ends and pulled in x; neighbours are joined by springs of 100 N/m
along the chain and 40 N/m across it.

The board computes with whole numbers. K goes to words of 12 bits, b to words of 16, and with a
static shift of s the board solves K u = 2^s b in those words. So a length is
u · (scale of K / scale of b) / 2^s.
"""

import sys

import hvp_board
import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Whole = NDArray[np.int64]

NODES = 12
SPRING = np.diag([100.0, 40.0, 40.0])  # N/m
PULL = 0.5  # N, on the node in the middle
MATRIX_BITS, VECTOR_BITS, SHIFT = 12, 16, 11
LARGEST_ERROR = 0.001  # words of 16 bits, and what CG loses on its way


def chain() -> tuple[Real, Whole, Whole]:
    """Its stiffness in N/m: blocks of 3 x 3 row after row, their columns, where each row begins."""
    blocks, columns, begin = [], [], [0]
    for node in range(NODES):
        for column in range(max(0, node - 1), min(NODES, node + 2)):
            blocks.append(2 * SPRING if column == node else -SPRING)
            columns.append(column)
        begin.append(len(columns))
    return np.array(blocks), np.array(columns), np.array(begin)


def dense(blocks: Real, columns: Whole, begin: Whole) -> Real:
    k = np.zeros((3 * NODES, 3 * NODES))
    for node in range(NODES):
        for i in range(begin[node], begin[node + 1]):
            column = columns[i]
            k[3 * node : 3 * node + 3, 3 * column : 3 * column + 3] = blocks[i]
    return k


def main() -> int:
    try:
        _, address = sys.argv
    except ValueError:
        print("expected: solve.py ADDRESS", file=sys.stderr)
        return 2
    blocks, columns, begin = chain()
    load = np.zeros((NODES, 3))
    load[NODES // 2, 0] = PULL
    wanted = np.linalg.solve(dense(blocks, columns, begin), load.reshape(-1)).reshape(NODES, 3)

    # As large as the words allow. A whole number of words per N/m, so that these springs are whole
    # words: rounding them would loosen one of two neighbours and cost 1.4 % here.
    k_scale = np.floor((2 ** (MATRIX_BITS - 1) - 1) / np.abs(blocks).max())  # words per N/m
    u_scale = 0.9 * 2 ** (VECTOR_BITS - 1) / np.abs(wanted).max()  # words per m
    b_scale = k_scale * u_scale / 2**SHIFT  # words per N
    settings = hvp_board.Settings(
        iterations=60,
        matrix_bits=MATRIX_BITS,
        vector_bits=VECTOR_BITS,
        static_shift=SHIFT,
        dynamic_scaling=True,
        headroom_bits=1,
    )
    with hvp_board.open(address) as board:
        board.configure(settings)
        board.load(hvp_board.Matrix(begin, columns, np.rint(k_scale * blocks).astype(int)))
        u = board.solve(np.rint(b_scale * load).astype(int), timeout=5.0)
        result = board.read_result()
    error = np.abs(u / u_scale - wanted).max() / np.abs(wanted).max()
    moved = 1e3 * u[NODES // 2, 0] / u_scale
    print(f"moved by {moved:.3f} mm after {result.iterations} iterations")
    print(f"largest difference from numpy: {1e2 * error:.2f} % of that")
    return 0 if error < LARGEST_ERROR else 1


if __name__ == "__main__":
    sys.exit(main())
