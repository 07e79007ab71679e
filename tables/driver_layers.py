"""The driver's suite at each layer: in a process with the board, over a socket, in a Linux kernel.

Prints docs/driver-layers.md."""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
SCENARIO = str(TOP / "scenarios" / "thesis-static.toml")
LIMIT_S = 300
# All cases went well; one failed; the guest's script says that one did.
_ENDED = (0, 1, 3)
LAYERS = ("in the process", "over a socket", "in Linux")
WAYS = {
    "Blocks and INTA#": (),
    "DMA and MSI": ("transfer.method=dma", "transfer.notification=msi"),
}
# The kinds of docs/faults.md: the suite's name of each, its keys, and what it needs.
_DMA = ("transfer.method=dma",)
_EXPRESS = (
    "bus.pcie.generation=gen3",
    "transfer.method=programmed-io",
    "function.pci_express=true",
)
_KINDS_BY_ACCESS = ("master-abort", "corrupted-word")
FAULTS: dict[str, tuple[str, ...]] = {
    "lost-interrupt": ("frame=5",),
    "stuck-busy": ("frame=5",),
    "saturated-solve": ("frame=5",),
    **{
        f"master-abort-{access}": ("frame=5", f"access={access}")
        for access in ("rhs", "start", "status", "acknowledge", "solution")
    },
    **{
        f"corrupted-word-{access}": ("frame=5", f"access={access}", "bits=1")
        for access in ("rhs", "solution")
    },
    "device-gone": ("frame=1", "frames=2"),
    "surprise-removal": ("frame=5",),
    "function-level-reset": ("frame=5",),
    "aer-correctable": ("frame=5", "access=start"),
    "aer-uncorrectable": ("frame=5", "access=start"),
    "late-dma": ("frame=5", "delay=30 ms"),
    "truncated-dma": ("frame=5", "bytes=8"),
}


_HEAD = """\
# One suite, three layers

`tests/driver/suite/`, the driver's tests in C, on the same board: in the process that it is in
([hvp-board](first-driver.md)), over a socket ([`hvp serve`](vfio-user.md)) and through the device
file of a Linux kernel on simulated time ([`hvp linux`](linux.md)). Made by
`./hvp tables driver-layers > docs/driver-layers.md`; the step `linux` of the tests fails where a
case does. Where a case solves, the words of U are those of the first layer, or the table
says so.
"""


_VERDICTS = """\
## One fault, one verdict

What the record of the faulty frame says: `frames.csv` of `hvp run` and of `hvp linux`, and
`hvp_board_last_job()`. The driver asks for the bus' errors (`hvp.bus_errors=1` in the kernel) and
nobody repeats an access (`host.recovery.retries = 0`). A socket has no timing.
"""


@dataclass(frozen=True)
class Case:
    result: str
    reason: str
    words: str  # a hash of those of U; empty where nothing was solved


Cases = dict[str, Case]


def read_cases(text: str, who: str) -> Cases:
    found = {}
    for line in text.splitlines():
        if line.startswith('{"case"'):
            case = json.loads(line)
            found[case["case"]] = Case(
                case["result"], case.get("reason", ""), str(case.get("u", ""))
            )
    if not found:
        raise SystemExit(f"driver_layers.py: {who}: no case: {text[-400:]}")
    return found


def run(command: Sequence[str], who: str) -> str:
    """What it prints, whatever its status: a case that fails is shown as such."""
    done = subprocess.run(
        command, capture_output=True, text=True, errors="replace", timeout=LIMIT_S, check=False
    )
    if done.returncode not in _ENDED:
        raise SystemExit(f"driver_layers.py: {who}: status {done.returncode}: {done.stderr[-400:]}")
    return done.stdout


