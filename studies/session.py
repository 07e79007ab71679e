"""Brings the points of a study to their records: from the store, or by running them."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from studies.carry import Carrier, LocalPool, Task
from studies.point import Point
from studies.program import Program, Refused
from studies.record import Record
from studies.store import Records, Store

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
    again: bool = False  # whether runs that have crashed before are tried again
    carrier: Carrier | None = None  # this machine's processors, unless said otherwise

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

    def run(self, points: Sequence[Point], progress: Progress | None = None) -> Records:
        """The record of each point, in their order. What stops it loses nothing that is done."""
        done: set[str] = set()
        without: dict[str, Record] = {}  # those that have no figures, which the store may lack
        wanted: dict[str, Point] = {}
        addresses = self.addresses(points)
        for point, address in zip(points, addresses, strict=True):
            if isinstance(address, Refused) or address in done or address in wanted:
                continue
            known = self._known(point, address)
            if known is None:
                wanted[address] = point
                continue
            done.add(address)
            if not known.done:
                without[address] = known
        total = len(done) + len(wanted)
        if progress:
            progress(len(done), total)
        carrier = self.carrier or LocalPool(self.workers)
        try:
            for record in carrier.carry(self._tasks(wanted)):
                done.add(record.address)
                if not record.done:
                    without[record.address] = record
                if progress:
                    progress(len(done), total)
        except KeyboardInterrupt:
            # What was under way is kept too.
            if progress:
                late = [a for a in wanted if a not in done and self.store.get(a) is not None]
                progress(len(done) + len(late), total)
            raise
        return Records(
            self.store,
            [
                Record("", "refused", 2, address.message)
                if isinstance(address, Refused)
                else without.get(address, address)
                for address in addresses
            ],
        )

    def missing(self, points: Sequence[Point]) -> list[Task]:
        """What has to be run for them: each once, and nothing that the store has."""
        addresses = self.addresses(points)
        wanted = {
            address: point
            for point, address in zip(points, addresses, strict=True)
            if not isinstance(address, Refused) and self._known(point, address) is None
        }
        return self._tasks(wanted)

    def _known(self, point: Point, address: str) -> Record | None:
        """What the store has, where that answers the point."""
        known = self.store.get(address)
        if known is None or self._task(point, address).is_to_be_tried(known):
            return None
        return known

    def _tasks(self, wanted: Mapping[str, Point]) -> list[Task]:
        return [self._task(point, address) for address, point in wanted.items()]

    def _task(self, point: Point, address: str) -> Task:
        return Task(
            self.program.path,
            self.program.fingerprint,
            self.store.folder,
            point,
            address,
            self.time_limit_s,
            self.retries,
            self.again,
        )
