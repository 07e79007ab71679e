# SPDX-License-Identifier: Apache-2.0
"""A board that `hvp serve` models in another process, by Python's standard library alone.

Registers, memory that the board reaches, and interrupts over a vfio-user socket
(docs/vfio-user.md): for a look at the board and for tests. The driver itself is in C; its way over
the same socket is driver/user/vfio_user_client.h.

    with VfioUser("board") as board:
        print(hex(board.read32(0)))

A model can be asked for faults (inject) and to say when a point has come (stop_at).
"""

from __future__ import annotations

import array
import json
import mmap
import os
import select
import socket
import struct
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType

HEADER = struct.Struct("=HHIII")  # id, command, bytes of header and body, flags, error
REPLY, TYPE, ERROR = 1, 15, 32

VERSION, DMA_MAP, DMA_UNMAP, REGION_INFO, SET_IRQS = 1, 2, 3, 5, 8
REGION_READ, REGION_WRITE, DEVICE_RESET = 9, 10, 13

ACCESS = struct.Struct("=QII")  # offset, region, bytes
REGION = struct.Struct("=IIIIQQ")
MAP = struct.Struct("=IIQQQ")
UNMAP = struct.Struct("=IIQQ")
IRQS = struct.Struct("=IIIII")

BAR0, CONFIG = 0, 7
INTX, MSI, MSI_X = 0, 1, 2
EVENTFD_TRIGGER, NONE_UNMASK = 4 | 32, 1 | 16

PCI_COMMAND, PCI_CAPABILITIES = 0x04, 0x34
MEMORY_AND_MASTER = 6
MSI_CAPABILITY, MSI_X_CAPABILITY = 5, 0x11
VENDOR_CAPABILITY = 9
# Within the vendor's: of a command, four characters; which word of the answer; that word.
MODEL_COMMAND, MODEL_PLACE, MODEL_ANSWER = 4, 8, 12
LONGEST_COMMAND, MOST_PLACES = 255, 256

NOBODY = 0xFF  # of a function that was pulled out

PATIENCE_S = 60.0


class VfioUserError(OSError):
    """What the server has refused, with its error number, or a connection that has ended."""


class ModelError(ValueError):
    """Words that the model has refused, with why."""


@dataclass(frozen=True)
class Stop:
    """A point that has come."""

    time_ps: int  # simulated
    job: int  # the newest, -1 before the first
    offset: int  # of an access in the BAR
    value: int  # an access' word, or the number in the point
    what: str  # all of that in one line


