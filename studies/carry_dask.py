"""Carries runs by a dask.distributed cluster: any workers that see the program, the scenarios and
the store under the same names.

Dask only carries. A worker looks into the store before it runs anything and writes the record
there itself, so that a task that Dask hands out again, because a worker, the scheduler or whoever
asked died, costs no second run of what was finished.
"""

import functools
import logging
import queue
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from dataclasses import dataclass, replace
from pathlib import Path

from distributed import Client, Future, KilledWorker
from distributed.comm.addressing import parse_address

from studies.carry import Task, carry_out
from studies.errors import StudyError
from studies.program import Program
from studies.record import Record
from studies.store import Store

# So many are with the scheduler at once: enough for a few hundred workers, and no more memory for
# a study of a hundred thousand.
_IN_FLIGHT = 1000
_LOOK_EVERY_S = 0.2
_TOP = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class DaskCarrier:
    """A scheduler by its address, tcp://HOST:PORT."""

    scheduler: str
    connect_s: float = 10.0

    def carry(self, tasks: Sequence[Task]) -> Iterator[Record]:
        """As Carrier says. Throws StudyError for a scheduler that is not there or goes away."""
        if not tasks:
            return
        client = self._connect()
        if not client.scheduler_info()["workers"]:
            print(f"{self.scheduler} has no workers yet: waiting for one", file=sys.stderr)
        try:
            yield from self._carry(client, [_anywhere(task) for task in tasks])
        finally:
            # Not for longer than a moment: the scheduler may be gone.
            client.close(timeout=1)  # type: ignore[no-untyped-call]

    def _connect(self) -> Client:
        try:
            parse_address(self.scheduler, strict=True)
        except ValueError as error:
            raise StudyError(
                f"--scheduler {self.scheduler}: expected an address, tcp://HOST:PORT"
            ) from error
        # What goes wrong is said once, and as everything else here is.
        for name in ("distributed", "distributed.client", "tornado.application"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        try:
            return Client(self.scheduler, timeout=self.connect_s, set_as_default=False)  # type: ignore[no-untyped-call]
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            raise StudyError(
                f"no scheduler at {self.scheduler} within {self.connect_s:g} s; "
                "`dask scheduler` starts one"
            ) from error

    def _carry(self, client: Client, tasks: list[Task]) -> Iterator[Record]:
        ended: queue.SimpleQueue[Future[Record]] = queue.SimpleQueue()
        waiting: dict[str, Task] = {}
        futures: dict[str, Future[Record]] = {}
        rest = iter(tasks)
        while True:
            while len(waiting) < _IN_FLIGHT and (task := next(rest, None)) is not None:
                key = f"hvp-{task.address}"
                waiting[key] = task
                futures[key] = client.submit(_carry_out, task, key=key, pure=False)
                futures[key].add_done_callback(ended.put)  # type: ignore[no-untyped-call]
            if not waiting:
                return
            try:
                future = ended.get(timeout=_LOOK_EVERY_S)
            except queue.Empty:
                self._look(client)
                continue
            self._look(client)
            key = str(future.key)
            yield self._record(waiting.pop(key), futures.pop(key))

    def _look(self, client: Client) -> None:
        if client.status != "running":
            raise self._gone()

    def _gone(self) -> StudyError:
        return StudyError(
            f"the scheduler at {self.scheduler} is gone; what was finished is in the store, "
            "and the same command goes on from there"
        )

    def _record(self, task: Task, future: Future[Record]) -> Record:
        try:
            record = future.result(timeout=self.connect_s)
        except KilledWorker:
            # Each of some workers died of it: so would the next.
            return Record(task.address, "crashed", -1, "every worker that ran it was killed")
        except StudyError:
            raise
        except CancelledError as error:
            raise self._gone() from error
        except (OSError, TimeoutError) as error:
            if future.status != "error":  # the task had none: its result did not come through
                raise self._gone() from error
            raise StudyError(f"a worker of {self.scheduler}: {error}") from error
        except (ImportError, RuntimeError) as error:
            # Dask's words for a task that the scheduler or a worker could not even read.
            raise StudyError(
                f"{self.scheduler} cannot read a task: its scheduler and workers have to be "
                f"started with PYTHONPATH={_TOP} and the packages of studies/requirements.txt"
            ) from error
        finally:
            future.release()  # type: ignore[no-untyped-call]
        if record.done and Store(task.store).get(record.address) is None:
            raise StudyError(
                f"a worker of {self.scheduler} has not written into {task.store}: workers have to "
                "see the store under the same name, on a shared file system"
            )
        return record


def _anywhere(task: Task) -> Task:
    """With names that hold in any folder."""
    point = replace(
        task.point,
        scenario=task.point.scenario.resolve(),
        includes=tuple(include.resolve() for include in task.point.includes),
    )
    return replace(task, program=task.program.resolve(), store=task.store.resolve(), point=point)


def _carry_out(task: Task) -> Record:
    """What a worker does. Throws StudyError where its program is another one."""
    try:
        status = task.program.stat()
        found = _fingerprint(task.program, status.st_mtime_ns, status.st_size)
    except OSError as error:
        raise StudyError(f"a worker has no {task.program}: {error.strerror}") from error
    if found != task.fingerprint:
        raise StudyError(f"a worker has another program at {task.program}: its results are others")
    return carry_out(task)


@functools.lru_cache(maxsize=8)
def _fingerprint(program: Path, _changed_ns: int, _size: int) -> str:
    return Program(program).fingerprint
