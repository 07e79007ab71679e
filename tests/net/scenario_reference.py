"""The keys of a scenario as `hvp reference` prints them: what can be written, and where."""

import re
from dataclasses import dataclass, field
from typing import Literal

Kind = Literal["number", "whole", "vector", "choice", "boolean", "text", "file"]
TableKind = Literal["table", "effect", "list"]

UNITS = {
    "time": "s",
    "frequency": "Hz",
    "rate": "1/s",
    "length": "m",
    "mass": "kg",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "force": "N",
    "stiffness": "N/m",
    "damping": "N s/m",
    "moment of inertia": "kg m2",
    "current": "A",
    "voltage": "V",
    "current for a voltage": "A/V",
    "torque for a current": "N m/A",
    "pressure": "Pa",
    "density": "kg/m3",
    "angle": "rad",
    "throughput": "flop/s",
    "bandwidth": "B/s",
    "data size": "B",
    "number": "",
}
PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6}
PREFIXES |= {"G": 1e9, "T": 1e12}
# Units that are no prefix and unit of the table above, or look like one and are not.
OTHER_UNITS = {"min": 60.0, "1/ms": 1e3, "kg": 1.0, "g": 1e-3, "mg": 1e-6, "g/cm3": 1e3}
OTHER_UNITS |= {"kg/m3": 1.0, "deg": 0.017453292519943295}
OTHER_UNITS |= {"KiB": 1024.0, "MiB": 1024.0**2, "GiB": 1024.0**3}

ROW = re.compile(r"\| `(\w+)` \| ([^|]*) \| ([^|]*) \| ((?:[^|]|\\\|)*?) \| (.*)")
QUOTED = re.compile(r'"([^"]*)"')
CONDITION = re.compile(r"only with `([\w.]+)` = ((?:\"[^\"]*\"|\d+|, | or )+): ")
NUMBER = r"(-?[\d.]+(?:e[+-]?\d+)?)((?: (?!to\b|and\b)[^\s,|]+){0,2})"


@dataclass(frozen=True)
class Condition:
    key: str  # in full
    values: tuple[str, ...]  # as TOML


@dataclass(frozen=True)
class Key:
    """A key of a table. Bounds are in SI units; what is not bounded has None."""

    name: str
    kind: Kind
    dimension: str
    low: float | None
    high: float | None
    low_open: bool
    high_open: bool
    choices: tuple[str, ...]
    default: str | None  # as TOML
    condition: Condition | None


@dataclass
class Table:
    path: str  # "host.jitter", "" for the root
    kind: TableKind
    required: bool
    condition: Condition | None
    keys: list[Key] = field(default_factory=list)


def si(number: str, unit: str) -> float:
    """Without what the product of number and prefix is rounded by."""
    return float(f"{exact_si(number, unit):.15g}")


def exact_si(number: str, unit: str) -> float:
    unit = unit.strip()
    if not unit or unit in UNITS.values():
        return float(number)
    if unit in OTHER_UNITS:
        return float(number) * OTHER_UNITS[unit]
    if unit[0] in PREFIXES and unit[1:] in UNITS.values():
        return float(number) * PREFIXES[unit[0]]
    raise ValueError(f"the reference has a unit that is not known here: {unit}")


def condition(text: str, table: str) -> Condition | None:
    found = CONDITION.search(text)
    if found is None:
        return None
    key, values = found.groups()
    full = key if "." in key or not table else f"{table}.{key}"
    return Condition(full, tuple(re.findall(r'"[^"]*"|\d+', values)))


def key_of(table: str, cells: tuple[str, ...]) -> Key:
    name, kind, limits, default, help_text = cells
    dimension = kind.rpartition("each a ")[2]
    known: dict[str, Kind] = {
        "whole number": "whole",
        "one of": "choice",
        "true or false": "boolean",
        "text": "text",
        "file": "file",
    }
    what = known.get(kind, "vector" if kind.startswith("three components") else "number")
    if what in ("number", "vector") and dimension not in UNITS:
        raise ValueError(f"the reference has a type that is not known here: {kind}")
    low = re.search(rf"(from|at least|more than) {NUMBER}", limits)
    high = re.search(rf"(to|at most|less than) {NUMBER}", limits)
    return Key(
        name,
        what,
        dimension,
        si(low[2], low[3]) if low else None,
        si(high[2], high[3]) if high else None,
        bool(low and low[1] == "more than"),
        bool(high and high[1] == "less than"),
        tuple(QUOTED.findall(limits)) if what == "choice" else (),
        default.strip("`").replace("\\|", "|") if default not in ("", "required") else None,
        condition(help_text, table),
    )


def tables_of(reference: str) -> list[Table]:
    """In the order of the page, a table before those in it."""
    tables = [Table("", "table", True, None)]
    for line in reference.partition("\n## Units")[0].splitlines():
        table = tables[-1]
        if line.startswith("## "):
            listed = "`[[" in line
            tables.append(Table(line.strip("# `[]"), "list" if listed else "table", False, None))
        elif (row := ROW.match(line)) is not None:
            table.keys.append(key_of(table.path, row.groups()))
        elif not table.keys and table.path and line and not line.startswith("|"):
            if line.startswith("**Effect**"):
                table.kind = "effect"
            table.required = table.required or "Required. " in line
            where = table.path.rpartition(".")[0]
            table.condition = table.condition or condition(line, where)
    return tables
