"""The folder that `hvp run --out` writes, read again."""

import base64
import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from studies.errors import InputError

_SETTINGS = "scenario.resolved.toml"
_TIMES = ("born_us", "latency_us")


@dataclass(frozen=True)
class Span:
    """A slice of a frame: which part did what, µs since the frame's tick."""

    part: str
    phase: str
    from_us: float
    us: float
    critical: bool


@dataclass(frozen=True)
class RunFolder:
    """Results of one run. `summary` and `scenario` are as their files have them."""

    path: Path
    summary: Mapping[str, Any]
    scenario: Mapping[str, Any]
    performance: Mapping[str, Any]

    @property
    def partial(self) -> bool:
        """Whether the run was interrupted."""
        return bool(self.summary.get("partial", False))

    @property
    def flags(self) -> list[str]:
        """What went numerically wrong, by name."""
        stability = self.summary.get("stability") or {}
        return [str(flag) for flag in stability.get("flags", [])]

    @cached_property
    def frames(self) -> pd.DataFrame | None:
        """frames.csv, a row a frame; nothing where somebody has removed it."""
        path = self.path / "frames.csv"
        if not path.exists():
            return None
        try:
            table = pd.read_csv(path)
        except (ValueError, pd.errors.ParserError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: expected the frames of a run: {_one_line(error)}") from error
        for column in _TIMES:
            # Of a run that was interrupted before its first frame there is the heading alone.
            words = column in table and not pd.api.types.is_numeric_dtype(table[column])
            if column not in table or (words and len(table)):
                raise InputError(f"{path}:1: {column}: expected a column of numbers by that name")
        return table

    @property
    def scenario_file(self) -> Path:
        """What a run of the same settings takes."""
        return self.path / _SETTINGS

    @property
    def settings(self) -> str:
        """scenario.resolved.toml as it stands."""
        return self.scenario_file.read_text(encoding="utf-8")

    def spans(self, frame: int) -> list[Span]:
        """A frame's spans by trace.json; none where it was not traced. Throws InputError.

        An event is a line: of many megabytes only the frame's lines are parsed.
        """
        path = self.path / "trace.json"
        spans: list[Span] = []
        if not path.is_file():
            return spans
        sought = (f'"frame":{frame},', f'"frame":{frame}}}')
        try:
            with path.open(encoding="utf-8") as lines:
                for line in lines:
                    if '"ph":"X","pid":1,' not in line or not any(word in line for word in sought):
                        continue
                    event = json.loads(line.rstrip().rstrip(","))
                    critical = bool(event["args"].get("critical"))
                    span = (event["cat"], event["name"], event["ts"], event["dur"], critical)
                    spans.append(Span(*span))
        except (ValueError, KeyError) as error:
            raise InputError(f"{path}: damaged: {_one_line(error)}") from error
        begin = min((span.from_us for span in spans), default=0.0)
        return [
            Span(span.part, span.phase, round(span.from_us - begin, 6), span.us, span.critical)
            for span in sorted(spans, key=lambda span: span.from_us)
        ]

    def picture(self, name: str) -> str:
        """A picture in base64; nothing where there is none."""
        path = self.path / name
        return base64.b64encode(path.read_bytes()).decode("ascii") if path.is_file() else ""


def read_run(path: Path) -> RunFolder:
    """Read a run's folder. Throws InputError for what is none, saying what is missing."""
    if not path.is_dir():
        what = "a file" if path.exists() else "not there"
        raise InputError(f"{path}: {what}; expected a folder that hvp run --out has written")
    if not (path / "summary.json").exists():
        raise InputError(
            f"{path}: no run in it, as summary.json is missing; "
            f"expected a folder that hvp run --out has written"
        )
    summary = _read_json(path / "summary.json")
    if not isinstance(summary.get("deadline"), dict):
        raise InputError(f"{path / 'summary.json'}: deadline: expected the summary of a run")
    performance = path / "performance.json"
    return RunFolder(
        path,
        summary,
        _read_toml(path / _SETTINGS),
        _read_json(performance) if performance.exists() else {},
    )


def _read_json(path: Path) -> dict[str, Any]:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}:{error.lineno}: expected JSON, whole: {_one_line(error)}"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected JSON: {_one_line(error)}") from error
    if not isinstance(value, dict):
        raise InputError(f"{path}:1: expected a JSON object")
    return value


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(
            f"{path}: not there, so that nothing says what was run; hvp run writes it"
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: expected a scenario as hvp run writes it: {_one_line(error)}"
        ) from error


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
