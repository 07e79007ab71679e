"""A study as a process of its own, to be interrupted, killed and run into walls."""

import os
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from studies.program import Program

TOP = Path(__file__).resolve().parents[2]
PATIENCE_S = 60.0


def counting(program: Program, folder: Path, then: str = "") -> Program:
    """The program behind one that writes a line for each run, and does more before it."""
    script = folder / "hvp"
    script.write_text(
        f'#!/bin/sh\n[ "$1" = run ] && {{ echo run >> "{folder}/runs"; {then}\n}}\n'
        f'exec "{program.path}" "$@"\n'
    )
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    return Program(script)


def runs(folder: Path) -> int:
    """How many runs counting() has seen begin."""
    log = folder / "runs"
    return len(log.read_text().splitlines()) if log.exists() else 0


def wait_until(holds: Callable[[], bool]) -> None:
    """Wait for it; after a minute it is a failure."""
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline, "it does not come to pass"
        time.sleep(0.01)


class StudyProcess:
    """`hvp study` over the stiffness of a wall, two runs at once, all files in a folder."""

    def __init__(self, folder: Path, program: Program, scenario: Path, points: int) -> None:
        self.folder = folder
        self.store = folder / "store"
        self.temporary = folder / "tmp"
        self.temporary.mkdir(exist_ok=True)
        file = folder / "study.toml"
        file.write_text(
            f'scenario = "{scenario}"\nset = ["frames=20"]\n[[axis]]\nkey = "wall.stiffness"\n'
            f'from = "100 N/m"\nto = "1000 N/m"\nsteps = {points}\n'
        )
        self.command = [sys.executable, "-B", "-m", "studies", "study", str(file), "--jobs", "2"]
        self.command += ["--out", str(folder / "out"), "--store", str(self.store)]
        self.environment = {
            **os.environ,
            "HVP_PROGRAM": str(program.path),
            "PYTHONPATH": str(TOP),
            "TMPDIR": str(self.temporary),
        }

    def start(self) -> "subprocess.Popen[str]":
        """Begin it, out of the reach of the terminal that the tests have."""
        return subprocess.Popen(
            self.command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=self.environment,
            start_new_session=True,
        )

    def finish(self, *more: str) -> str:
        """Run it to its end, which has to be a good one; what it says."""
        return subprocess.run(
            [*self.command, *more],
            env=self.environment,
            check=True,
            capture_output=True,
            text=True,
            timeout=2 * PATIENCE_S,
        ).stdout

    def kept(self) -> int:
        """How many records the store has."""
        return len(list(self.store.glob("??/*.json")))
