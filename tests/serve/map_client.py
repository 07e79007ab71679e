"""A client that knows nothing of the board but the tables of docs/registers.md.

map_client.py HVP SCENARIO

It brings a matrix, solves, and finds U right by the matrix itself; it finds every reset value that
the page gives, and each word length below the page's minimum refused, with the register and the
field named.
"""

from __future__ import annotations

import re
import runpy
import struct
import sys
import tempfile
import unittest
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from served import Served

TOP = Path(__file__).parents[2]
# As a file of its own: the package around it wants more than the standard library.
CLIENT = TOP / "driver/python/hvp_board/vfio_user.py"
if TYPE_CHECKING:
    from hvp_board.vfio_user import VfioUser
else:
    VfioUser = runpy.run_path(str(CLIENT))["VfioUser"]

HVP, SCENARIO = Path(sys.argv[1]), sys.argv[2]
NODES = 5
SHIFT = 11
# What each board has of its own, as the page says.
OWN = ("CAPABILITY_CLOCK", "CAPABILITY_DMA")


@dataclass(frozen=True)
class Field:
    low: int
    bits: int
    access: str
    meaning: str

    def put(self, value: int) -> int:
        return value << self.low

    def of(self, word: int) -> int:
        return word >> self.low & (1 << self.bits) - 1


@dataclass
class Map:
    offset: dict[str, int] = field(default_factory=dict)
    reset: dict[str, int] = field(default_factory=dict)
    fields: dict[str, dict[str, Field]] = field(default_factory=dict)
    codes: dict[str, dict[str, int]] = field(default_factory=dict)


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|\n").split("|")]


def read_map(page: Path) -> Map:
    found = Map()
    heading = ""
    for line in page.read_text().splitlines():
        if line.startswith("#"):
            heading = line.strip("# ")
        if not line.startswith("|") or line.startswith("|---"):
            continue
        row = cells(line)
        name = re.match(r"\[(\w+)\]", row[1]) if len(row) > 1 else None
        if heading == "Overview" and name and row[0].startswith("0x"):
            found.offset[name[1]] = int(row[0], 16)
            if "#memories" not in row[1]:
                found.reset[name[1]] = int(row[3], 16)
        elif re.fullmatch(r"\d+(:\d+)?", row[0]) and heading in found.offset:
            high, _, low = row[0].partition(":")
            lowest = int(low or high)
            bits = int(high) - lowest + 1
            found.fields.setdefault(heading, {})[row[1]] = Field(lowest, bits, row[2], row[4])
        elif row[0].isdecimal() and heading not in found.offset:
            found.codes.setdefault(heading, {})[row[1]] = int(row[0])
    return found


MAP = read_map(TOP / "docs/registers.md")


def matrix() -> dict[tuple[int, int], list[int]]:
    """A chain of nodes by block, in words of 12 bits, symmetric and diagonally dominant."""
    blocks = {}
    for row in range(NODES):
        for column in (row - 1, row, row + 1):
            if 0 <= column < NODES:
                on, off = (1700 + 11 * row, 60) if row == column else (-350, 20)
                blocks[row, column] = [on if i % 4 == 0 else off for i in range(9)]
    return blocks


def words(elements: list[int]) -> bytes:
    """Two elements of at most 16 bits in a word."""
    even = elements + [0] * (len(elements) % 2)
    return struct.pack(f"<{len(even)}h", *even)


class TheMapAlone(unittest.TestCase):
    def setUp(self) -> None:
        folder = self.enterContext(tempfile.TemporaryDirectory())
        path = Path(folder) / "board"
        self.enterContext(Served(HVP, [SCENARIO], path))
        self.board = self.enterContext(VfioUser(path))

    def get(self, register: str, name: str) -> int:
        word = self.board.read32(MAP.offset[register])
        return MAP.fields[register][name].of(word)

    def set(self, register: str, **values: int) -> None:
        word = MAP.reset[register]
        for name, value in values.items():
            place = MAP.fields[register][name]
            word = word & ~place.put((1 << place.bits) - 1) | place.put(value)
        self.board.write32(MAP.offset[register], word)

    def command(self, name: str) -> None:
        self.board.write32(MAP.offset["CONTROL"], MAP.fields["CONTROL"][name].put(1))

    def load(self) -> None:
        blocks = matrix()
        begins = [sum(row < n for row, _ in blocks) for n in range(NODES + 1)]
        columns = [column for _, column in blocks]
        values = [value for block in blocks.values() for value in block]
        self.set("NODES", count=NODES)
        self.set("BLOCKS", count=len(blocks))
        self.board.write(MAP.offset["ROW_BEGIN"], struct.pack(f"<{len(begins)}I", *begins))
        self.board.write(MAP.offset["COLUMN"], struct.pack(f"<{len(columns)}I", *columns))
        self.board.write(MAP.offset["VALUE"], words(values))
        self.command("load_done")
        self.wait()
        self.assertEqual(1, self.get("STATUS", "matrix_loaded"))

    def wait(self) -> None:
        while self.get("STATUS", "busy"):
            pass
        self.assertEqual(0, self.get("STATUS", "error"), hex(self.get("ERROR", "code")))
        self.board.write32(MAP.offset["INTERRUPT_STATUS"], 1)

    def test_the_page_has_what_the_board_reads(self) -> None:
        self.assertGreater(len(MAP.reset), 40)
        for register, reset in MAP.reset.items():
            readable = any("read" in f.access for f in MAP.fields[register].values())
            if readable and register not in OWN:
                with self.subTest(register):
                    self.assertEqual(hex(reset), hex(self.board.read32(MAP.offset[register])))

    def test_it_solves(self) -> None:
        self.set("METHOD", method=MAP.codes["solver_method"]["cg"])
        self.set("ITERATIONS", count=30)
        self.set("STATIC_SHIFT", shift=SHIFT)
        self.set("FORMAT", matrix_bits=12, vector_bits=16, rhs_bits=16, coefficient_bits=16)
        self.set("START_MODE", mode=MAP.codes["start_mode"]["zero"])
        self.load()
        b = [1000 * (i % 3) - 700 * (i % 2) + 40 * i for i in range(3 * NODES)]
        self.board.write(MAP.offset["B"], words(b))
        self.command("start")
        self.wait()
        raw = self.board.read(MAP.offset["U"], 4 * ((3 * NODES + 1) // 2))
        u = struct.unpack(f"<{len(raw) // 2}h", raw)[: 3 * NODES]
        product = [0] * (3 * NODES)
        for (row, column), block in matrix().items():
            for i, value in enumerate(block):
                product[3 * row + i // 3] += value * u[3 * column + i % 3]
        self.assertGreater(max(map(abs, u)), 100)
        off = max(abs(wanted - got / 2**SHIFT) for wanted, got in zip(b, product, strict=True))
        self.assertLess(off, 4)

    def test_a_refusal_names_the_field(self) -> None:
        self.load()
        low = {
            name: int(found[1])
            for name, place in MAP.fields["FORMAT"].items()
            if (found := re.search(r"From (\d+) to", place.meaning))
        }
        self.assertEqual(3, len(low))
        for name, least in low.items():
            with self.subTest(name):
                self.set("FORMAT", **{name: least - 1})
                self.command("load_done")
                self.assertEqual(MAP.codes["error_code"]["bad_setting"], self.get("ERROR", "code"))
                self.assertEqual(MAP.offset["FORMAT"], self.get("ERROR_DETAIL", "detail"))
                self.assertEqual(MAP.fields["FORMAT"][name].low, self.get("ERROR", "place"))
                self.board.write32(MAP.offset["INTERRUPT_STATUS"], 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
