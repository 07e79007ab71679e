# SPDX-License-Identifier: Apache-2.0
"""The driver of the hvp solver board, with numpy arrays in and out.

    import hvp_board

    with hvp_board.open("/dev/hvp0") as board:
        board.configure(hvp_board.Settings(iterations=60, matrix_bits=12, vector_bits=16))
        board.load(matrix)
        u = board.solve(b, timeout=0.01)

docs/driver.md of the project is what lies below.
"""

from hvp_board.board import (
    Board,
    Capability,
    Info,
    Result,
    Statistics,
    open,  # noqa: A004 as in gzip and tarfile
    open_bus,
)
from hvp_board.bus import Bus, Interrupt
from hvp_board.matrix import Matrix
from hvp_board.settings import Method, Rounding, Settings, StartFrom
from hvp_board.status import BoardError, Status

__all__ = [
    "Board",
    "BoardError",
    "Bus",
    "Capability",
    "Info",
    "Interrupt",
    "Matrix",
    "Method",
    "Result",
    "Rounding",
    "Settings",
    "StartFrom",
    "Statistics",
    "Status",
    "open",
    "open_bus",
]