@dataclass(frozen=True)
class Layers:
    build: Path

    def _program(self, name: str) -> str:
        return str(self.build / "release" / name)

    def cases(self, layer: str, overrides: Sequence[str], suite: Sequence[str]) -> Cases:
        sets = [word for override in overrides for word in ("--set", override)]
        if layer == LAYERS[0]:
            program = self._program("tests/driver/suite/driver_suite_in_process")
            return read_cases(run([program, SCENARIO, *sets, *suite], layer), layer)
        return (self._over_socket if layer == LAYERS[1] else self._in_linux)(sets, suite)

    def verdicts(self) -> list[str]:
        script = str(TOP / "tests" / "linux" / "fault_verdicts.py")
        command = [sys.executable, "-B", script, self._program("app/hvp")]
        command += [str(self.build / "linux" / "plain")]
        command += [self._program("tests/linux/servo_in_process")]
        return run(command, "fault_verdicts.py").splitlines()

    def _over_socket(self, sets: Sequence[str], suite: Sequence[str]) -> Cases:
        with tempfile.TemporaryDirectory() as folder:
            socket = Path(folder) / "board"
            hvp = self._program("app/hvp")
            command = [hvp, "serve", SCENARIO, *sets, "--quiet", "--vfio-user", str(socket)]
            # Of the socket's coming, not of the line that says so: what scripts wait for.
            with subprocess.Popen(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            ) as serving:
                try:
                    deadline = time.monotonic() + LIMIT_S
                    while not socket.exists() and time.monotonic() < deadline:
                        if serving.poll() is not None:
                            raise SystemExit(f"driver_layers.py: {' '.join(command)} ended")
                        time.sleep(0.01)
                    program = self._program("tests/serve/driver_suite_over_socket")
                    return read_cases(run([program, str(socket), *suite], LAYERS[1]), LAYERS[1])
                finally:
                    serving.terminate()

    def _in_linux(self, sets: Sequence[str], suite: Sequence[str]) -> Cases:
        with tempfile.TemporaryDirectory() as folder:
            said = Path(folder) / "said"
            script = Path(folder) / "script"
            words = " ".join(suite)
            plain = self.build / "linux" / "plain"
            script.write_text(
                f"insmod /host{plain}/registers/hvp_registers.ko || exit 1\n"
                f"hvp-driver-suite /dev/hvp0 --registers /dev/hvp-registers {words} >/host{said}\n"
                "true\n"
            )
            command = [self._program("app/hvp"), "linux", SCENARIO, *sets, "--quiet"]
            command += ["--kernel", str(plain / "linux")]
            command += ["--initrd", str(plain / "initramfs.cpio.gz")]
            command += ["--script", str(script), "--out", str(Path(folder) / "out")]
            if "--fault" in suite:
                command += ["--kernel-argument", "hvp.bus_errors=1"]
            console = run(command, LAYERS[2])
            return read_cases(said.read_text() if said.exists() else console, LAYERS[2])


def cell(case: Case | None, first: Case | None, notes: list[str]) -> str:
    if case is None:
        return "-"
    if case.result == "pass":
        same = first is None or not (case.words and first.words) or case.words == first.words
        return "pass" if same else "**pass, other words of U**"
    if case.reason not in notes:
        notes.append(case.reason)
    number = notes.index(case.reason) + 1
    return f"left out ({number})" if case.result == "skip" else f"**fail** ({number})"


def table(rows: dict[str, list[Case | None]], heading: str, notes: list[str]) -> list[str]:
    lines = [f"| {heading} | {' | '.join(LAYERS)} |", "|---|---|---|---|"]
    for name, cases in rows.items():
        cells = [cell(case, cases[0], notes) for case in cases]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return lines


def page(layers: Layers) -> tuple[list[str], bool]:
    lines = _HEAD.splitlines()
    notes: list[str] = []
    failed = False
    for name, keys in WAYS.items():
        found = [layers.cases(layer, keys, ()) for layer in LAYERS]
        # Those of faults are below, each with its own board.
        names = [c for c in dict.fromkeys(c for cases in found for c in cases) if "fault-" not in c]
        rows = {case: [cases.get(case) for cases in found] for case in names}
        lines += ["", f"## {name}", "", *table(rows, "case", notes)]
        failed = failed or any(c and c.result == "fail" for row in rows.values() for c in row)
    rows = {}
    for fault, keys in FAULTS.items():
        kind = next((k for k in _KINDS_BY_ACCESS if fault.startswith(k)), fault)
        overrides = [f"fault[0].kind={kind}", *(f"fault[0].{key}" for key in keys)]
        overrides += _DMA if fault.endswith("-dma") else ()
        overrides += _EXPRESS if fault.startswith("aer-") else ()
        suite = ("--fault", fault)
        rows[fault] = [
            next(iter(layers.cases(layer, overrides, suite).values())) for layer in LAYERS
        ]
    lines += ["", "## Faults", "", *table(rows, "fault", notes)]
    failed = failed or any(c and c.result == "fail" for row in rows.values() for c in row)
    lines += ["", *_VERDICTS.splitlines(), "", *layers.verdicts()]
    lines += ["", "## Why a case is left out, or fails", ""]
    lines += [f"{number}. {note}" for number, note in enumerate(notes, 1)]
    return lines, failed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path, help="with release/ and linux/plain/")
    lines, failed = page(Layers(parser.parse_args().build.resolve()))
    print("\n".join(lines))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
