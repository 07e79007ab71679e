"""The module under stress: threads that ask everything at once, on a board with faults that is
taken away, reset and put to sleep meanwhile (tests/linux/stress).

usage: stress_test.py PROGRAM GUEST [--seed N]… [--seeds FIRST LAST] [--seconds N] [--board NAME]

PROGRAM is hvp, GUEST a folder with `linux` and an `initramfs.cpio.gz` that has hvp-stress. A seed
draws what is asked and when, the faults among it, and which board it is asked of. Without one the
seeds run that have found something.
"""

import argparse
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
SCRIPT = TOP / "tests" / "linux" / "stress" / "stress.sh"
# Wall-clock, for a simulated second in the slowest kernel, and for what is not the stress.
LIMIT_S, LIMIT_PER_SECOND_S = 300, 30
COMPLAINTS = re.compile(
    r"KASAN|KCSAN|WARNING|BUG|INFO: |DMA-API|possible circular|blocked for more than"
    r"|unreferenced object"
)


class WrongError(Exception):
    pass


@dataclass(frozen=True)
class Board:
    scenario: str
    settings: tuple[str, ...]
    faults: tuple[str, ...]  # "kind, key=value, …"
    arguments: tuple[str, ...] = ()  # of the kernel
    words: tuple[str, ...] = ()  # of hvp-stress

    def options(self) -> list[str]:
        settings = list(self.settings)
        for number, fault in enumerate(self.faults):
            kind, *keys = fault.split(", ")
            settings += [f"fault[{number}].{key}" for key in (f"kind={kind}", *keys)]
        options = [str(TOP / "scenarios" / self.scenario)]
        for setting in settings:
            options += ["--set", setting]
        for argument in self.arguments:
            options += ["--kernel-argument", argument]
        return options


OFTEN = "rate=0.02"
# Whatever the way to the board. On PCI the driver asks the bus; a lost b is noticed by nobody else.
_ANY = (f"lost-interrupt, {OFTEN}", f"stuck-busy, {OFTEN}", f"saturated-solve, {OFTEN}")
_DMA = (f"truncated-dma, {OFTEN}, bytes=8", f"late-dma, {OFTEN}, delay=30 ms")
_START = f"master-abort, {OFTEN}, access=start"
_READS = (f"master-abort, {OFTEN}, access=status", f"master-abort, {OFTEN}, access=acknowledge")
BOARDS = {
    "messages": Board("pcie-msi.toml", (), (*_ANY, *_DMA, _START)),
    "line": Board(
        "pcie-msi.toml", ("transfer.notification=intx",), (*_ANY, *_DMA, _START, *_READS)
    ),
    "gone": Board(
        "pcie-msi.toml",
        (),
        ("device-gone, rate=0.004, frames=20", f"lost-interrupt, {OFTEN}"),
        words=("--loses-power",),
    ),
    "bursts": Board(
        "thesis-static.toml",
        ("transfer.method=bursts",),
        (*_ANY, _START, *_READS, f"corrupted-word, {OFTEN}, access=rhs, bits=1"),
        arguments=("hvp.bus_errors=1",),
    ),
    "polled": Board(
        "pcie-msi.toml", ("transfer.notification=polling",), (*_ANY[1:], *_DMA, _START)
    ),
}
# Within four seconds each: a call that had not begun ended with EINTR after a suspend, and poll()
# slept on where a suspend had lost the job.
FOUND = (1, 4)


def board_of(seed: int) -> str:
    return list(BOARDS)[max(0, seed - 9) % len(BOARDS)]


def stress(program: Path, guest: Path, seed: int, name: str, seconds: int) -> str:
    """The console."""
    board = BOARDS[name]
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        words = " ".join([str(seed), str(seconds), *board.words])
        (work / "script").write_text(f"sh /host{SCRIPT} {words}\n")
        command = [str(program), "linux", *board.options(), "--quiet", "--out", str(work / "out")]
        command += ["--kernel", str(guest / "linux"), "--memory", "256M"]
        command += ["--initrd", str(guest / "initramfs.cpio.gz"), "--script", str(work / "script")]
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=LIMIT_S + seconds * LIMIT_PER_SECOND_S,
            check=False,
        )
        console = work / "out" / "console.log"
        said = console.read_text(errors="replace") if console.exists() else ""
    # A frame that was late, or whose job failed, is what is wanted.
    if done.returncode not in (0, 1):
        why = "\n".join(re.findall(r"^FAILED: .*$", said, re.MULTILINE)) or said[-6000:]
        raise WrongError(f"{why}\n{done.stderr}")
    # From the module's coming on: what 6.1 says of itself before is its own.
    module = said[said.find("hvp: loading") :]
    if found := COMPLAINTS.search(module):
        raise WrongError(f"the kernel says {found[0]}\n{module[found.start() :][:4000]}")
    if not re.search(r"stress: solve +HVP_OK", said):
        raise WrongError(f"nothing was solved\n{said[-3000:]}")
    return said


def outcomes(console: str) -> list[str]:
    return re.findall(r"^(?:stress: \S+ .*[0-9]|upheaval: .*)$", console, re.MULTILINE)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("guest", type=Path)
    parser.add_argument("--seed", type=int, action="append", default=[])
    parser.add_argument("--seeds", type=int, nargs=2, metavar=("FIRST", "LAST"))
    parser.add_argument("--seconds", type=int, default=60, help="of simulated time, of each")
    parser.add_argument("--board", choices=list(BOARDS), help="of all seeds")
    parser.add_argument("--twice", action="store_true", help="each has to repeat itself")
    arguments = parser.parse_args()
    seeds = [*arguments.seed]
    if arguments.seeds:
        seeds += range(arguments.seeds[0], arguments.seeds[1] + 1)
    failed = 0
    for seed in seeds or FOUND:
        name = arguments.board or board_of(seed)
        began = time.monotonic()
        run = (arguments.program.resolve(), arguments.guest.resolve(), seed, name)
        try:
            said = outcomes(stress(*run, arguments.seconds))
            if arguments.twice and outcomes(stress(*run, arguments.seconds)) != said:
                raise WrongError("the second run is another")
            calls = sum(int(line.split()[-1]) for line in said if not line.startswith("upheaval"))
            text = f"{calls} calls; {said[-1]}; {time.monotonic() - began:.0f} s"
            print(f"ok      seed {seed}, {name}: {text}", flush=True)
        except (WrongError, subprocess.SubprocessError, OSError) as error:
            failed += 1
            print(f"FAILED  seed {seed}, {name}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
