# SPDX-License-Identifier: Apache-2.0
"""A way to a board that is written in Python: the call-backs of struct hvp_bus."""

from __future__ import annotations

import errno
from enum import IntEnum
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hvp_board._driver import ffi, lib


class Interrupt(IntEnum):
    """How a wait for an interrupt ended."""

    RAISED = 0
    TIMED_OUT = 1
    BUS_FAILED = 2


class Bus(Protocol):
    """Offsets are bytes in the board's BAR; what each has to do, driver/hvp_bus.h says."""

    def read32(self, offset: int) -> int: ...
    def write32(self, offset: int, value: int) -> None: ...
    def read_block(self, offset: int, count: int) -> NDArray[np.uint32]: ...
    def write_block(self, offset: int, words: NDArray[np.uint32]) -> None: ...
    def wait_interrupt(self, timeout_ns: int) -> Interrupt: ...
    def now_ns(self) -> int: ...


ALL_ONES = 0xFFFFFFFF


class BusCalls:
    """The C side of a Bus. What a call-back raises does not go through the driver: the board does
    not answer any more, and the call of the driver that was made raises it (raise_again). An
    InterruptedError of a wait is none: the driver is told, and the wait is made again."""

    def __init__(self, bus: Bus) -> None:
        self.bus = bus
        self.raised: BaseException | None = None
        self.handle = ffi.new_handle(self)
        self.calls = ffi.new("struct hvp_bus*")
        self.calls.context = self.handle
        for name in ("read32", "write32", "read_block", "write_block", "wait_interrupt", "now_ns"):
            setattr(self.calls, name, getattr(lib, f"bus_{name}"))

    def raise_again(self) -> None:
        raised, self.raised = self.raised, None
        if raised is not None:
            raise raised

    def call(self, name: str, otherwise: Any, *arguments: Any) -> Any:
        if self.raised is not None:
            return otherwise
        try:
            return getattr(self.bus, name)(*arguments)
        except InterruptedError as raised:
            # The driver hands it on, and the board goes on.
            if name != "wait_interrupt":
                self.raised = raised
            return otherwise
        except BaseException as raised:
            self.raised = raised
            return otherwise


def _calls(context: Any) -> BusCalls:
    calls: BusCalls = ffi.from_handle(context)
    return calls


def _words(pointer: Any, count: int) -> NDArray[np.uint32]:
    return np.frombuffer(ffi.buffer(pointer, 4 * count), dtype=np.uint32)


@ffi.def_extern()
def bus_read32(context: Any, offset: int) -> int:
    return int(_calls(context).call("read32", ALL_ONES, offset)) & ALL_ONES


@ffi.def_extern()
def bus_write32(context: Any, offset: int, value: int) -> None:
    _calls(context).call("write32", None, offset, value)


@ffi.def_extern()
def bus_read_block(context: Any, offset: int, words: Any, count: int) -> None:
    ones = np.full(count, ALL_ONES, dtype=np.uint32)
    _words(words, count)[:] = _calls(context).call("read_block", ones, offset, count)


@ffi.def_extern()
def bus_write_block(context: Any, offset: int, words: Any, count: int) -> None:
    # A copy: the driver uses the memory again.
    _calls(context).call("write_block", None, offset, _words(words, count).copy())


@ffi.def_extern()
def bus_wait_interrupt(context: Any, timeout_ns: int) -> int:
    return int(_calls(context).call("wait_interrupt", -errno.EINTR, timeout_ns))


@ffi.def_extern()
def bus_now_ns(context: Any) -> int:
    return int(_calls(context).call("now_ns", 0))
