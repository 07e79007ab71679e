"""What a contest of solvers says: a row an entry, and the answer in words."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.errors import InputError
from studies.point import Value
from studies.record import Record
from studies.results import Column
from studies.solvers.contest import BOARD, MEASURED, Entry

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
    Column("late_probability", "", "that a force is late, by the distributions that are drawn"),
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
    "late_probability": "deadline.late_probability.share",
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
        solver = self.entry.solver
        who = "the board" if self.on_board else f"a core by {solver.label}"
        if solver.launch:
            way = filter(None, (solver.name, solver.precision, solver.launch))
            who = f"a GPU by {', '.join(way)}"
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
    figures = {name: outcome.metric(name) for name in _METRICS}
    if not outcome.entry.drawn:
        # Every run of it is the same.
        figures["miss_low"] = figures["miss_high"] = figures["late_probability"] = None
    return cells | figures


def require_figures(outcomes: Sequence[Outcome], scenario: Path) -> None:
    """Throws InputError where there is nothing to compare: every run was refused, or no frame was
    in contact, where a solver that does nothing is as good as any."""
    if not any(outcome.record.done for outcome in outcomes):
        raise InputError(f"{scenario}: every run was refused: {outcomes[0].record.message}")
    if all(outcome.metric(FORCE) is None for outcome in outcomes):
        raise InputError(
            f"{scenario}: frames: no frame in contact was compared with the true model: expected "
            "frames until the probe touches the body"
        )


def words(outcomes: Sequence[Outcome], left_out: Sequence[str] = ()) -> list[str]:
    """The answer first: whether a host does without the board, then each host's best."""
    hosts = list(dict.fromkeys(o.entry.host for o in outcomes))
    lines = [_answer(outcomes)]
    lines += [_of_host([o for o in outcomes if o.entry.host == host]) for host in hosts]
    if left_out:
        lines.append(f"Without a board there is no {', '.join(left_out)}: left out for the hosts.")
    if MEASURED in hosts:
        lines.append(
            f"{MEASURED} wakes as late as its file says; the other hosts as the scenario says."
        )
    return lines


def best(outcomes: Sequence[Outcome]) -> Outcome | None:
    """Of those that hold the one whose worst period has least work."""
    held = [o for o in outcomes if o.held and o.metric(LOAD) is not None]
    return min(held, key=lambda o: o.metric(LOAD) or 0.0, default=None)


def _answer(outcomes: Sequence[Outcome]) -> str:
    hosts = [o for o in outcomes if not o.on_board]
    # A card is bought too: a core that would do comes before it.
    host = best([o for o in hosts if not o.entry.solver.launch]) or best(hosts)
    boards = [o for o in outcomes if o.on_board]
    board = best(boards)
    who = "GPU" if host and host.entry.solver.launch else "core"
    if host and board:
        faster = (host.metric(LOAD) or 0) < (board.metric(LOAD) or 0)
        first = (
            f"A {who} beats the board"
            if faster
            else f"The board is faster than a {who}, and a {who} would do"
        )
        return f"{first}{_but(host, board)}: {_figures(host)}; {_figures(board)}."
    if host:
        return (
            f"A {who} does what the board does not: {_figures(host)}; {_figures(_least(boards))}."
        )
    if board:
        return f"The board is needed: {_figures(board)}; {_figures(_least(hosts))}."
    return f"Nobody holds every budget; the least work: {_figures(_least(outcomes))}."


def _but(host: Outcome, board: Outcome) -> str:
    """What a faster one is worse at."""
    of_host, of_board = host.metric(FORCE) or 0.0, board.metric(FORCE) or 0.0
    if of_host > of_board:
        return (
            f" in time, with a force that is {of_host / of_board:.2g} times further off"
            if of_board
            else ""
        )
    return ""


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
        text += f"; without figures: {'; '.join(refused)}"
    return text + "."


def _figures(outcome: Outcome) -> str:
    if not outcome.record.done:
        return f"{outcome.name} has no figures ({outcome.record.message})"
    budget = outcome.metric(BUDGET) or 0.0
    error = outcome.metric(FORCE)
    return (
        f"{outcome.name} has its worst force after {_ms(outcome.metric(WORST))} of "
        f"{_ms(budget)}, its worst period's work takes {_ms(outcome.metric(LOAD))}, "
        f"{_force(error)}{_missed(outcome)}{_flags(outcome)}"
    )


def _force(error: float | None) -> str:
    if error is None:
        return "its force was not compared"
    if error == 0:
        return "its force is that of the true model"
    return f"95 % of its forces are within {100 * error:.2g} % of the true model's"


def _missed(outcome: Outcome) -> str:
    most = outcome.metric("miss_high")
    if not outcome.entry.drawn or most is None:
        return ""
    late = outcome.metric("late_probability")
    if late is not None:
        # As the program says it: less is not told from none.
        least = 1e-13
        share = f"{late:.3g}" if late >= least else f"less than {least:.0e}"
        return f", a force is late with a probability of {share}"
    return f", less than {100 * most:.3g} % of all ticks miss (95 %, if they are independent)"


def _flags(outcome: Outcome) -> str:
    flags = outcome.record.flags
    return f", flagged {', '.join(flags)}" if flags else ""


def _ms(microseconds: float | None) -> str:
    return "-" if microseconds is None else f"{microseconds / 1000:.4g} ms"
