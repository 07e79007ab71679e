"""The same fault at each layer: what the record of the job says of it.

usage: fault_verdicts.py PROGRAM GUEST SERVO

Prints a table of Markdown: `hvp run`, the board in a program's process, `hvp linux`. The driver is
told of the bus' errors, and nobody repeats an access, at all three. Fails where two layers differ.
"""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from frames_file import write_frames

TOP = Path(__file__).resolve().parents[2]
LIMIT_S = 240
FRAME = 2
FRAMES = 5
# What a fault of 20 ms is late by does not hang on the period.
PERIOD_US = 2000.0

_ACCESSES = ("rhs", "start", "status", "acknowledge", "solution")
_DMA = ('transfer.method = "dma"', 'transfer.notification = "msi"')
_EXPRESS = (
    'bus.pcie.generation = "gen3"',
    'transfer.method = "programmed-io"',
    "function.pci_express = true",
)
# Kind, keys of the fault, keys of the scenario.
FAULTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "lost-interrupt": ((), ()),
    "stuck-busy": ((), ()),
    **{f"master-abort on {a}": ((f'access = "{a}"',), ()) for a in _ACCESSES},
    **{
        f"corrupted-word in {a}": ((f'access = "{a}"', "bits = 1"), ()) for a in ("rhs", "solution")
    },
    "device-gone": (("frames = 0",), ()),
    "surprise-removal": ((), ()),
    "surprise-removal on acknowledge": (('access = "acknowledge"',), ()),
    "function-level-reset": ((), ()),
    "lost-interrupt, DMA and MSI": ((), _DMA),
    "stuck-busy, DMA and MSI": ((), _DMA),
    "master-abort on start, DMA and MSI": (('access = "start"',), _DMA),
    "surprise-removal, DMA and MSI": ((), _DMA),
    "function-level-reset, DMA and MSI": ((), _DMA),
    "aer-correctable": ((), _EXPRESS),
    **{f"aer-uncorrectable on {a}": ((f'access = "{a}"',), _EXPRESS) for a in ("rhs", "start")},
    "late-dma by 3 ms": (('delay = "3 ms"',), _DMA),
    "late-dma by 30 ms": (('delay = "30 ms"',), _DMA),
    "truncated-dma": (("bytes = 8",), _DMA),
}


class WrongError(Exception):
    pass


@dataclass(frozen=True)
class Verdict:
    status: str
    late: bool

    def __str__(self) -> str:
        words = "in time" if self.status == "HVP_OK" else f"`{self.status}`"
        if not self.late:
            return words
        return "late" if self.status == "HVP_OK" else f"{words}, late"


def scenario(fault: str, folder: Path) -> Path:
    keys, ways = FAULTS[fault]
    kind = re.split("[, ]", fault, maxsplit=1)[0]
    lines = [f'base = "{TOP}/scenarios/thesis-static.toml"', 'title = "One fault"']
    lines += [*ways, 'host.timeout = "20 ms"', "host.recovery.retries = 0"]
    lines += ['host.recovery.hold_saturated = "never"', "output.pictures = false"]
    lines += [f"frames = {4 * FRAMES}", "[[fault]]", f'kind = "{kind}"', f"frame = {FRAME}", *keys]
    path = folder / "fault.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def run(command: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command, capture_output=True, text=True, errors="replace", timeout=LIMIT_S, check=False
    )


def of_csv(done: subprocess.CompletedProcess[str], path: Path) -> Verdict:
    if not path.exists():
        raise WrongError(f"status {done.returncode}: {done.stdout[-300:]} {done.stderr[-300:]}")
    with path.open() as file:
        for row in csv.DictReader(file):
            if int(row["frame"]) == FRAME:
                return Verdict(row["status"], float(row["latency_us"]) > PERIOD_US)
    raise WrongError(f"{path}: no frame {FRAME}")


def of_run(program: Path, path: Path, folder: Path) -> Verdict:
    out = folder / "run"
    done = run([str(program), "run", str(path), "--quiet", "--out", str(out)])
    return of_csv(done, out / "frames.csv")


def in_process(servo: Path, path: Path, folder: Path) -> Verdict:
    done = run([str(servo), str(path), str(folder / "frames"), str(folder / "u"), "--records"])
    for line in done.stdout.splitlines():
        number, status, time_ns = line.split()
        if int(number) == FRAME:
            return Verdict(status, int(time_ns) > 1000 * PERIOD_US)
    raise WrongError(f"{servo}: no job {FRAME}: {done.stderr[-300:]}")


def in_linux(program: Path, guest: Path, path: Path, folder: Path) -> Verdict:
    script = folder / "script"
    # What becomes of the program is in the record.
    script.write_text(
        f"hvp-servo /dev/hvp0 /host{folder}/frames /host{folder}/u --timeout-ms 20; true\n"
    )
    command = [str(program), "linux", str(path), "--quiet", "--out", str(folder / "linux")]
    command += ["--kernel", str(guest / "linux"), "--initrd", str(guest / "initramfs.cpio.gz")]
    command += ["--kernel-argument", "hvp.bus_errors=1", "--script", str(script)]
    return of_csv(run(command), folder / "linux" / "frames.csv")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("guest", type=Path)
    parser.add_argument("servo", type=Path)
    arguments = parser.parse_args()
    program, servo = arguments.program.resolve(), arguments.servo.resolve()
    differ = []
    print("| fault | `hvp run` | in the process | in Linux |\n|---|---|---|---|")
    for fault in FAULTS:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            write_frames(folder / "frames", FRAMES)
            path = scenario(fault, folder)
            row = [
                of_run(program, path, folder),
                in_process(servo, path, folder),
                in_linux(program, arguments.guest.resolve(), path, folder),
            ]
        print(f"| {fault} | {' | '.join(map(str, row))} |", flush=True)
        if len(set(row)) > 1:
            differ.append(fault)
    if differ:
        print(f"fault_verdicts.py: the layers differ: {', '.join(differ)}", file=sys.stderr)
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
