# SPDX-License-Identifier: Apache-2.0
"""What a call of the driver returns, and the exception that it becomes."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from hvp_board._driver import ffi, lib


def _text(value: Any) -> str:
    return ffi.string(value).decode()


class Status(IntEnum):
    """hvp_status of driver/hvp_status.h, without its prefix."""

    OK = 0
    ERROR_ARGUMENT = 1
    ERROR_STATE = 2
    ERROR_RANGE = 3
    ERROR_CAPABILITY = 4
    ERROR_NO_DEVICE = 5
    ERROR_VERSION = 6
    ERROR_BUS = 7
    ERROR_TIMEOUT = 8
    ERROR_INTERRUPTED = 9
    ERROR_DATA = 10
    ERROR_STALE_RESULT = 11
    ERROR_SHORT_TRANSFER = 12
    ERROR_SATURATED = 13
    ERROR_BAD_SIZE = 14
    ERROR_BAD_MATRIX = 15
    ERROR_BAD_SETTING = 16
    ERROR_NOT_LOADED = 17
    ERROR_BAD_NODE = 18
    ERROR_BAD_ROW = 19
    ERROR_BAD_DESCRIPTOR = 20
    ERROR_DMA = 21
    ERROR_ILLEGAL_ACCESS = 22
    ERROR_BOARD = 23


class BoardError(OSError):
    """A call that failed. `errno` is the system's, as hvp_errno.h maps it."""

    def __init__(self, status: Status, errno: int, detail: int) -> None:
        super().__init__(errno, _text(lib.hvp_status_text(int(status))))
        self.status = status
        # The number that goes with an error which the board reported: a register's offset, a node.
        self.detail = detail


def check(status: int, detail: int = 0) -> None:
    """Raises what is not HVP_OK. To be called before anything else touches errno."""
    errno = ffi.errno
    if status != lib.HVP_OK:
        raise BoardError(Status(status), errno, detail)
