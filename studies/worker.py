"""Runs one point as a process of its own and makes a record of what it wrote."""

import contextlib
import json
import os
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.errors import StudyError
from studies.guardian import guarded_environment
from studies.point import Point
from studies.record import Record, Status, flatten
from studies.scratch import scratch_folder

_MAKES_FILES = "run"


def command_of(program: Path, point: Point, out: Path | None = None) -> list[str]:
    """The words of the command line that runs a point."""
    command = [str(program), point.command, str(point.scenario)]
    for include in point.includes:
        command += ["--include", str(include)]
    for override in point.settings:
        command += ["--set", override]
    command += point.arguments
    if point.command == _MAKES_FILES:
        if out is not None:
            command += ["--out", str(out)]
    else:
        command.append("--json")
    return [*command, "--quiet"]


def execute(
    program: Path, point: Point, address: str, time_limit_s: float | None = None
) -> tuple[Record, dict[str, bytes]]:
    """Run a point. Returns its record and the files that it keeps.

    Throws EndedError after end_all(), StudyError where there is no room for what it writes.
    """
    with scratch_folder() as folder:
        out = folder / "run"
        started = time.monotonic()
        try:
            done = _run(command_of(program, point, out), time_limit_s)
        except subprocess.TimeoutExpired:
            limit = time_limit_s or 0.0
            message = f"no end within {limit:g} s"
            return Record(address, "timed out", -1, message, wall_s=limit), {}
        wall = time.monotonic() - started
        status = _status(done.returncode)
        error = done.stderr.decode(errors="replace").strip().splitlines()
        message = error[-1] if error else ""
        if status not in ("held", "not held"):
            if f"cannot write {folder}" in message:  # a full disk here is no fault of the run
                raise StudyError(message.removeprefix("hvp: "))
            if done.returncode < 0:
                message = f"ended by signal {-done.returncode}; {message}".rstrip("; ")
            return Record(address, status, done.returncode, message, wall_s=wall), {}
        if point.command == _MAKES_FILES:
            document = json.loads((out / "summary.json").read_bytes())
        else:
            document = json.loads(done.stdout)
        kept = {name: (out / name).read_bytes() for name in point.keep if (out / name).exists()}
        return Record(
            address,
            status,
            done.returncode,
            message,
            verdict=str(document.get("verdict", "")),
            flags=_flags(document),
            metrics=flatten(document),
            wall_s=wall,
        ), kept


class EndedError(Exception):
    """The run was ended because nobody waits for it any more: that says nothing of the run."""


_running: set[subprocess.Popen[bytes]] = set()
_ending = threading.Event()


def _run(command: list[str], time_limit_s: float | None) -> subprocess.CompletedProcess[bytes]:
    """Run a program with what it starts itself. Throws TimeoutExpired once all of that has ended,
    and EndedError after end_all().

    It is a session of its own, so that a terminal's Ctrl-C does not end it: what is under way when
    a study is interrupted is finished and kept.
    """
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=guarded_environment(),
        start_new_session=True,
    )
    _running.add(process)
    if _ending.is_set():  # it may have begun too late for end_all() to know of it
        _end(process)
    try:
        output, error = process.communicate(timeout=time_limit_s)
    except BaseException:
        _end(process)
        process.communicate()
        raise
    finally:
        _running.discard(process)
    if _ending.is_set():
        raise EndedError
    return subprocess.CompletedProcess(command, process.returncode, output, error)


def _end(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def end_all() -> None:
    """End every run of this process at once, and whatever begins later: it is about to end."""
    _ending.set()
    for process in list(_running):
        _end(process)


def _status(exit_status: int) -> Status:
    known: dict[int, Status] = {0: "held", 1: "not held", 2: "refused"}
    return known.get(exit_status, "crashed")


def _flags(document: dict[str, Any]) -> list[str]:
    stability = document.get("stability", {})
    flags: Sequence[Any] = stability.get("flags", []) if isinstance(stability, dict) else []
    return [flag["name"] if isinstance(flag, dict) else str(flag) for flag in flags]
