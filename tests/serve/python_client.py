"""The Python client on a served board: registers, interrupts, a solve by DMA.

python_client.py HVP SCENARIO
"""

from __future__ import annotations

import errno
import runpy
import struct
import sys
import tempfile
import unittest
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from served import Served

# As a file of its own: the package around it wants more than the standard library.
CLIENT = Path(__file__).parents[2] / "driver/python/hvp_board/vfio_user.py"
if TYPE_CHECKING:
    from hvp_board.vfio_user import ModelError, Stop, VfioUser, VfioUserError
else:
    client = runpy.run_path(str(CLIENT))
    VfioUser, VfioUserError = client["VfioUser"], client["VfioUserError"]
    ModelError, Stop = client["ModelError"], client["Stop"]

HVP, SCENARIO = Path(sys.argv[1]), sys.argv[2]

# docs/registers.md
ID, CONTROL, STATUS, INTERRUPT_STATUS, INTERRUPT_ENABLE = 0x00, 0x20, 0x24, 0x28, 0x2C
ITERATIONS, STATIC_SHIFT, NODES = 0x44, 0x54, 0x6C
DMA_LIST, DMA_COUNT, DMA_RECORD = 0xD0, 0xD8, 0xDC
B, U, ROW_BEGIN, COLUMN, VALUE = 0x20000, 0x40000, 0x60000, 0x200000, 0x1000000
START, LOAD_DONE, RUN_LIST = 1, 4, 8
DONE, LOADED, PATTERN_LOADED = 2, 8, 16

SHIFT = 10
LOAD = (300, -200, 100)
TIMEOUT_S = 60.0
TRACE_FILES = {"registers.log", "registers.vcd"}
MEMORY = 0x2_0000_0000


@contextmanager
def board(notification: str, *function: str) -> Iterator[VfioUser]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "board"
        settings = ("method=dma", f"notification={notification}")
        words = [word for s in settings for word in ("--set", f"transfer.{s}")]
        words += [word for s in function for word in ("--set", f"function.{s}")]
        with Served(HVP, [SCENARIO, *words], path), VfioUser(path) as client:
            yield client


def load_one_node(client: VfioUser) -> None:
    """K is 2^SHIFT on its diagonal, so that U is b in the board's words."""
    client.write32(ITERATIONS, 10)
    client.write32(STATIC_SHIFT, SHIFT)
    client.write(NODES, struct.pack("<II", 1, 1))
    client.write(ROW_BEGIN, struct.pack("<II", 0, 1))
    client.write32(COLUMN, 0)
    value = [1 << SHIFT if i % 4 == 0 else 0 for i in range(9)]
    client.write(VALUE, struct.pack("<9hxx", *value))
    client.write32(INTERRUPT_ENABLE, 3)
    client.write32(CONTROL, LOAD_DONE)


def packed(values: tuple[int, ...]) -> bytes:
    return struct.pack("<4h", *values, 0)


