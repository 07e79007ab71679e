"""An axis of a sweep, as it stands on a command line: KEY=a,b,c or KEY=from:to:steps[:log]."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from studies.errors import InputError
from studies.point import Value

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*([A-Za-zµ%][\w/^·*-]*)?")
_RANGE = re.compile(r"(.+?):(.+?):(\d+)(:log)?")
_FORMS = "expected KEY=a,b,c or KEY=from:to:steps or KEY=from:to:steps:log"
_MOST_STEPS = 100_000


@dataclass(frozen=True)
class Axis:
    """A key and the values that it takes, each as `--set` takes it."""

    key: str
    texts: tuple[str, ...]

    @property
    def values(self) -> tuple[Value, ...]:
        """For tables: numbers and truth values as such, all else as text."""
        return tuple(_value(text) for text in self.texts)

    @property
    def unit(self) -> str:
        """The unit that all values have; empty where they have none, or not the same."""
        return places(self.texts)[1]

    @property
    def places(self) -> tuple[float | str, ...]:
        """Where the values stand on a plot's axis: numbers in `unit`, or names."""
        found, _ = places(self.texts)
        return tuple(map(str, self.values) if isinstance(found[0], str) else found)


def as_quantity(text: str) -> tuple[float, str] | None:
    """A number with or without a unit: "2 ms" is (2.0, "ms")."""
    match = _QUANTITY.fullmatch(text.strip().strip("\"'").strip())
    return (float(match[1]), match[2] or "") if match else None


def places(values: Sequence[Value]) -> tuple[list[float | str], str]:
    """Where values stand on a plot's axis, and the axis' unit: numbers where each has the same
    unit, or none; names otherwise."""
    found = [
        None if isinstance(value, bool) or value is None else as_quantity(str(value))
        for value in values
    ]
    known = [quantity for quantity in found if quantity is not None]
    units = {unit for _, unit in known}
    if len(known) == len(found) and len(units) == 1:
        return [number for number, _ in known], units.pop()
    return [str(value) for value in values], ""


def parse_axis(argument: str, whole_numbers: bool = False) -> Axis:
    """An axis from a command line; a range of whole numbers has no value twice.

    Throws InputError.
    """
    key, equals, text = argument.partition("=")
    if not equals or not key.strip():
        raise InputError(f"{argument}: {_FORMS}")
    if match := _RANGE.fullmatch(text.strip()):
        first, last = as_quantity(match[1]), as_quantity(match[2])
        if first and last:
            texts = _range(argument, (first, last), int(match[3]), match[4] is not None)
            if whole_numbers:
                texts = [_whole(text) for text in texts]
            return Axis(key.strip(), tuple(dict.fromkeys(texts)))
    values = _split(argument, text)
    if any(not value for value in values):
        raise InputError(f"{argument}: {_FORMS}; a value is missing")
    return Axis(key.strip(), tuple(values))


def _range(
    argument: str, ends: tuple[tuple[float, str], tuple[float, str]], steps: int, log: bool
) -> list[str]:
    (low, low_unit), (high, high_unit) = ends
    unit = high_unit
    if low_unit not in ("", high_unit):
        raise InputError(f"{argument}: expected one unit, got {low_unit} and {high_unit or 'none'}")
    if not 2 <= steps <= _MOST_STEPS:  # noqa: PLR2004
        raise InputError(f"{argument}: expected 2 to {_MOST_STEPS} steps, got {steps}")
    if log and (low <= 0 or high <= 0):
        raise InputError(f"{argument}: expected positive ends of a logarithmic range")
    numbers = np.geomspace(low, high, steps) if log else np.linspace(low, high, steps)
    return [f"{number:.12g} {unit}".strip() for number in numbers.tolist()]


def _whole(text: str) -> str:
    number, _, unit = text.partition(" ")
    return f"{round(float(number))} {unit}".strip()


def _split(argument: str, text: str) -> list[str]:
    """At the commas that stand outside of strings and brackets."""
    parts, depth, quote = [""], 0, ""
    escaped = False
    for character in text:
        if escaped or (quote == '"' and character == "\\"):
            escaped = not escaped
        elif quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "[{":
            depth += 1
        elif character in "]}":
            depth -= 1
        if character == "," and depth == 0 and not quote:
            parts.append("")
        else:
            parts[-1] += character
    if quote or depth:
        raise InputError(f"{argument}: expected every {quote or 'bracket'} closed")
    return [part.strip() for part in parts]


def _value(text: str) -> Value:
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    return value if isinstance(value, bool | int | float | str) else text
