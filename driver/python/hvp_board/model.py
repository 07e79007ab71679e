# SPDX-License-Identifier: Apache-2.0
"""A board that `hvp serve` models, as a Bus: the driver here, faults and stops on demand.

    with VfioUser("board") as model, hvp_board.open_bus(ModelBus(model)) as board:
        model.inject("kind=lost-interrupt")

Time is this machine's, as behind any socket (docs/vfio-user.md).
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from hvp_board.bus import Interrupt
from hvp_board.vfio_user import VfioUser

LONGEST_WAIT_S = 86_400.0


class ModelBus:
    """The call-backs of the driver over a client's connection. Faults of the bus show as what the
    accesses bring: nobody asks the bridge."""

    def __init__(self, model: VfioUser) -> None:
        self.model = model

    def read32(self, offset: int) -> int:
        return self.model.read32(offset)

    def write32(self, offset: int, value: int) -> None:
        self.model.write32(offset, value)

    def read_block(self, offset: int, count: int) -> NDArray[np.uint32]:
        return np.frombuffer(self.model.read(offset, 4 * count), dtype="<u4")

    def write_block(self, offset: int, words: NDArray[np.uint32]) -> None:
        self.model.write(offset, words.astype("<u4").tobytes())

    def wait_interrupt(self, timeout_ns: int) -> Interrupt:
        raised = self.model.wait_interrupt(min(1e-9 * timeout_ns, LONGEST_WAIT_S))
        return Interrupt.RAISED if raised else Interrupt.TIMED_OUT

    def now_ns(self) -> int:
        return time.monotonic_ns()