class Client(unittest.TestCase):
    def acknowledge(self, client: VfioUser) -> None:
        self.assertTrue(client.wait_interrupt(TIMEOUT_S))
        self.assertEqual(client.read32(STATUS) & 7, DONE)
        client.write32(INTERRUPT_STATUS, 3)

    def expect_load(self, words: bytes) -> None:
        found = struct.unpack("<4h", words)
        for one, other in zip(found, (*LOAD, 0), strict=True):
            self.assertLessEqual(abs(one - other), 1)

    def test_registers_and_blocks(self) -> None:
        with board("msi") as client:
            self.assertEqual(client.version, (0, 1))
            self.assertEqual(client.read32(ID), 0x48565031)
            self.assertEqual(client.read_config(0, 4), 0x48501172)
            words = bytes(range(256)) * 16
            client.write(U, words)
            self.assertEqual(client.read(U, len(words)), words)
            with self.assertRaises(VfioUserError) as refused:
                client.read(client.bar_bytes, 4)
            self.assertEqual(refused.exception.errno, errno.EINVAL)
            self.assertFalse(client.wait_interrupt(0))

    def test_a_solve_by_blocks(self) -> None:
        for notification, *function in (("intx",), ("msi",), ("msi", "msi_x=true")):
            with board(notification, *function) as client:
                self.assertEqual(client.messages, notification == "msi")
                for _ in range(2):
                    load_one_node(client)
                    self.acknowledge(client)
                    client.write(B, packed(LOAD))
                    client.write32(CONTROL, START)
                    self.acknowledge(client)
                    self.expect_load(client.read(U, 8))
                    client.reset()

    def test_a_solve_by_dma(self) -> None:
        with board("msi") as client:
            load_one_node(client)
            self.acknowledge(client)
            memory = client.share(MEMORY, 4096)
            memory[0:8] = packed(LOAD)
            low, high = MEMORY & 0xFFFFFFFF, MEMORY >> 32
            memory[64:128] = struct.pack("<8I", 0, 8, low, high, B, 0, 0, 0) + struct.pack(
                "<8I", 1, 8, low + 32, high, U, 0, 0, 0
            )
            client.write(DMA_LIST, struct.pack("<II", low + 64, high))
            client.write32(DMA_COUNT, 1 | 1 << 16)
            client.write(DMA_RECORD, struct.pack("<II", low + 128, high))
            client.write32(CONTROL, RUN_LIST)
            self.assertTrue(client.wait_interrupt(TIMEOUT_S))
            self.expect_load(memory[32:40])
            job = struct.unpack("<8I", memory[128:160])[7]
            self.assertEqual(job, 1)
            client.unshare(MEMORY)

    def start(self, client: VfioUser) -> None:
        client.write(B, packed(LOAD))
        client.write32(CONTROL, START)

    def test_faults_that_it_asks_for(self) -> None:
        with board("intx") as client:
            load_one_node(client)
            self.acknowledge(client)
            for words, why in (
                ("kind=lost", 'kind=lost: expected "lost-interrupt"'),
                ("", "expected"),
                ("kind=late-dma", "delay"),
                ("kind=lost-interrupt,frame=-2", "frame=-2"),
                ("kind=lost-interrupt," + 300 * "x", "at most 255 characters"),
            ):
                with self.assertRaises(ModelError) as refused:
                    client.inject(words)
                self.assertIn(why, str(refused.exception))
            client.inject("kind=master-abort,access=status,count=2")
            for hit in (True, True, False):
                self.start(client)
                self.assertTrue(client.wait_interrupt(TIMEOUT_S))
                if hit:
                    self.assertEqual(client.read32(STATUS), 0xFFFFFFFF)
                self.assertEqual(client.read32(STATUS), DONE | LOADED | PATTERN_LOADED)
                client.write32(INTERRUPT_STATUS, 3)
            client.inject("kind=lost-interrupt,frame=4")
            self.start(client)
            self.acknowledge(client)
            self.start(client)
            self.assertFalse(client.wait_interrupt(0.5))
            self.assertEqual(client.read32(STATUS) & 7, DONE)

    def test_points_at_which_it_stops(self) -> None:
        seen: list[Stop] = []

        def stopped(stop: Stop) -> None:
            seen.append(stop)
            if stop.value == START:
                client.inject("kind=saturated-solve")

        with board("msi") as client:
            with self.assertRaisesRegex(ModelError, "did you mean CONTROL"):
                client.stop_at("write to CONTRL", stopped)
            client.stop_at("write to CONTROL", stopped)
            client.stop_at("message 2", stopped)
            client.stop_at("job 1", stopped)
            load_one_node(client)
            self.acknowledge(client)
            self.assertEqual([(s.job, s.offset, s.value) for s in seen], [(-1, CONTROL, LOAD_DONE)])
            self.start(client)
            self.assertTrue(client.wait_interrupt(TIMEOUT_S))
            self.assertEqual([(s.job, s.value) for s in seen[1:]], [(0, START), (0, 2)])
            self.assertLess(seen[1].time_ps, seen[2].time_ps)
            self.assertRegex(seen[2].what, r"^message 2 arrives at \d+\.\d{6} us, in job 0$")
            client.write32(INTERRUPT_STATUS, 3)
            client.stop_at("write to CONTROL", None)
            self.start(client)
            self.assertTrue(client.wait_interrupt(TIMEOUT_S))
            self.assertEqual([s.what.split(" at ")[0] for s in seen[3:]], ["job 1 begins"])

    def test_its_accesses_are_traced(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path, out = Path(folder) / "board", Path(folder) / "out"
            with (
                Served(HVP, [SCENARIO, "--trace-registers", "--out", str(out)], path),
                VfioUser(path) as client,
            ):
                client.write32(ITERATIONS, 17)
                self.assertEqual(client.read32(ITERATIONS), 17)
            log = (out / "registers.log").read_text().splitlines()
            written, read = (line.split() for line in log[-2:])
            for words, command in ((written, "write"), (read, "read")):
                self.assertIn(command, words)
                self.assertIn("ITERATIONS", words)
            waveform = (out / "registers.vcd").read_text()
            self.assertIn("$enddefinitions", waveform)
            self.assertEqual({p.name for p in out.iterdir()}, TRACE_FILES)

    def test_a_second_client_is_refused(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "board"
            with Served(HVP, [SCENARIO], path), VfioUser(path):
                with self.assertRaises(VfioUserError) as refused:
                    VfioUser(path)
                self.assertEqual(refused.exception.errno, errno.EBUSY)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
