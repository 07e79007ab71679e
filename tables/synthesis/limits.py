"""What the engine's sources may not do to a synthesis: docs/rtl.md, "For a synthesis".

    limits.py

Synthesises a partition of the thesis' engine, and all of the engine as far as its memories; fails
where a partition has more than it may, where a memory becomes registers, and where anything divides
by other than a power of two or is a latch. Says which blocks measured.csv has of other sources.
"""

import json
import re
import sys
import tempfile
from pathlib import Path

from engines import BLOCKS, ENGINES, WHOLE, Engine
from measure import HERE, rows_of
from yosys_runs import file_of, fingerprint, forbidden, read_engine, synthesise, yosys

# Of a partition. Its carry chains are not among the look-up tables.
MOST_LUTS = 1500
MOST_REGISTERS = 5000


def memories_of_registers(folder: Path) -> list[str]:
    """Memories of the whole engine for which there is no block and no look-up table. A row of
    registers is no memory: its addresses are constants."""
    log = yosys(
        [
            f"read_rtlil {file_of(WHOLE)}.il",
            "hierarchy -top block",
            "flatten",
            "synth_ecp5 -top block -run begin:map_ram",
            "select block",
            "write_json -selected memories.json",
            "select -clear",
            "synth_ecp5 -top block -run map_ram:map_ffram",
        ],
        folder,
    )
    cells = json.loads((folder / "memories.json").read_text())["modules"]["block"]["cells"]
    memories = {
        cell["parameters"]["MEMID"].lstrip("\\")
        for cell in cells.values()
        if cell["type"] == "$mem_v2"
        and any(isinstance(bit, int) for bit in cell["connections"]["RD_ADDR"])
    }
    if not memories:
        raise RuntimeError("yosys finds no memory in the engine")
    found = re.findall(r"using FF mapping for memory block\.(\S+)", log)
    return sorted(memories.intersection(found))


def stale(engine: Engine, folder: Path) -> list[str]:
    """Blocks of which measured.csv has others."""
    known = rows_of(HERE / "measured.csv")
    blocks = (*BLOCKS, WHOLE)
    return [
        block.name
        for block in blocks
        if known.get((engine.name, block.name), {}).get("sources") != fingerprint(block, folder)
    ]


def main() -> int:
    """A line a mistake; 1 where there is one."""
    mistakes: list[str] = []
    engine = ENGINES[0]
    partition = BLOCKS[0]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        read_engine(engine, folder)
        mistakes += [f"no hardware for it: {cell}" for cell in forbidden(folder)]
        mistakes += [f"becomes registers: {memory}" for memory in memories_of_registers(folder)]
        cells = synthesise(partition, folder)
        for what, has, most in (
            ("look-up tables", cells.luts, MOST_LUTS),
            ("registers", cells.registers, MOST_REGISTERS),
        ):
            print(f"a partition of the {engine.name} engine: {has} {what} of {most}")
            if has > most:
                mistakes.append(f"a partition has {has} {what}: expected at most {most}")
        others = stale(engine, folder)
    if others:
        print(
            f"left out: tables/synthesis/measured.csv is not of these sources: {engine.name}:"
            f" {', '.join(others)}: measure.py renews it"
        )
    for mistake in mistakes:
        print(mistake)
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
