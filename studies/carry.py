"""Who carries the runs of a study out: the processors of this machine, or others' (carry_dask).

A carrier only carries. What has been run is in the store before anybody hears of it, so that the
death of a carrier, or of who waits for it, loses nothing that was finished.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Protocol

from studies.point import Point
from studies.record import Record
from studies.store import Store
from studies.worker import execute


@dataclass(frozen=True)
class Task:
    """A point and all that it takes to run it and to keep its record.

    `fingerprint` is the program's: an address is one of its records, and of no other's.
    """

    program: Path
    fingerprint: str
    store: Path
    point: Point
    address: str
    time_limit_s: float | None = None
    retries: int = 1  # of a run that crashed


class Carrier(Protocol):
    """Runs tasks in any order."""

    def carry(self, tasks: Sequence[Task]) -> Iterator[Record]:
        """The record of each task as it comes. Throws StudyError where no more will."""


def carry_out(task: Task) -> Record:
    """Run a task, unless the store has its record by now, and store the record that it gives.

    A run that crashed or had no end is not stored: the next study tries it again.
    """
    store = Store(task.store)
    known = store.get(task.address)
    if known is not None:
        return known
    for attempt in range(1 + task.retries):
        record, files = execute(task.program, task.point, task.address, task.time_limit_s)
        if record.status not in ("crashed", "timed out") or attempt == task.retries:
            break
    if record.status not in ("crashed", "timed out"):
        store.put(record, files)
    return record


@dataclass(frozen=True)
class LocalPool:
    """So many runs at once, each a process of this machine."""

    workers: int

    def carry(self, tasks: Sequence[Task]) -> Iterator[Record]:
        """As Carrier says. What ends it early cancels what has not begun."""
        rest = iter(tasks)
        with ThreadPoolExecutor(self.workers) as pool:
            pending: set[Future[Record]] = set()
            try:
                while True:
                    # No more than keeps them busy: waiting costs time with each that is waited for.
                    for task in islice(rest, 2 * self.workers - len(pending)):
                        pending.add(pool.submit(carry_out, task))
                    if not pending:
                        return
                    done, pending = wait(pending, return_when=FIRST_COMPLETED)
                    for future in done:
                        yield future.result()
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
