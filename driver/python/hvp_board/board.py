# SPDX-License-Identifier: Apache-2.0
"""A board, and the calls of driver/user/hvp_client.h."""

from __future__ import annotations

import os
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from hvp_board._driver import ffi, lib
from hvp_board.bus import Bus, BusCalls
from hvp_board.matrix import BLOCK, BlockSparse, Matrix, Words, words
from hvp_board.settings import Settings
from hvp_board.status import BoardError, Status, check

NS = 1_000_000_000


@dataclass(frozen=True)
class Capability:
    """What the board can do; `methods` and `start_modes` have bit n for number n."""

    max_nodes: int
    max_row_blocks: int
    max_blocks: int
    max_matrix_bits: int
    max_vector_bits: int
    max_rhs_bits: int
    max_coefficient_bits: int
    clock_khz: int
    methods: int
    start_modes: int
    max_scalar_bits: int


@dataclass(frozen=True)
class Info:
    """How the board is reached."""

    dma: bool
    interrupts: bool
    messages: bool
    longest_wait_ms: int  # 0: any wait is made


@dataclass(frozen=True)
class Result:
    """Of the last job. `cycles` are of the board's clock; `flags`: RESULT_FLAGS."""

    job: int
    iterations: int
    reached: bool
    replacements: int
    saturations: int
    wraps: int
    breakdowns: int
    flags: int
    cycles: int


@dataclass(frozen=True)
class Statistics:
    """What went wrong and cost time only."""

    lost_interrupts: int
    lost_acknowledgements: int


def _nanoseconds(timeout: float) -> int:
    if not timeout >= 0.0:
        raise ValueError(f"timeout {timeout}: expected a time in seconds")
    return int(min(timeout * NS, 2**63 - 1))


def _copy(kind: Any, structure: Any) -> Any:
    return kind(**{name: getattr(structure, name) for name in kind.__dataclass_fields__})


