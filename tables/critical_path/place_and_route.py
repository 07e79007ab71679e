"""Places and routes the small designs for ECP5 and writes what their longest paths take.

    place_and_route.py --yosys yosys --nextpnr nextpnr-ecp5

Runs are one after the other, and those that `measured.csv` has already are left out: to measure
anew, delete it. It has a line a design, speed grade and seed; `versions.txt` the tools. `fit.py`
makes elements of it.
"""

import argparse
import csv
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from designs import Design, all_designs

HERE = Path(__file__).parent
SEEDS = (1, 2, 3)
# The longest of many copies depends less on the seed.
SEEDS_OF_LARGE = (1, 2)
LARGE = 8  # multipliers
# Beyond what any of them reaches, so that the router keeps trying.
TARGET_MHZ = 200
# A faster speed grade is the same silicon: a few designs give the factor.
FAST = ("absolute_value_16", "adder_32", "multiplier_16", "critical_path_8x1", "critical_path_16x1")
# On a larger device too: does it matter what is filled, or how much there is?
ON_LARGER = ("critical_path_16x24",)
MULTIPLIERS = {"25k": 28, "85k": 156}  # ECP5 data sheet; nextpnr counts the same


def execute(command: list[str], folder: Path) -> str:
    """What it prints; raises where it fails."""
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise RuntimeError(f"{command[0]}: {result.stdout[-1000:]}{result.stderr[-1000:]}")
    return result.stdout + result.stderr


def longest(report: dict[str, Any]) -> dict[str, float]:
    """Its delay between two registers, and how much of it is logic and nets."""
    clocked = [
        path
        for path in report["critical_paths"]
        if path["from"].startswith("posedge") and path["to"].startswith("posedge")
    ]
    elements = max((path["path"] for path in clocked), key=lambda p: sum(e["delay"] for e in p))
    routing = sum(e["delay"] for e in elements if e["type"] == "routing")
    return {
        "path_ns": round(sum(e["delay"] for e in elements), 3),
        "logic_ns": round(sum(e["delay"] for e in elements if e["type"] != "routing"), 3),
        "routing_ns": round(routing, 3),
    }


@dataclass(frozen=True)
class Run:
    """One placement."""

    design: Design
    device: str
    grade: int
    seed: int

    @property
    def key(self) -> tuple[str, str, str, str]:
        """As the first columns have it."""
        return (self.design.name, self.device, str(self.grade), str(self.seed))


def wanted_runs(parts: list[str]) -> list[Run]:
    """First all designs with the first seed, so that what is measured is of use early."""
    runs: list[Run] = []
    for seed in SEEDS:
        for design in all_designs():
            if parts and not any(part in design.name for part in parts):
                continue
            if design.multipliers >= LARGE and seed not in SEEDS_OF_LARGE:
                continue
            runs.append(Run(design, "25k", 6, seed))
            if design.name in FAST:
                runs.append(Run(design, "25k", 8, seed))
    larger = [run for run in runs if run.design.name in ON_LARGER and run.seed == SEEDS[0]]
    return runs + [Run(run.design, "85k", run.grade, run.seed) for run in larger]


def measure(run: Run, arguments: argparse.Namespace, folder: Path) -> dict[str, object]:
    """Its row."""
    netlist = folder / f"{run.design.name}.json"
    if not netlist.exists():
        (folder / "design.v").write_text(run.design.verilog())
        script = f"read_verilog design.v; synth_ecp5 -top top -json {netlist.name}"
        execute([arguments.yosys, "-q", "-p", script], folder)
    command = [arguments.nextpnr, f"--{run.device}", "--package", "CABGA381"]
    command += ["--speed", str(run.grade), "--seed", str(run.seed), "--freq", str(TARGET_MHZ)]
    command += ["--json", netlist.name, "--report", "report.json"]
    command += ["--lpf-allow-unconstrained", "--timing-allow-fail", "-q"]
    execute(command, folder)
    return {
        "design": run.design.name,
        "device": run.device,
        "grade": run.grade,
        "seed": run.seed,
        "set": "fit" if run.design.fits else "check",
        **longest(json.loads((folder / "report.json").read_text())),
        "multipliers_used": round(run.design.multipliers / MULTIPLIERS[run.device], 3),
    }


def measured_before(file: Path) -> set[tuple[str, ...]]:
    """Keys of the runs that it has."""
    if not file.exists():
        return set()
    with file.open(newline="") as stream:
        return {tuple(row[:4]) for row in csv.reader(stream)}


def versions(arguments: argparse.Namespace) -> str:
    """Of the tools, a line each."""
    yosys = execute([arguments.yosys, "-V"], HERE).split()
    nextpnr = execute([arguments.nextpnr, "--version"], HERE)
    return f"{yosys[0]} {yosys[1]}\n{nextpnr.split('Version ')[1].split(')')[0]}\n"


def main() -> None:
    """All designs, or those named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--yosys", default="yosys")
    parser.add_argument("--nextpnr", default="nextpnr-ecp5")
    parser.add_argument("--out", type=Path, default=HERE / "measured.csv")
    parser.add_argument("designs", nargs="*", help="parts of names; all without")
    arguments = parser.parse_args()
    before = measured_before(arguments.out)
    with tempfile.TemporaryDirectory() as name, arguments.out.open("a", newline="") as stream:
        for run in wanted_runs(arguments.designs):
            if run.key in before:
                continue
            row = measure(run, arguments, Path(name))
            writer = csv.DictWriter(stream, fieldnames=list(row), lineterminator="\n")
            if stream.tell() == 0:
                writer.writeheader()
            writer.writerow(row)
            stream.flush()
            print(*run.key, row["path_ns"], flush=True)
    (arguments.out.parent / "versions.txt").write_text(versions(arguments))


if __name__ == "__main__":
    main()
