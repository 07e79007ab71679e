"""Holds docs/results-reference.md against the summary.json that the scenarios write: a report()
that leaves a figure out by a condition of its own would hide it from the page, and a figure that no
scenario has is one that nothing tests.

Runs every scenario, and those of EXTRA for what no scenario has.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

TOP = Path(__file__).resolve().parents[2]
PAGE = TOP / "docs" / "results-reference.md"
# By the scenario that they are of.
EXTRA_OF = {
    "beyond the edge": ("wall.toml", ["wall.stiffness=1100 N/m"]),
    "a virtual tool": ("wall.toml", ["host.virtual_coupling.stiffness=3000 N/m", "frames=2"]),
}
EXTRA = {
    "spectrum": ["spectrum=true", "solver.matrix_scaling=diagonal", "frames=2"],
    "several devices": ["accelerator.several.devices=2", "frames=2"],
    "budgets of accuracy": [
        "budget.displacement_error=1",
        "budget.force_error=1",
        "frames=2",
    ],
}
# Whose remedy is looked for: a search takes several runs, and the figures of one are those of all.
REMEDIED = ("thesis-static", "beyond the edge")
BROKEN_BUDGET = 1  # the exit status of a run that did not hold a budget


def keys_of(value: Any, path: str = "") -> Iterator[str]:
    """The paths of what is neither a table nor a list of tables."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield from keys_of(below, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(entry, dict) for entry in value):
        for entry in value:
            yield from keys_of(entry, f"{path}[]")
    else:
        yield path


def documented_keys() -> list[str]:
    """Those of figures: `a.*` and `a[].*` are what the page says of whole tables."""
    section = PAGE.read_text(encoding="utf-8").split("\n## ")[1]
    keys = re.findall(r"^\| `([^`]+)`", section, re.MULTILINE)
    return [key for key in keys if not key.endswith(".*")]


def matches(documented: str, key: str) -> bool:
    pattern = re.sub(r"<\w+>", r"\\w+", re.escape(documented).replace(r"\<", "<"))
    return re.fullmatch(pattern, key) is not None


def is_table(key: str, documented: list[str]) -> bool:
    """Null or empty here, and something else: documented by what is in it."""
    return any(other.startswith((f"{key}.", f"{key}[]")) for other in documented)


def run(program: Path, scenario: Path, folder: Path, settings: list[str]) -> set[str]:
    command = [str(program), "run", str(scenario), "--quiet", "--out", str(folder)]
    for setting in ["output.pictures=false", *settings]:
        command += ["--set", setting]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode > BROKEN_BUDGET:
        raise RuntimeError(f"{scenario.name} {settings}: {ended.stderr.strip()}")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return set(keys_of(summary))


def run_all(program: Path, scratch: Path) -> dict[str, set[str]]:
    scenarios = {path.stem: (path, list[str]()) for path in sorted(TOP.glob("scenarios/*.toml"))}
    static = TOP / "scenarios" / "thesis-static.toml"
    scenarios |= {name: (static, settings) for name, settings in EXTRA.items()}
    for name, (file, settings) in EXTRA_OF.items():
        scenarios[name] = (TOP / "scenarios" / file, settings)
    for name, (_, settings) in scenarios.items():
        if name not in REMEDIED:
            settings.append("output.remedies=false")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = {
            name: pool.submit(run, program, path, scratch / name, settings)
            for name, (path, settings) in scenarios.items()
        }
        return {name: future.result() for name, future in runs.items()}


def main() -> int:
    parser = argparse.ArgumentParser(
        description="hold docs/results-reference.md against summary.json"
    )
    parser.add_argument("--program", type=Path, required=True)
    program = parser.parse_args().program.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        written = run_all(program, Path(scratch))

    documented = documented_keys()
    problems = [f"{key} stands twice" for key in documented if documented.count(key) > 1]
    where = {key: name for name, keys in written.items() for key in keys}
    for key, name in sorted(where.items()):
        if not is_table(key, documented) and not any(matches(d, key) for d in documented):
            problems.append(f"summary.json of {name} has {key}, the page has not")
    for key in documented:
        if not any(matches(key, found) for found in where):
            problems.append(f"the page has {key}, the summary.json of no scenario has")

    for problem in problems:
        print(f"{PAGE.relative_to(TOP)}: {problem}")
    print(f"{len(where)} keys of {len(written)} runs, {len(documented)} on the page")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
