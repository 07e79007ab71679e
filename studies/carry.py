"""Who carries the runs of a study out: the processors of this machine, or others' (carry_dask).

A carrier only carries. What has been run is in the store before anybody hears of it, so that the
death of a carrier, or of who waits for it, loses nothing that was finished.
"""

import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Protocol

from studies.point import Point
from studies.record import Record
from studies.store import Store
from studies.worker import end_all, execute

_ONCE_MORE = "Ctrl-C once more ends them without keeping them"
_END_S = 5.0


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
    again: bool = False  # whether one that has crashed before is tried again

    def is_to_be_tried(self, known: Record) -> bool:
        """Whether a record that the store has does not answer the task."""
        if known.status == "timed out" and (
            self.time_limit_s is None or self.time_limit_s > known.wall_s
        ):
            return True
        return known.failed and self.again


class Carrier(Protocol):
    """Runs tasks in any order."""

    def carry(self, tasks: Sequence[Task]) -> Iterator[Record]:
        """The record of each task as it comes. Throws StudyError where no more will."""


def carry_out(task: Task) -> Record:
    """Run a task, unless the store has its record by now, and store the record that it gives.

    One that crashes every time is stored too, so that nobody waits for it again unasked.
    """
    store = Store(task.store)
    with store.claim(task.address):
        known = store.get(task.address)
        if known is not None and not task.is_to_be_tried(known):
            return known
        for attempt in range(1 + task.retries):
            record, files = execute(task.program, task.point, task.address, task.time_limit_s)
            if record.status != "crashed" or attempt == task.retries:
                break
        if record.done or record.failed:
            store.put(record, files)
    return record


@dataclass(frozen=True)
class LocalPool:
    """So many runs at once, each a process of this machine."""

    workers: int

    def carry(self, tasks: Sequence[Task]) -> Iterator[Record]:
        """As Carrier says. What ends it early cancels what has not begun."""
        rest = iter(tasks)
        pool = ThreadPoolExecutor(self.workers)
        pending: set[Future[Record]] = set()
        try:
            while True:
                # No more than keeps them busy: waiting costs time with each that is waited for.
                for task in islice(rest, 2 * self.workers - len(pending)):
                    pending.add(pool.submit(carry_out, task))
                if not pending:
                    break
                done, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        except BaseException as reason:
            # An interruption finds the program here, or at what it does with a record.
            _finish(pool, pending, isinstance(reason, KeyboardInterrupt | GeneratorExit))
            raise
        pool.shutdown()


def _finish(pool: ThreadPoolExecutor, pending: set[Future[Record]], interrupted: bool) -> None:
    """What is under way is kept; who cannot wait for it interrupts once more."""
    under_way: list[Future[Record]] = []
    try:
        pool.shutdown(wait=False, cancel_futures=True)
        # Of one that was cancelled before a thread took it, nobody ever hears again.
        under_way = [future for future in pending if not future.done()]
        if under_way and interrupted:
            print(f"\nfinishing {len(under_way)} under way; {_ONCE_MORE}", file=sys.stderr)
        wait(under_way)
    except KeyboardInterrupt:
        end_all()
        # Nor for ever: one may be waiting for another study's run.
        wait(under_way, timeout=_END_S)
