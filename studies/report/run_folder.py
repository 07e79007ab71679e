"""What a run has written, as far as a page shows it."""

import base64
import csv
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from studies.errors import InputError


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
    """A folder that `hvp run` has written."""

    path: Path

    @cached_property
    def summary(self) -> dict[str, Any]:
        """summary.json. Throws InputError."""
        path = self.path / "summary.json"
        try:
            summary = json.loads(path.read_text(encoding="utf-8"))
        except (FileNotFoundError, NotADirectoryError):
            raise InputError(
                f"{self.path}: expected a folder that hvp run has written; no summary.json in it"
            ) from None
        except ValueError as error:
            raise InputError(f"{path}: damaged: {error}") from error
        if not isinstance(summary, dict) or "deadline" not in summary:
            raise InputError(f"{path}: expected the summary of a run; no deadline in it")
        return summary

    @cached_property
    def settings(self) -> str:
        """scenario.resolved.toml. Throws InputError."""
        return self._text("scenario.resolved.toml")

    def columns(self, *names: str) -> dict[str, list[str]]:
        """Columns of frames.csv, those that it has. Throws InputError."""
        lines = list(csv.reader(self._text("frames.csv").splitlines()))
        head = lines[0] if lines else []
        at = {name: head.index(name) for name in names if name in head}
        try:
            return {name: [line[column] for line in lines[1:]] for name, column in at.items()}
        except IndexError:
            raise InputError(f"{self.path / 'frames.csv'}: damaged: a line is too short") from None

    def spans(self, frame: int) -> list[Span]:
        """A frame's spans by trace.json; none where it was not traced.

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
            raise InputError(f"{path}: damaged: {error}") from error
        begin = min((span.from_us for span in spans), default=0.0)
        return [
            Span(span.part, span.phase, round(span.from_us - begin, 6), span.us, span.critical)
            for span in sorted(spans, key=lambda span: span.from_us)
        ]

    def picture(self, name: str) -> str:
        """A picture in base64; nothing where there is none."""
        path = self.path / name
        return base64.b64encode(path.read_bytes()).decode("ascii") if path.is_file() else ""

    def _text(self, name: str) -> str:
        path = self.path / name
        try:
            return path.read_text(encoding="utf-8")
        except FileNotFoundError:
            raise InputError(f"{path}: expected a file of a run; there is none") from None
        except ValueError as error:
            raise InputError(f"{path}: damaged: {error}") from error
