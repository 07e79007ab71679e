"""Ends the runs of a study that is gone: one that is killed has no time to do so itself.

A process of its own holds the end of a pipe, which the system closes with the study, however that
ends; then it ends whatever has the study's mark in its environment. PR_SET_PDEATHSIG would have to
be set between fork and exec: that makes a copy of the study's memory for each run, 10 ms in place
of 0.2 ms, and does not reach what a run has started itself.
"""

import atexit
import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

_MARK = "HVP_STUDY"
_starting = threading.Lock()
_environment: dict[str, str] = {}


def guarded_environment() -> dict[str, str]:
    """What a process has to be given so that it ends with this one."""
    with _starting:
        if not _environment:
            mark = f"{os.getpid()}-{os.urandom(8).hex()}"
            guardian = subprocess.Popen(
                [sys.executable, "-I", "-S", __file__, mark],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd="/",
                start_new_session=True,  # out of the reach of a terminal's Ctrl-C
            )
            atexit.register(guardian.communicate)
            _environment.update(os.environ | {_MARK: mark})
    return _environment


def _watch(mark: str) -> None:
    sys.stdin.buffer.read()
    # One that was about to begin is found the second time.
    while _end_marked(f"{_MARK}={mark}".encode()):
        time.sleep(0.1)
    time.sleep(0.1)
    _end_marked(f"{_MARK}={mark}".encode())


def _end_marked(mark: bytes) -> int:
    """End what has the mark; how many there were."""
    count = 0
    for process in Path("/proc").glob("[0-9]*"):
        # Others' processes, and those that have just ended, cannot be read.
        with contextlib.suppress(OSError):
            if mark in (process / "environ").read_bytes().split(b"\0"):
                os.kill(int(process.name), signal.SIGKILL)
                count += 1
    return count


if __name__ == "__main__":
    _watch(sys.argv[1])
