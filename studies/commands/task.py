"""`hvp task`: what a task of a Slurm array does. The script that `--slurm` writes calls it."""

import argparse
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from studies.carry import LocalPool, Task
from studies.errors import FAILED, HELD, InputError, StudyError
from studies.program import Program
from studies.session import Session
from studies.slurm import read_share
from studies.store import Store

if TYPE_CHECKING:
    from studies.commands import Subparsers


def add_task(subparsers: "Subparsers") -> None:
    """Declare the command."""
    parser = subparsers.add_parser(
        "task", help="run a share of the points of a file that --slurm has written"
    )
    parser.add_argument("points", type=Path, help="that file")
    parser.add_argument("--share", required=True, metavar="I/N", help="the I-th of N, from 0")
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace) -> int:
    share = re.fullmatch(r"(\d+)/(\d+)", arguments.share)
    if share is None:
        raise InputError(f"--share {arguments.share}: expected I/N with 0 <= I < N")
    tasks = read_share(arguments.points, int(share[1]), int(share[2]))
    if not tasks:
        return HELD
    _check(tasks)
    # What Slurm has given to the task. It has a run each of its processors.
    workers = int(os.environ.get("SLURM_CPUS_PER_TASK", "1"))
    failed = 0
    for record in LocalPool(workers).carry(tasks):
        if not record.done and record.status != "refused":
            failed += 1
            print(f"{record.address}: {record.status}: {record.message}")
    print(f"{len(tasks) - failed} of {len(tasks)} runs done")
    return FAILED if failed else HELD


def _check(tasks: list[Task]) -> None:
    """Throws StudyError where a run would be another one than was asked for when it was queued."""
    session = Session(Program(tasks[0].program), Store(tasks[0].store))
    for task, address in zip(tasks, session.addresses([t.point for t in tasks]), strict=True):
        if address != task.address:
            raise StudyError(
                f"{task.point.scenario} or {task.program} has changed since the array was written: "
                "write it again with --slurm"
            )
