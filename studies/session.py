"""Brings the points of a study to their records: from the store, or by running them."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import groupby

from studies.point import Point
from studies.program import Program, Refused
from studies.record import Record
from studies.store import Store
from studies.worker import execute

# Called with how many records there are and how many there will be.
Progress = Callable[[int, int], None]


@dataclass
class Session:
    """A program, a store, and how runs are carried out: one a core unless said otherwise."""

    program: Program
    store: Store
    workers: int = os.cpu_count() or 1
    time_limit_s: float | None = None
    retries: int = 1  # of a run that crashed

    def addresses(self, points: Sequence[Point]) -> list[str | Refused]:
        """Where each point's record is stored, or why there cannot be one."""
        found: list[str | Refused] = []
        for (scenario, includes), group in groupby(points, lambda p: (p.scenario, p.includes)):
            members = list(group)
            each = [point.settings for point in members]
            for point, resolved in zip(
                members, self.program.resolve(scenario, each, includes), strict=True
            ):
                if isinstance(resolved, Refused):
                    found.append(resolved)
                else:
                    found.append(
                        self.program.address(resolved, point.command, *point.arguments, *point.keep)
                    )
        return found

    def run(self, points: Sequence[Point], progress: Progress | None = None) -> list[Record]:
        """The record of each point, in their order. What stops it loses nothing that is done."""
        records: dict[str, Record] = {}
        wanted: dict[str, Point] = {}
        addresses = self.addresses(points)
        for point, address in zip(points, addresses, strict=True):
            if isinstance(address, Refused):
                continue
            known = self.store.get(address)
            if known is not None:
                records[address] = known
            else:
                wanted.setdefault(address, point)
        total = len(records) + len(wanted)
        if progress:
            progress(len(records), total)
        with ThreadPoolExecutor(self.workers) as pool:
            pending: dict[Future[Record], str] = {
                pool.submit(self._carry_out, point, address): address
                for address, point in wanted.items()
            }
            try:
                while pending:
                    done, _ = wait(pending, return_when=FIRST_COMPLETED)
                    for future in done:
                        records[pending.pop(future)] = future.result()
                        if progress:
                            progress(len(records), total)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
        return [
            Record("", "refused", 2, address.message)
            if isinstance(address, Refused)
            else records[address]
            for address in addresses
        ]

    def _carry_out(self, point: Point, address: str) -> Record:
        for attempt in range(1 + self.retries):
            record, files = execute(self.program.path, point, address, self.time_limit_s)
            if record.status not in ("crashed", "timed out") or attempt == self.retries:
                break
        if record.status not in ("crashed", "timed out"):
            self.store.put(record, files)
        return record
