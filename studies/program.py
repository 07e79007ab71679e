"""The program hvp as a study sees it: its version, its figures, what a scenario resolves to."""

import hashlib
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from studies.errors import InputError, StudyError


@dataclass(frozen=True)
class Figure:
    """A figure that a result file has: its dotted name, unit and meaning."""

    name: str
    unit: str
    help: str


@dataclass(frozen=True)
class Resolved:
    """A scenario with every key that it has, and the files that it names."""

    text: str
    files: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Refused:
    """The line with which hvp refuses a scenario."""

    message: str


@dataclass(frozen=True)
class Program:
    """An executable hvp."""

    path: Path

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the executable: two builds that may differ are two programs."""
        return _sha256(self.path)

    @cached_property
    def version(self) -> str:
        """As `hvp --version` says it."""
        return self._output("--version").strip()

    @cached_property
    def reference(self) -> dict[str, Any]:
        """What `hvp reference --json` declares: keys, effects, figures, flags (docs/json.md)."""
        reference: dict[str, Any] = json.loads(self._output("reference", "--json"))
        return reference

    def figures(self, command: str = "run") -> dict[str, Figure]:
        """The declared figures of a command's JSON by their names."""
        table = {
            "run": "figures",
            "device": "device_figures",
            "stability": "stability_figures",
            "misses": "miss_figures",
        }
        return {
            item["key"]: Figure(item["key"], item.get("unit", ""), item.get("help", ""))
            for item in self.reference[table[command]]
        }

    def resolve(
        self, scenario: Path, each: Sequence[Sequence[str]], includes: Sequence[Path] = ()
    ) -> Iterator[Resolved | Refused]:
        """The scenario under each list of overrides, as they come: ten thousand of them are more
        than is kept of their runs. Throws InputError for the file itself."""
        command = [str(self.path), "resolve", str(scenario), "--each"]
        for include in includes:
            command += ["--include", str(include)]
        with tempfile.TemporaryFile("w+") as lines, tempfile.TemporaryFile("w+") as errors:
            lines.writelines(json.dumps(list(overrides)) + "\n" for overrides in each)
            lines.seek(0)
            with subprocess.Popen(
                command, stdin=lines, stdout=subprocess.PIPE, stderr=errors, text=True
            ) as process:
                assert process.stdout is not None
                yield from map(_resolved, process.stdout)
            if process.returncode != 0:
                errors.seek(0)
                raise _failure(process.returncode, errors.read())

    def address(self, resolved: Resolved, *what: str) -> str:
        """Where a run's record is stored: what it depends on, hashed."""
        state = hashlib.sha256()
        for part in (self.fingerprint, resolved.text, *map(_sha256, resolved.files), *what):
            data = part.encode()
            state.update(f"{len(data)}\n".encode() + data)
        return state.hexdigest()

    def _output(self, *arguments: str) -> str:
        done = subprocess.run(
            [str(self.path), *arguments], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            raise _failure(done.returncode, done.stderr)
        return done.stdout


def find_program() -> Program:
    """The program that `./hvp` has built, by HVP_PROGRAM. Throws StudyError."""
    name = os.environ.get("HVP_PROGRAM", "")
    if not name or not Path(name).is_file():
        raise StudyError(f"HVP_PROGRAM is '{name}', no program; run ./hvp study …, which sets it")
    return Program(Path(name).resolve())


def _resolved(line: str) -> Resolved | Refused:
    answer = json.loads(line)
    if "error" in answer:
        return Refused(answer["error"])
    return Resolved(answer["scenario"], tuple(Path(file["path"]) for file in answer["files"]))


def _failure(status: int, error: str) -> Exception:
    lines = error.strip().splitlines()
    line = lines[-1] if lines else f"hvp ended with status {status}"
    return InputError(line) if status == 2 else StudyError(line.removeprefix("hvp: "))  # noqa: PLR2004


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
