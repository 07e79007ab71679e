"""What a contest of solvers says: a row an entry, and the answer in words."""

from collections.abc import Sequence
from dataclasses import dataclass

from studies.point import Value
from studies.record import Record
from studies.results import Column
from studies.solvers.contest import BOARD, Entry

WORST = "worst_us"
LOAD = "load_us"
FORCE = "force_error"
HELD = "held"

COLUMNS = (
    Column("host", "", "whose figures price the host's work, by host.model"),
    Column("solver", "", "who solves a frame, by host.solver and host.precision"),
    Column("status", "", "held, not held, refused, crashed or timed out"),
    Column(WORST, "us", "worst latency of a frame"),
    Column("p999_us", "us", "99.9 % of the frames are within it"),
    Column(LOAD, "us", "worst work of a period"),
    Column("miss_low", "", "of all ticks at least so many miss, by 95 %"),
    Column("miss_high", "", "and at most so many, where ticks are independent"),
    Column(FORCE, "", "of the frame's own force, 95 % of the frames in contact are within it"),
    Column("displacement_error", "", "likewise of its displacement"),
    Column("memory_bytes", "B", "that the host's solver keeps; none of the board"),
    Column("set_up_us", "us", "before the first frame"),
    Column("limits", "", "what it cannot do"),
    Column("flags", "", "that the run raised"),
    Column("message", "", "why there are no figures"),
)
_METRICS = {
    WORST: "deadline.worst_us",
    "p999_us": "deadline.p999_us",
    LOAD: "load.worst_us",
    "miss_low": "deadline.miss_share.low",
    "miss_high": "deadline.miss_share.high",
    FORCE: "accuracy.force_of_frame.p95",
    "displacement_error": "accuracy.displacement_of_frame.p95",
    "memory_bytes": "host_solve.memory_bytes",
    "set_up_us": "set_up_us",
}
BUDGET = "deadline.budget_us"


@dataclass(frozen=True)
class Outcome:
    """An entry that has been run."""

    entry: Entry
    record: Record

    def metric(self, name: str) -> float | None:
        """A figure by its column; none where there is none."""
        value = self.record.metrics.get(_METRICS.get(name, name))
        return float(value) if isinstance(value, int | float) else None

    @property
    def held(self) -> bool:
        """Whether every budget of the scenario is met."""
        return self.record.status == HELD

    @property
    def on_board(self) -> bool:
        """Whether the board solves."""
        return self.entry.solver.name == BOARD

    @property
    def name(self) -> str:
        """As a sentence calls it."""
        who = "the board" if self.on_board else f"a core by {self.entry.solver.label}"
        return f"{who} ({self.entry.host})"


def row(outcome: Outcome) -> dict[str, Value]:
    """Its cells."""
    record = outcome.record
    cells: dict[str, Value] = {
        "host": outcome.entry.host,
        "solver": outcome.entry.solver.label,
        "status": record.status,
        "limits": outcome.entry.solver.limits,
        "flags": " ".join(record.flags) if record.done else None,
        "message": None if record.done else record.message,
    }
    return cells | {name: outcome.metric(name) for name in _METRICS}


def words(outcomes: Sequence[Outcome]) -> list[str]:
    """The answer first: whether a host does without the board, then each host's best."""
    hosts = list(dict.fromkeys(o.entry.host for o in outcomes))
    return [
        _answer(outcomes),
        *(_of_host([o for o in outcomes if o.entry.host == h]) for h in hosts),
    ]


def best(outcomes: Sequence[Outcome]) -> Outcome | None:
    """Of those that hold the one whose worst period has least work."""
    held = [o for o in outcomes if o.held and o.metric(LOAD) is not None]
    return min(held, key=lambda o: o.metric(LOAD) or 0.0, default=None)


def _answer(outcomes: Sequence[Outcome]) -> str:
    host = best([o for o in outcomes if not o.on_board])
    boards = [o for o in outcomes if o.on_board]
    board = best(boards)
    if host and board:
        first = (
            "A core beats the board"
            if (host.metric(LOAD) or 0) < (board.metric(LOAD) or 0)
            else "The board is faster than a core, and a core would do"
        )
        return f"{first}: {_figures(host)}; {_figures(board)}."
    if host:
        return f"A core does what the board does not: {_figures(host)}; {_figures(_least(boards))}."
    if board:
        others = _least([o for o in outcomes if not o.on_board])
        return f"The board is needed: {_figures(board)}; {_figures(others)}."
    return f"Nobody holds every budget; the least work: {_figures(_least(outcomes))}."


def _least(outcomes: Sequence[Outcome]) -> Outcome:
    done = [o for o in outcomes if o.metric(LOAD) is not None]
    return min(done or outcomes, key=lambda o: o.metric(LOAD) or 0.0)


def _of_host(outcomes: Sequence[Outcome]) -> str:
    host = outcomes[0].entry.host
    held = [o for o in outcomes if o.held]
    chosen = best(outcomes)
    refused = [o.entry.solver.label for o in outcomes if not o.record.done]
    text = f"{host}: {len(held)} of {len(outcomes)} hold every budget"
    if chosen:
        text += f"; least work {_figures(chosen)}"
    if refused:
        text += f"; without figures {', '.join(refused)}"
    return text + "."


def _figures(outcome: Outcome) -> str:
    if not outcome.record.done:
        return f"{outcome.name} has no figures ({outcome.record.message})"
    budget = outcome.metric(BUDGET) or 0.0
    error = outcome.metric(FORCE)
    return (
        f"{outcome.name} has its worst force after {_ms(outcome.metric(WORST))} of "
        f"{_ms(budget)}, its worst period's work takes {_ms(outcome.metric(LOAD))}, "
        f"{'force not compared' if error is None else f'95 % of its forces within {error:.2g}'}"
    )


def _ms(microseconds: float | None) -> str:
    return "-" if microseconds is None else f"{microseconds / 1000:.4g} ms"
