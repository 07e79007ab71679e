"""Which numbers of finished rows can wait in a partition beside a package that enters or waits.

A partition alone, with whatever its neighbours may do to it: a row is taken before it has waited as
many clocks as there are partitions (proved of row_collector.sv), finished rows and those on their
way are no more than its queue has places for (proved of spmxv_partition.sv), and rows of more
packages come before those of fewer (engine::Layout). Every state of that is visited.
"""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

# A package's ranks from its last turn to its row's place in the queue.
ROWS_ON_THE_WAY = 8
RUNS, WAITS_FOR_A_TURN, WAITS_FOR_ROOM = range(3)
# What packages are left: of rows of several, of rows of one each, or none.
LONG_ROWS, SHORT_ROWS, NONE = range(3)


@dataclass(frozen=True)
class Queue:
    """What decides about the rows that wait in a partition."""

    depth: int
    partitions: int
    fewest_turns: int  # of a package
    most_turns: int


class Package(NamedTuple):
    """The one that enters next."""

    rows: int
    amid_a_row: bool
    turns: int  # before its last one


class State(NamedTuple):
    waiting: int
    on_the_way: int  # a bit for each of their ranks
    waited: int  # clocks, the row that comes next
    package: Package


def _begins(queue: Queue, rows: int, amid_a_row: bool) -> Iterator[Package]:
    for turns in range(queue.fewest_turns - 1, queue.most_turns):
        yield Package(rows, amid_a_row, turns)


def _next_rows(queue: Queue, rows: int) -> Iterator[Package]:
    for others in range(rows, NONE):
        yield from _begins(queue, others, False)
    yield Package(NONE, False, 0)


def _packages(queue: Queue, state: State) -> Iterator[tuple[int, bool, Package]]:
    """What the package may do at this clock, whether it is the last of a row, and what is next."""
    package = state.package
    full = state.waiting + state.on_the_way.bit_count() >= queue.depth
    if package.rows == NONE:
        yield RUNS, False, package
    elif package.turns > 0:
        yield WAITS_FOR_A_TURN, False, package._replace(turns=package.turns - 1)
    else:
        if package.rows == LONG_ROWS:
            for following in _begins(queue, LONG_ROWS, True):
                yield RUNS, False, following
        if package.rows == SHORT_ROWS or package.amid_a_row:
            if full:
                yield WAITS_FOR_ROOM, False, package
            else:
                for following in _next_rows(queue, package.rows):
                    yield RUNS, True, following


@cache
def can_wait(queue: Queue) -> frozenset[tuple[int, int]]:
    """Pairs of what a package does and how many rows wait."""
    states = {State(0, 0, 0, package) for package in _next_rows(queue, LONG_ROWS)}
    left = deque(states)
    pairs = set()
    while left:
        state = left.popleft()
        finishes = state.on_the_way >> (ROWS_ON_THE_WAY - 1)
        has_to = state.waiting > 0 and state.waited >= queue.partitions - 1
        for does, enters, package in _packages(queue, state):
            pairs.add((does, state.waiting))
            for takes in {has_to, state.waiting > 0}:
                following = State(
                    state.waiting + finishes - takes,
                    (state.on_the_way << 1 | enters) & ((1 << ROWS_ON_THE_WAY) - 1),
                    0 if takes or state.waiting == 0 else state.waited + 1,
                    package,
                )
                if following not in states:
                    states.add(following)
                    left.append(following)
    return frozenset(pairs)
