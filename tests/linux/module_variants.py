"""The module with a change, in a guest: what only shows where time passes in the wrong place, what
an error of the link leaves behind, and what is said of a guest that hangs.

usage: module_variants.py PROGRAM GUEST WORK

PROGRAM is hvp, GUEST a folder with `linux`, `initramfs.cpio.gz` and `tree`, WORK where modules are
built.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

TOP = Path(__file__).resolve().parents[2]
LIMIT_S = 240
SCENARIO = str(TOP / "scenarios" / "pcie-msi.toml")


class WrongError(Exception):
    pass


@dataclass(frozen=True)
class Change:
    """Of a source in driver/linux: a line, and what stands in its place."""

    file: str
    old: str
    new: str


# The thread sleeps behind the doorbell, as one that is preempted there: the job ends meanwhile.
SLOW_START = (
    Change(
        "hvp_job_calls.c",
        "\tstatus = hvp_start(&board->device);\n",
        "\tstatus = hvp_start(&board->device);\n\tusleep_range(5000, 5010);\n",
    ),
    Change(
        "hvp_job_calls.c",
        "#include <linux/uaccess.h>\n",
        "#include <linux/delay.h>\n#include <linux/uaccess.h>\n",
    ),
)
# The processor goes on for ever behind the doorbell, and takes no interrupt.
SPIN = (
    Change(
        "hvp_job_calls.c",
        "\tstatus = hvp_start(&board->device);\n",
        "\tstatus = hvp_start(&board->device);\n"
        "\tlocal_irq_disable();\n\tfor (;;)\n\t\tbarrier();\n",
    ),
)
# A wait for an interrupt has no end but that.
WAIT = (
    Change(
        "hvp_bar.c",
        "ns_to_ktime(min_t(u64, timeout_ns, KTIME_MAX));",
        "timeout_ns ? KTIME_MAX : 0;",
    ),
)
LOST = ("fault[0].kind=lost-interrupt", "fault[0].frame=2")


@dataclass(frozen=True)
class Ran:
    """What `hvp linux` said, and the tables of its summary."""

    said: str
    summary: dict[str, Any]


@dataclass(frozen=True)
class Guest:
    program: Path
    folder: Path
    work: Path

    def build(
        self, name: str, changes: tuple[Change, ...] = (), room: str = "driver/linux"
    ) -> Path:
        """The module's file."""
        folder = self.work / name
        with tempfile.TemporaryDirectory() as copied:
            top = Path(copied)
            for part in ("driver", "cmake", "tests/driver/linux"):
                (top / part).parent.mkdir(parents=True, exist_ok=True)
                subprocess.run(["cp", "-rp", str(TOP / part), str(top / part)], check=True)
            for change in changes:
                path = top / "driver" / "linux" / change.file
                text = path.read_text()
                if text.count(change.old) != 1:
                    raise WrongError(f"{name}: not once in {change.file}: {change.old!r}")
                path.write_text(text.replace(change.old, change.new))
            command = [str(top / "driver/linux/build.sh"), str(self.folder / "tree"), str(folder)]
            done = subprocess.run(
                [*command, str(top / room)], capture_output=True, text=True, check=False
            )
        if done.returncode != 0:
            raise WrongError(f"{name}: {done.stderr[-600:]}")
        return next(folder.glob("*.ko"))

    def run(self, script: str, *words: str, statuses: tuple[int, ...] = (0, 1)) -> Ran:
        """A job that was late, or failed on purpose, is no fault of the script's."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "script").write_text("set -e\n" + script)
            command = [str(self.program), "linux", SCENARIO, "--out", str(folder / "out")]
            command += ["--kernel", str(self.folder / "linux")]
            command += ["--initrd", str(self.folder / "initramfs.cpio.gz")]
            command += ["--script", str(folder / "script"), *words]
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=LIMIT_S, check=False
            )
            if done.returncode not in statuses:
                raise WrongError(f"status {done.returncode}\n{done.stdout[-1500:]}\n{done.stderr}")
            summary = json.loads((folder / "out" / "summary.json").read_text())
        return Ran(done.stdout + done.stderr, summary)


def who_polls_hears_of_a_job_that_another_starts(guest: Guest) -> None:
    module = guest.build("slow-start", SLOW_START)
    guest.run(
        f"rmmod hvp\ninsmod /host{module}\n"
        "hvp-driver-suite /dev/hvp0 --case wait-poll-from-before | grep '\"pass\"'\n"
    )


def a_link_that_was_reset_is_recovered_from(guest: Guest) -> None:
    module = guest.build("recovery", room="tests/driver/linux/recovery")
    solves = "hvp-driver-suite /dev/hvp0 --case solve | grep '\"pass\"'\n"
    guest.run(
        f"{solves}insmod /host{module}\n{solves}rmmod hvp_recovery\ninsmod /host{module}\n{solves}"
    )


def nothing_of_the_last_program_is_left(guest: Guest) -> None:
    guest.run("hvp-driver-suite /dev/hvp0 --case dma-next-program | grep '\"pass\"'\n")


def says(guest: Guest, module: Path, parts: tuple[str, ...], *words: str) -> None:
    script = f"rmmod hvp\ninsmod /host{module}\nhvp-driver-suite /dev/hvp0 --case fifty-jobs\n"
    said = guest.run(script, "--patience", "3", *words, statuses=(3,)).said
    for part in parts:
        if part not in said:
            raise WrongError(f"expected {part!r} in {said[-2500:]}")


def a_processor_that_spins_is_seen(guest: Guest) -> None:
    parts = (
        "its processor is in a module < vfs_ioctl",
        "its last job, number 1 of the run, was asked for at ",
        "write DMA_LIST_LOW",
        # Simulated time does not go on.
        "write CONTROL 0x00000008, under way\n",
    )
    says(guest, guest.build("spin", SPIN), parts)


def a_wait_without_an_end_is_seen(guest: Guest) -> None:
    parts = (
        "time_travel_",
        "the board: done; its last job, number 3 of the run, was asked for at ",
    )
    faults = [word for setting in LOST for word in ("--set", setting)]
    says(guest, guest.build("wait", WAIT), parts, *faults)


CASES: tuple[Callable[[Guest], None], ...] = (
    who_polls_hears_of_a_job_that_another_starts,
    a_link_that_was_reset_is_recovered_from,
    nothing_of_the_last_program_is_left,
    a_processor_that_spins_is_seen,
    a_wait_without_an_end_is_seen,
)


def cases_parser(description: str | None) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", type=Path)
    parser.add_argument("guest", type=Path)
    parser.add_argument("work", type=Path)
    parser.add_argument("--case", help="one alone")
    parser.add_argument("--share", type=int, default=0, help="which of the parts")
    parser.add_argument("--of", type=int, default=1, help="parts of what there are many of")
    return parser


Item = TypeVar("Item")


def share_of(arguments: argparse.Namespace, many: tuple[Item, ...]) -> tuple[Item, ...]:
    return many[arguments.share % arguments.of :: arguments.of]


def guest_of(arguments: argparse.Namespace) -> Guest:
    return Guest(arguments.program.resolve(), arguments.guest.resolve(), arguments.work.resolve())


def run_named(arguments: argparse.Namespace, tests: Mapping[str, Callable[[], None]]) -> int:
    failed = 0
    for name, test in tests.items():
        if arguments.case not in (None, name):
            continue
        try:
            test()
            print(f"ok      {name}", flush=True)
        except (WrongError, subprocess.SubprocessError, OSError) as error:
            failed += 1
            print(f"FAILED  {name}: {error}", flush=True)
    return 1 if failed else 0


def run_cases(arguments: argparse.Namespace, cases: tuple[Callable[[Guest], None], ...]) -> int:
    guest = guest_of(arguments)
    return run_named(arguments, {case.__name__: partial(case, guest) for case in cases})


if __name__ == "__main__":
    sys.exit(run_cases(cases_parser(__doc__).parse_args(), CASES))
