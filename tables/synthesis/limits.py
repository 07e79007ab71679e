"""What the engine's sources may not do to a synthesis: docs/rtl.md, "For a synthesis".

    limits.py PASSED

Synthesises a partition of the thesis' engine, and all of the engine with a preconditioner as far
as its memories; fails where a partition has more than it may, where a memory becomes registers, and
where anything divides by other than a power of two or is a latch. Says which blocks measured.csv
has of other sources. The folder PASSED has a file for what has passed with nothing to say.
"""

import argparse
import hashlib
import json
import re
import sys
import tempfile
from pathlib import Path

from engines import BLOCKS, ENGINES, HERE, WHOLE, Engine, blocks_of
from measure import rows_of
from nextpnr_runs import OPTIONS
from yosys_runs import (
    BLOCK_RAM,
    SOURCES,
    file_of,
    fingerprint,
    forbidden,
    read_engine,
    synthesise,
    tools,
    yosys,
)

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
    return [
        block.name
        for block in blocks_of(engine)
        if known.get((engine.name, block.name), {}).get("sources")
        != fingerprint(block, folder, OPTIONS if block.is_placed(engine) else ())
    ]


def everything() -> str:
    """A fingerprint of all that the answer depends on."""
    files = [*SOURCES.glob("*.sv"), BLOCK_RAM, *HERE.glob("*.py"), *HERE.glob("*.csv")]
    whole = hashlib.sha256(tools().encode())
    for file in sorted(files):
        whole.update(f"{file.name}\n".encode() + file.read_bytes())
    return whole.hexdigest()[:16]


def mistakes_of_memories(engine: Engine) -> list[str]:
    """Of the whole engine: what has no hardware, and memories that have none."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        read_engine(engine, folder)
        mistakes = [f"no hardware for it: {cell}" for cell in forbidden(folder)]
        return mistakes + [
            f"becomes registers: {memory}" for memory in memories_of_registers(folder)
        ]


def main() -> int:
    """A line a mistake; 1 where there is one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("passed", type=Path)
    passed = parser.parse_args().passed / everything()
    if passed.exists():
        print("these sources have passed before")
        return 0
    engine = ENGINES[0]
    partition = BLOCKS[0]
    complete = max(ENGINES, key=lambda each: (each.parameters["Preconditioner"], each.calibrates))
    mistakes = mistakes_of_memories(complete)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        read_engine(engine, folder)
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
            f" {', '.join(others)}: ./hvp tables synthesis renews it"
        )
    for mistake in mistakes:
        print(mistake)
    if not mistakes and not others:
        passed.parent.mkdir(parents=True, exist_ok=True)
        passed.touch()
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
