"""A study as a Slurm array: a script for sbatch, whose every task runs its share of the points into
the study's store, and the file of points beside it.

The points are a file of their own, a JSON object a line, so that what was submitted is what is run,
whatever becomes of the study's file while it waits in the queue.
"""

import json
import shlex
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studies.carry import Task
from studies.errors import InputError
from studies.point import Point

# Slurm's own MaxArraySize, unless a site has set it: an index is below 1001.
LARGEST_ARRAY = 1000
_SUFFIX = ".points"


def write_array(script: Path, tasks: Sequence[Task], size: int | None = None) -> int:
    """Write the script and its points. Returns how many tasks the array has."""
    if not tasks:
        raise InputError("nothing is left to run: the store has every point")
    size = min(len(tasks), LARGEST_ARRAY if size is None else size)
    points = script.with_name(script.name + _SUFFIX).resolve()
    _write(points, "".join(json.dumps(_as_json(task), sort_keys=True) + "\n" for task in tasks))
    _write(script, _script(points, len(tasks), size))
    script.chmod(0o755)
    return size


def read_share(points: Path, share: int, shares: int) -> list[Task]:
    """The tasks of one share: every so manieth, as neighbours often cost alike."""
    if not 0 <= share < shares:
        raise InputError(f"--share {share}/{shares}: expected I/N with 0 <= I < N")
    if not points.is_file():
        raise InputError(f"{points}: not there; expected the points that --slurm wrote")
    tasks = []
    with points.open(encoding="utf-8") as lines:
        for number, line in enumerate(lines):
            if number % shares == share:
                try:
                    tasks.append(_from_json(json.loads(line)))
                except (ValueError, TypeError, KeyError) as error:
                    raise InputError(
                        f"{points}:{number + 1}: expected a point as --slurm writes it: {error}"
                    ) from error
    return tasks


def _script(points: Path, count: int, size: int) -> str:
    top = Path(__file__).resolve().parents[1]
    command = [sys.executable, "-B", "-m", "studies", "task", str(points)]
    return f"""#!/bin/bash
#SBATCH --job-name=hvp
#SBATCH --array=0-{size - 1}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
# {count} runs in {size} tasks. Submit it with sbatch, and with what your site wants besides
# (--partition, --time, --mem); options there override those here. Submitted again, it runs what
# is missing. Then the command that wrote it, without --slurm, finds the runs done and makes the
# tables.
set -euo pipefail
export PYTHONPATH={shlex.quote(str(top))}
exec {shlex.join(command)} --share "$SLURM_ARRAY_TASK_ID/{size}"
"""


def _as_json(task: Task) -> dict[str, Any]:
    document = asdict(task)
    document["program"] = str(task.program.resolve())
    document["store"] = str(task.store.resolve())
    document["point"]["scenario"] = str(task.point.scenario.resolve())
    document["point"]["includes"] = [str(path.resolve()) for path in task.point.includes]
    return document


def _from_json(document: dict[str, Any]) -> Task:
    point = document.pop("point")
    return Task(
        **document
        | {
            "program": Path(document["program"]),
            "store": Path(document["store"]),
            "point": Point(
                **point
                | {
                    "scenario": Path(point["scenario"]),
                    "includes": tuple(map(Path, point["includes"])),
                    "overrides": tuple(point["overrides"]),
                    "arguments": tuple(point["arguments"]),
                    "keep": tuple(point["keep"]),
                }
            ),
        }
    )


def _write(path: Path, text: str) -> None:
    beside = path.with_name(path.name + ".part")
    try:
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
