"""`hvp linux --gdb`: gdb stops the guest's kernel in the module, and simulated time stands still.

usage: gdb_test.py PROGRAM GUEST

PROGRAM is hvp, GUEST a folder of the variant debug (driver/linux/guest.sh).
"""

import argparse
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from linux_test import LIMIT_S, TOP, Guest, WrongError, expect, expect_in

SCRIPT = "hvp-driver-suite /dev/hvp0 --case solve\n"
RESULTS = ("frames.csv", "summary.json", "trace.json")
HELD_S = 2  # of wall-clock time, where a frame takes less than a millisecond
COMMANDS = (
    "break hvp_start",
    "continue",
    "backtrace 2",
    "print device->nodes",
    "lx-lsmod",
    f"shell sleep {HELD_S}",
    "delete",
    "continue",
)


STOPS = ("continue", "backtrace", "continue")


def results(guest: Guest) -> list[bytes]:
    return [(guest.work / "out" / name).read_bytes() for name in RESULTS]


def with_gdb(guest: Guest, commands: tuple[str, ...] = COMMANDS, *words: str) -> tuple[str, str]:
    """What gdb and the run say, where gdb stops it, looks at it and lets it go on."""
    with subprocess.Popen(
        guest.command("--gdb", "--quiet", *words, script=SCRIPT), stdout=subprocess.PIPE, text=True
    ) as run:
        try:
            assert run.stdout is not None
            said = run.stdout.readline()
            found = re.search(r"gdb -p \d+ -x .+", said)
            if not found:
                raise WrongError(f"no word of a debugger: {said!r}")
            gdb = [*shlex.split(found.group()), "-batch", "-nx"]
            for command in commands:
                gdb += ["-ex", command]
            done = subprocess.run(gdb, capture_output=True, text=True, timeout=LIMIT_S, check=False)
            told, _ = run.communicate(timeout=LIMIT_S)
        finally:
            run.kill()
    if run.returncode != 0:
        raise WrongError(f"status {run.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout, told


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("guest", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        guest = Guest(arguments.program.resolve(), arguments.guest.resolve(), Path(), Path(work), 0)
        guest.run(script=SCRIPT)
        undisturbed = results(guest)
        said, _ = with_gdb(guest)
        stopped = re.search(r"^Breakpoint 1.*, hvp_start .* at .*/hvp_job\.c:(\d+)$", said, re.M)
        if not stopped:
            raise WrongError(f"gdb did not stop in the driver:\n{said}")
        line = (TOP / "driver" / "hvp_job.c").read_text().splitlines()[int(stopped.group(1)) - 1]
        expect_in("gdb, the line", line.strip(), said)
        expect_in("gdb, the caller", "driver/linux/hvp_job_calls.c:", said)
        expect_in("gdb, a member of the driver's", "$1 = 12", said)
        expect_in("gdb, the kernel's own commands", "hvp", said[said.index("Module") :])
        for name, before, now in zip(RESULTS, undisturbed, results(guest), strict=True):
            expect(f"{name} is that of a run without a debugger", True, before == now)
        said, told = with_gdb(guest, STOPS, "--stop-at", "job 0")
        expect_in("gdb, the stop", "received signal SIGINT", said)
        expect_in("gdb, the driver", "hvp_start", said)
        expect_in("the run, the stop", "stopped: job 0 begins at ", told)
        for name, before, now in zip(RESULTS, undisturbed, results(guest), strict=True):
            expect(f"{name} is that of a run that was not stopped", True, before == now)
    print("ok      the kernel stands still under gdb")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (WrongError, subprocess.SubprocessError) as error:
        print(f"FAILED  {error}")
        sys.exit(1)