class VfioUser:
    """A client. Switches the function on: memory space, bus master, and messages where it has them.

    Raises VfioUserError with EBUSY where another client is served.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._next_id = 0
        self._memory: dict[int, mmap.mmap] = {}
        self._masked = False
        self._model = 0
        self._points: dict[str, Callable[[Stop], None]] = {}
        self._interrupt = os.eventfd(0, os.EFD_CLOEXEC | os.EFD_NONBLOCK)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._socket.settimeout(PATIENCE_S)
            self._socket.connect(os.fspath(path))
            capabilities = json.dumps({"capabilities": {"max_msg_fds": 1}}).encode() + b"\0"
            reply = self._command(VERSION, struct.pack("=HH", 0, 1) + capabilities)
            self.version: tuple[int, int] = struct.unpack_from("=HH", reply)
            region = self._command(REGION_INFO, REGION.pack(REGION.size, 0, BAR0, 0, 0, 0))
            self.bar_bytes: int = REGION.unpack_from(region)[4]
            self._switch_on()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._socket.close()
        if self._interrupt >= 0:
            os.close(self._interrupt)
        self._interrupt = -1

    def __enter__(self) -> VfioUser:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def read(self, offset: int, count: int, region: int = BAR0) -> bytes:
        """`count` bytes of the board's BAR, or of its configuration space."""
        reply = self._command(REGION_READ, ACCESS.pack(offset, region, count))
        self._tell_stops(region)
        return reply[ACCESS.size :]

    def write(self, offset: int, data: bytes, region: int = BAR0) -> None:
        self._command(REGION_WRITE, ACCESS.pack(offset, region, len(data)) + data)
        self._tell_stops(region)

    def read32(self, offset: int) -> int:
        return int.from_bytes(self.read(offset, 4), "little")

    def write32(self, offset: int, value: int) -> None:
        self.write(offset, value.to_bytes(4, "little"))

    def read_config(self, offset: int, count: int) -> int:
        return int.from_bytes(self.read(offset, count, CONFIG), "little")

    def write_config(self, offset: int, value: int, count: int) -> None:
        self.write(offset, value.to_bytes(count, "little"), CONFIG)

    def share(self, bus_address: int, count: int) -> mmap.mmap:
        """New memory, zero at first, that the board reaches at that address: whole pages."""
        file = os.memfd_create("hvp-dma")
        try:
            os.ftruncate(file, count)
            memory = mmap.mmap(file, count)
            self._command(DMA_MAP, MAP.pack(MAP.size, 3, 0, bus_address, count), file)
        finally:
            os.close(file)
        self._memory[bus_address] = memory
        return memory

    def unshare(self, bus_address: int) -> None:
        memory = self._memory.pop(bus_address)
        self._command(DMA_UNMAP, UNMAP.pack(UNMAP.size, 0, bus_address, len(memory)))

    def wait_interrupt(self, timeout_s: float) -> bool:
        """Until the board's interrupt, as long as that; at once if it has come since the last."""
        if self._masked:
            self._masked = False
            self._command(SET_IRQS, IRQS.pack(IRQS.size, NONE_UNMASK, INTX, 0, 1))
        ready, _, _ = select.select([self._interrupt], [], [], timeout_s)
        if ready:
            os.eventfd_read(self._interrupt)
            self._masked = not self.messages
        self._tell_stops(BAR0)
        return bool(ready)

    def inject(self, fault: str) -> None:
        """Makes a fault happen, in the words of a scenario's [[fault]] (docs/faults.md) with commas
        between: "kind=lost-interrupt", "kind=master-abort,access=status,count=2". A frame is a job.
        Without `frame` and `rate` it strikes where it can next. ModelError for other words, which
        change nothing."""
        self._order("fault " + fault)

    def stop_at(self, point: str, stopped: Callable[[Stop], None] | None) -> None:
        """Calls `stopped` when a point has come (docs/faults.md): "write to CONTROL", "read of
        STATUS", "interrupt 3", "message 3", "job 7". That is in the call whose access or wait it
        was, and simulated time stands still until then. It may do all that this client can. None
        takes the point away again. ModelError for other words."""
        if stopped is None:
            self._order("stop no more at " + point)
            del self._points[point]
        else:
            self._order("stop at " + point)
            self._points[point] = stopped

    def _order(self, command: str) -> None:
        refused = self._ask(command)
        if refused:
            raise ModelError(refused)

    def _ask(self, command: str) -> str:
        characters = command.encode()
        if len(characters) > LONGEST_COMMAND or b"\0" in characters:
            raise ModelError(f"expected at most {LONGEST_COMMAND} characters, and no zero")
        if self._model == 0:
            self._model = self._find(VENDOR_CAPABILITY)
        if self._model == 0:
            raise ModelError("the board takes no such words: expected one of hvp serve")
        padded = characters + b"\0" * (4 - len(characters) % 4)
        for at in range(0, len(padded), 4):
            self.write(self._model + MODEL_COMMAND, padded[at : at + 4], CONFIG)
        if self.read_config(self._model, 1) != VENDOR_CAPABILITY:
            raise ModelError("the function is not there any more")
        answer = b""
        for place in range(MOST_PLACES):
            self.write_config(self._model + MODEL_PLACE, place, 4)
            answer += self.read(self._model + MODEL_ANSWER, 4, CONFIG)
            if b"\0" in answer:
                break
        return answer.partition(b"\0")[0].decode()

    def _stopped(self) -> str:
        """What has stopped; nothing can have where the function was pulled out."""
        try:
            return self._ask("stopped?")
        except ModelError:
            return ""

    def _tell_stops(self, region: int) -> None:
        while region == BAR0 and self._points and (said := self._stopped()):
            time_ps, job, offset, value, what = said.split(" ", 4)
            stop = Stop(int(time_ps), int(job), int(offset), int(value), what)
            for point, stopped in list(self._points.items()):
                if what.startswith(point + " "):
                    stopped(stop)

    def reset(self) -> None:
        """As after power-on, and switched on again."""
        self._command(DEVICE_RESET)
        self._switch_on()

    def _switch_on(self) -> None:
        self.write_config(PCI_COMMAND, MEMORY_AND_MASTER, 2)
        index, enable, place = MSI, 1, self._find(MSI_CAPABILITY)
        if place == 0:
            index, enable, place = MSI_X, 1 << 15, self._find(MSI_X_CAPABILITY)
        self.messages = place != 0
        self._masked = False
        if not self.messages:
            index = INTX
        self._command(SET_IRQS, IRQS.pack(IRQS.size, EVENTFD_TRIGGER, index, 0, 1), self._interrupt)
        if self.messages:
            self.write_config(place + 2, self.read_config(place + 2, 2) | enable, 2)

    def _find(self, capability: int) -> int:
        place = self.read_config(PCI_CAPABILITIES, 1)
        while place not in (0, NOBODY) and self.read_config(place, 1) != capability:
            place = self.read_config(place + 1, 1)
        return 0 if place == NOBODY else place

    def _command(self, number: int, body: bytes = b"", file: int | None = None) -> bytes:
        message_id = self._next_id
        self._next_id = (self._next_id + 1) & 0xFFFF
        message = HEADER.pack(message_id, number, HEADER.size + len(body), 0, 0) + body
        files = [] if file is None else [file]
        try:
            sent = socket.send_fds(self._socket, [message], files) if files else 0
            self._socket.sendall(message[sent:])
        except BrokenPipeError:
            if number != VERSION:  # who is refused finds why in front of the closed door
                raise
        answered, _, size, flags, error = HEADER.unpack(self._receive(HEADER.size))
        reply = self._receive(size - HEADER.size)
        if flags & TYPE != REPLY:
            raise VfioUserError("the server sent no reply")
        if flags & ERROR:
            raise VfioUserError(error, os.strerror(error))
        if answered != message_id:
            raise VfioUserError("a reply to another command")
        return reply

    def _receive(self, count: int) -> bytes:
        data = array.array("B", bytes(count))
        view = memoryview(data)
        while view:
            got = self._socket.recv_into(view)
            if got == 0:
                raise VfioUserError("the server has closed the connection")
            view = view[got:]
        return data.tobytes()
