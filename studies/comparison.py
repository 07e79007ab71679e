"""What differs between runs: their settings, figures, flags and worst frames."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from studies.frame_comparison import FrameDifferences, compare_frames
from studies.point import Value
from studies.run_folder import RunFolder

# What tells the entries of a list apart, by what the results reference calls them.
_NAMES = ("part", "phase", "transaction", "initiator", "type", "kind")
# How often something took how long. Two of them differ wherever anything does.
_DISTRIBUTIONS = ("histogram", "octaves")
# Have tables of their own, or say who ran and not what came of it.
_TOLD_ELSEWHERE = ("title", "attribution", "effects", "verdict", "partial", "stability.flags")


@dataclass(frozen=True)
class Row:
    """A setting or a figure, with the value it has in each run; None where it has none.

    `changes` are relative to the first run, None where that says nothing: of words, of a frame's
    number, of a change from zero.
    """

    key: str
    unit: str
    values: tuple[Value, ...]
    changes: tuple[float | None, ...]

    @property
    def differs(self) -> bool:
        return any(value != self.values[0] for value in self.values[1:])

    @property
    def breakdown(self) -> bool:
        """Detail behind another figure, such as one phase of all frames or one more percentile."""
        entry = "[" in self.key and not self.key.startswith(("loop[", "forces[", "resources["))
        return entry or self.key.startswith("latency.percentiles.")


@dataclass(frozen=True)
class Names:
    """Flags or effects: those of all runs, and which run has which, in the runs' order."""

    every: tuple[str, ...]
    of_run: tuple[tuple[str, ...], ...]

    @property
    def differs(self) -> bool:
        return any(set(names) != set(self.of_run[0]) for names in self.of_run)


@dataclass(frozen=True)
class Comparison:
    """Of two runs or more; the first is what the others are held against."""

    runs: tuple[RunFolder, ...]
    settings: tuple[Row, ...]
    figures: tuple[Row, ...]
    attribution: tuple[Row, ...]  # µs of the worst frame's critical path
    flags: Names
    effects: Names
    performance: tuple[Row, ...]  # of the machines they ran on
    frames: tuple[FrameDifferences, ...]  # one a run after the first

    @property
    def same(self) -> bool:
        """Whether everything but the host's own time is equal."""
        verdicts = {str(run.summary.get("verdict")) + str(run.partial) for run in self.runs}
        return (
            len(verdicts) == 1
            and not any(row.differs for row in self.settings + self.figures + self.attribution)
            and not self.flags.differs
            and not self.effects.differs
            and not any(frames.differ for frames in self.frames)
        )


def compare(runs: Sequence[RunFolder], units: Callable[[str], str] = lambda _: "") -> Comparison:
    """Hold runs against the first of them. `units` names the unit of a figure of summary.json."""
    return Comparison(
        tuple(runs),
        _rows([_leave_out(_scalars(run.scenario, keep_lists=True), "title") for run in runs]),
        _rows([_leave_out(_scalars(run.summary), *_TOLD_ELSEWHERE) for run in runs], units),
        _rows([_attribution(run) for run in runs], lambda _: "µs"),
        _names([run.flags for run in runs]),
        _names([[str(effect) for effect in run.summary.get("effects", [])] for run in runs]),
        _rows([_leave_out(_scalars(run.performance), "simulated_s") for run in runs]),
        tuple(compare_frames(runs[0], run) for run in runs[1:]),
    )


def _rows(
    each: Sequence[Mapping[str, Value]], units: Callable[[str], str] = lambda _: ""
) -> tuple[Row, ...]:
    """A row a key, in the order of the first run that has it."""
    keys: dict[str, None] = {}
    for values in each:
        keys |= dict.fromkeys(values)
    rows = []
    for key in keys:
        of_key = tuple(values.get(key) for values in each)
        changes = tuple(_change(key, of_key[0], value) for value in of_key)
        rows.append(Row(key, units(key), of_key, changes))
    return tuple(rows)


def _change(key: str, base: Value, value: Value) -> float | None:
    if isinstance(base, bool) or isinstance(value, bool) or key.endswith(("frame", "_node")):
        return None
    if not isinstance(base, int | float) or not isinstance(value, int | float) or base == 0:
        return None
    return (value - base) / abs(base)


def _scalars(value: Any, path: str = "", *, keep_lists: bool = False) -> dict[str, Value]:
    """Every value by its dotted key; entries of a list by what names them, or else by number."""
    flat: dict[str, Value] = {}
    if isinstance(value, Mapping):
        for key, item in value.items():
            if keep_lists or key not in _DISTRIBUTIONS:
                inner = f"{path}.{key}" if path else str(key)
                flat |= _scalars(item, inner, keep_lists=keep_lists)
        return flat
    if isinstance(value, list):
        if value and all(isinstance(item, Mapping) for item in value):
            for number, item in enumerate(value):
                name = str(number) if keep_lists else _name(item, number)
                flat |= {
                    key: inner
                    for key, inner in _scalars(
                        item, f"{path}[{name}]", keep_lists=keep_lists
                    ).items()
                    if keep_lists or key.rpartition(".")[2] not in _NAMES
                }
            return flat
        return {path: "[" + ", ".join(map(str, value)) + "]"}
    return {path: value}


def _name(item: Mapping[str, Any], number: int) -> str:
    words = [str(item[key]) for key in _NAMES if key in item]
    return " ".join(words) or str(number)


def _leave_out(values: Mapping[str, Value], *names: str) -> dict[str, Value]:
    return {
        key: value
        for key, value in values.items()
        if not any(key == name or key.startswith((f"{name}.", f"{name}[")) for name in names)
    }


def _attribution(run: RunFolder) -> dict[str, Value]:
    """Time of the worst frame by part and phase, µs; what took none is left out."""
    took: dict[str, Value] = {}
    for entry in run.summary.get("attribution") or []:
        if entry["us"]:
            took[f"{entry['part']} {entry['phase']}"] = entry["us"]
    return took


def _names(each: Sequence[Sequence[str]]) -> Names:
    every: dict[str, None] = {}
    for names in each:
        every |= dict.fromkeys(names)
    return Names(tuple(every), tuple(map(tuple, each)))
