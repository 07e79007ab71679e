"""The program hvp as a study sees it: its version, its figures, what a scenario resolves to."""

import hashlib
import json
import os
import subprocess
from collections.abc import Sequence
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
        table = {"run": "figures", "device": "device_figures", "stability": "stability_figures"}
        return {
            item["key"]: Figure(item["key"], item.get("unit", ""), item.get("help", ""))
            for item in self.reference[table[command]]
        }

    def resolve(
        self, scenario: Path, each: Sequence[Sequence[str]], includes: Sequence[Path] = ()
    ) -> list[Resolved | Refused]:
        """The scenario under each list of overrides. Throws InputError for the file itself."""
        lines = "".join(json.dumps(list(overrides)) + "\n" for overrides in each)
        command = [str(self.path), "resolve", str(scenario), "--each"]
        for include in includes:
            command += ["--include", str(include)]
        done = subprocess.run(command, input=lines, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise _failure(done)
        results: list[Resolved | Refused] = []
        for line in done.stdout.splitlines():
            answer = json.loads(line)
            if "error" in answer:
                results.append(Refused(answer["error"]))
            else:
                files = tuple(Path(file["path"]) for file in answer["files"])
                results.append(Resolved(answer["scenario"], files))
        return results

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
            raise _failure(done)
        return done.stdout


def find_program() -> Program:
    """The program that `./hvp` has built, by HVP_PROGRAM. Throws StudyError."""
    name = os.environ.get("HVP_PROGRAM", "")
    if not name or not Path(name).is_file():
        raise StudyError(f"HVP_PROGRAM is '{name}', no program; run ./hvp study …, which sets it")
    return Program(Path(name).resolve())


def _failure(done: subprocess.CompletedProcess[str]) -> Exception:
    lines = done.stderr.strip().splitlines()
    line = lines[-1] if lines else f"hvp ended with status {done.returncode}"
    return InputError(line) if done.returncode == 2 else StudyError(line.removeprefix("hvp: "))  # noqa: PLR2004


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