class Board:
    """Made by open() and open_bus(). Failures raise BoardError. One thread uses a board."""

    def __init__(self, client: Any, calls: BusCalls | None = None) -> None:
        self._client = client
        self._calls = calls
        self._nodes = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        raised: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Aborts what runs. A board that is closed stays so."""
        if self._client == ffi.NULL:
            return
        client, self._client = self._client, ffi.NULL
        self._done(lib.hvp_client_close(client), 0)

    @property
    def capability(self) -> Capability:
        capability: Capability = _copy(Capability, lib.hvp_client_capability(self._open()))
        return capability

    @property
    def info(self) -> Info:
        info: Info = _copy(Info, lib.hvp_client_info_of(self._open()))
        return info

    @property
    def statistics(self) -> Statistics:
        found = ffi.new("struct hvp_statistics*")
        self._call(lib.hvp_client_statistics, found)
        statistics: Statistics = _copy(Statistics, found)
        return statistics

    @property
    def last_flags(self) -> int:
        """The low 16 numerical flags of the last job (RESULT_FLAGS in docs/registers.md)."""
        flags: int = lib.hvp_client_last_flags(self._open())
        return flags

    def fileno(self) -> int:
        """For select: readable when a job has ended. BoardError where there is no file."""
        descriptor: int = lib.hvp_client_descriptor(self._open())
        if descriptor < 0:
            raise ValueError("this board has no file")
        return descriptor

    def reset(self) -> None:
        """Settings and matrix are gone."""
        self._nodes = 0
        self._call(lib.hvp_client_reset)

    def configure(self, settings: Settings) -> None:
        self._call(lib.hvp_client_configure, settings.to_c())

    def load(self, matrix: Matrix | BlockSparse) -> None:
        """Sends K. A scipy.sparse.bsr_array of whole numbers is taken as it is."""
        k = matrix if isinstance(matrix, Matrix) else Matrix.of(matrix)
        self._repeat(lib.hvp_client_load_matrix, k.to_c())
        self._nodes = k.nodes

    def update_values(self, values: ArrayLike, timeout: float) -> None:
        """Other entries for the matrix that is loaded: blocks of 3 x 3, as load() had them. What
        is constrained stays so. BoardError with Status.ERROR_TIMEOUT where the board is busy with
        them so many seconds after the last was sent; then reset()."""
        blocks = words(values, "values")
        if blocks.ndim != BLOCK or blocks.shape[1:] != (BLOCK, BLOCK):
            raise ValueError("values: expected blocks of 3 x 3")
        elements = ffi.from_buffer("int32_t[]", blocks.reshape(-1))
        self._repeat(lib.hvp_client_update_values, elements, blocks.size, _nanoseconds(timeout))

    def constrain(self, node: int, diagonal: int) -> None:
        """Zeroes the node's row and column but for the diagonal."""
        self._call(lib.hvp_client_constrain_node, node, diagonal)

    def restore(self, node: int, values: ArrayLike) -> None:
        """Gives the node its row back: blocks of 3 x 3, as load() had them."""
        row = words(values, "values")
        if row.shape[1:] != (BLOCK, BLOCK):
            raise ValueError("values: expected blocks of 3 x 3")
        elements = ffi.from_buffer("int32_t[]", row.reshape(-1))
        self._call(lib.hvp_client_restore_node, node, elements, row.shape[0])

    def write_rhs(self, b: ArrayLike) -> None:
        self._send(lib.hvp_client_write_rhs, b, "b")

    def write_initial_guess(self, u: ArrayLike) -> None:
        self._send(lib.hvp_client_write_initial_guess, u, "u")

    def start(self) -> None:
        self._call(lib.hvp_client_start)

    def wait(self, timeout: float) -> None:
        """Until the job has ended, or so many seconds have passed: BoardError with
        Status.ERROR_TIMEOUT. A signal whose handler returns does not end it."""
        self._repeat(lib.hvp_client_wait, _nanoseconds(timeout))

    def read_solution(self) -> Words:
        """U, as an array of [nodes, 3]."""
        u = np.empty((self._nodes, BLOCK), dtype=np.int32)
        self._call(
            lib.hvp_client_read_solution, ffi.from_buffer("int32_t[]", u.reshape(-1)), u.size
        )
        return u

    def read_result(self) -> Result:
        found = ffi.new("struct hvp_result*")
        self._call(lib.hvp_client_read_result, found)
        result: Result = _copy(Result, found)
        return result

    def solve(self, b: ArrayLike, timeout: float) -> Words:
        """write_rhs, start, wait, read_solution."""
        # No job is begun that would not be waited for.
        longest = _nanoseconds(timeout)
        self.write_rhs(b)
        self.start()
        self._repeat(lib.hvp_client_wait, longest)
        return self.read_solution()

    def _open(self) -> Any:
        if self._client == ffi.NULL:
            raise ValueError("the board is closed")
        return self._client

    def _send(self, call: Any, vector: ArrayLike, what: str) -> None:
        elements = words(vector, what).reshape(-1)
        self._call(call, ffi.from_buffer("int32_t[]", elements), elements.size)

    def _call(self, call: Any, *arguments: Any) -> None:
        client = self._open()
        self._done(call(client, *arguments), lib.hvp_client_error_detail(client))

    def _done(self, status: int, detail: int) -> None:
        errno = ffi.errno
        if self._calls is not None:
            self._calls.raise_again()
        ffi.errno = errno
        check(status, detail)

    def _repeat(self, call: Any, *arguments: Any) -> None:
        """A call that goes on where a signal interrupted it, as Python's own do; the signal's
        handler, which may raise, runs in between."""
        while True:
            try:
                return self._call(call, *arguments)
            except BoardError as error:
                if error.status != Status.ERROR_INTERRUPTED:
                    raise


def _opened(status: int, client: Any, calls: BusCalls | None = None) -> Board:
    errno = ffi.errno
    if calls is not None:
        calls.raise_again()
    ffi.errno = errno
    check(status)
    return Board(client[0], calls)


def open(address: str | os.PathLike[str]) -> Board:  # noqa: A001
    """The board at an address: the path of a device file, or a scheme and what belongs to it.
    ValueError where there is no such scheme."""
    client = ffi.new("struct hvp_client**")
    text = os.fsencode(address)
    status = lib.hvp_client_open(client, text)
    if Status(status) == Status.ERROR_ARGUMENT:
        schemes = ffi.string(lib.hvp_client_schemes()).decode()
        raise ValueError(f"{os.fsdecode(text)}: expected {schemes}")
    return _opened(status, client)


def open_bus(bus: Bus) -> Board:
    """A board behind call-backs in Python; the driver runs in this process."""
    calls = BusCalls(bus)
    client = ffi.new("struct hvp_client**")
    return _opened(lib.hvp_client_open_bus(client, calls.calls), client, calls)
