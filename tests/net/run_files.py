"""What a run wrote, read as it stands in the files: times as whole picoseconds."""

import csv
import json
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from typing import Any

PARTS = ("host", "bus", "fpga", "daq", "device")


def ps(us: str | float) -> int:
    return round(Decimal(str(us)) * 10**6)


@dataclass(frozen=True)
class Frame:
    number: int
    born: int
    latency: int
    load: int
    deadline: int
    in_time: bool
    contact_node: int
    contact_age: int
    tip: tuple[float, ...]  # m
    force: tuple[float, ...] | None  # N; None where only times were asked for
    saturations: int | None
    flags: int
    parts: dict[str, int]
    status: str


def frame_of(row: dict[str, str]) -> Frame:
    timing_only = row["fx_N"] == ""
    return Frame(
        number=int(row["frame"]),
        born=ps(row["born_us"]),
        latency=ps(row["latency_us"]),
        load=ps(row["load_us"]),
        deadline=ps(row["deadline_us"]),
        in_time=row["in_time"] == "1",
        contact_node=int(row["contact_node"]),
        contact_age=ps(row["contact_age_us"]),
        tip=tuple(float(row[f"{axis}_m"]) for axis in "xyz"),
        force=None if timing_only else tuple(float(row[f"f{axis}_N"]) for axis in "xyz"),
        saturations=None if timing_only else int(row["saturations"]),
        flags=int(row["flags"]),
        parts={part: ps(row[f"{part}_us"]) for part in PARTS},
        status=row["status"],
    )


@dataclass(frozen=True)
class Run:
    """A folder of results, how the program ended and what it said."""

    folder: Path
    status: int
    printed: str
    errors: str

    @cached_property
    def summary(self) -> Any:
        return json.loads(self.text("summary.json"))

    @cached_property
    def trace(self) -> list[dict[str, Any]]:
        """Its events; every number with a point is a time."""
        events: list[dict[str, Any]] = json.loads(self.text("trace.json"), parse_float=ps)[
            "traceEvents"
        ]
        return events

    @cached_property
    def rows(self) -> list[dict[str, str]]:
        """Of frames.csv."""
        return list(csv.DictReader(self.text("frames.csv").splitlines()))

    @cached_property
    def frames(self) -> list[Frame]:
        return [frame_of(row) for row in self.rows]

    @cached_property
    def settings(self) -> dict[str, Any]:
        return tomllib.loads(self.text("scenario.resolved.toml"))

    def text(self, name: str) -> str:
        return (self.folder / name).read_text(encoding="utf-8")
