"""Runs clang-tidy over the project's own sources and remembers what it found clean.

A source is analysed again when its compile command, its checks, clang-tidy, or any file it
includes has changed. Nothing is compiled: the build is one that was configured with a source at a
time and without precompiled headers, so that a header which misses an include is found here.

From nothing that would be most of an hour, for sources that nobody has touched. So, without --all,
of those that were never found clean here these are analysed: what the last commits changed, and a
share of the rest that the commit's own name chooses, another one with every commit.
"""

import argparse
import hashlib
import json
import math
import os
import re
import shlex
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import cache
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
TIDY = "clang-tidy-14"
SCAN = "clang-scan-deps-14"


@dataclass(frozen=True)
class Source:
    path: Path
    command: str
    includes: tuple[Path, ...] | None  # None: it could not be scanned


@dataclass(frozen=True)
class Finding:
    source: Source
    key: str | None
    clean: bool
    output: str


def scanned_includes(folder: Path, jobs: int) -> dict[str, list[Path]]:
    """Files that each object is made from, by its path, as clang-scan-deps reads them."""
    command = [SCAN, "-compilation-database", str(folder / "compile_commands.json")]
    command += ["-format=make", "-j", str(jobs)]
    # Sources that a build generates are not there and are said so; the others are scanned.
    rules = subprocess.run(command, check=False, capture_output=True, text=True).stdout
    includes: dict[str, list[Path]] = {}
    for rule in rules.replace("\\\n", " ").splitlines():
        target, _, files = rule.partition(": ")
        if files:
            includes[target.strip()] = [Path(name) for name in shlex.split(files)]
    return includes


# The compiler's cache is no part of what a source is compiled with.
LAUNCHER = re.compile(r"^env \S+ \S*ccache ")


def write_commands(build: Path) -> Path:
    """The folder of a compile_commands.json for clang's tools."""
    folder = build / "tidy"
    folder.mkdir(exist_ok=True)
    commands = json.loads((build / "compile_commands.json").read_text())
    for entry in commands:
        entry["command"] = LAUNCHER.sub("", entry["command"])
    (folder / "compile_commands.json").write_text(json.dumps(commands, indent=1))
    return folder


def own_sources(build: Path, commands: Path, jobs: int) -> list[Source]:
    """Sources of the checkout that the build compiles, without generated ones."""
    includes = scanned_includes(commands, jobs)
    sources = {}
    for entry in json.loads((commands / "compile_commands.json").read_text()):
        path = Path(entry["file"]).resolve()
        if TOP not in path.parents or build in path.parents:
            continue
        words = shlex.split(entry["command"])
        files = includes.get(words[words.index("-o") + 1])
        sources[path] = Source(path, entry["command"], None if files is None else tuple(files))
    return [sources[path] for path in sorted(sources)]


@cache
def fingerprint(path: Path) -> str:
    """Content of a file of the checkout; size and time of one that a package installed."""
    resolved = path.resolve()
    if TOP in resolved.parents:
        content = hashlib.sha256(resolved.read_bytes()).hexdigest()
        return f"{resolved.relative_to(TOP)} {content}"
    status = resolved.stat()
    return f"{resolved} {status.st_size} {status.st_mtime_ns}"


@cache
def checks(directory: Path) -> str:
    """The configuration in force for a directory, and the version that reads it."""
    probe = directory / "any.cpp"
    command = [TIDY, "--dump-config", str(probe), "--"]
    config = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    version = subprocess.run([TIDY, "--version"], check=True, capture_output=True, text=True).stdout
    return version + config


def key_of(source: Source, build: Path) -> str | None:
    if source.includes is None or not all(path.exists() for path in source.includes):
        return None
    command = source.command.replace(str(build), "BUILD").replace(str(TOP), "TOP")
    parts = [command, checks(source.path.parent)]
    parts += sorted({fingerprint(path) for path in source.includes})
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


# Of what the last commits changed, the newest first: a source takes two cores some ten seconds.
RECENT_COMMITS = 100
RECENT_SOURCES = 16
SHARES = 60


def git(*arguments: str) -> list[str]:
    """Lines that git prints; none outside a clone."""
    run = subprocess.run(
        ["git", "-C", str(TOP), *arguments], check=False, capture_output=True, text=True
    )
    return run.stdout.splitlines() if run.returncode == 0 else []


def chosen(due: list[tuple[Source, str | None]]) -> list[tuple[Source, str | None]]:
    """Of the sources without a stamp, those whose turn it is."""
    newest: dict[Path, int] = {}
    for line in git("log", f"-{RECENT_COMMITS}", "--format=", "--name-only"):
        newest.setdefault(TOP / line, len(newest))

    def age(source: Source) -> int:
        paths = (source.path, source.path.with_suffix(".h"))
        return min(newest.get(path, len(newest)) for path in paths)

    changed = sorted((age(source), source.path) for source, _ in due if age(source) < len(newest))
    recent = {path for _, path in changed[:RECENT_SOURCES]}
    commit = "".join(git("rev-parse", "HEAD"))

    def has_its_turn(source: Source) -> bool:
        name = hashlib.sha256(str(source.path.relative_to(TOP)).encode()).hexdigest()
        return int(name, 16) % SHARES == int(commit or "0", 16) % SHARES

    return [entry for entry in due if entry[0].path in recent or has_its_turn(entry[0])]


def analyse(source: Source, key: str | None, commands: Path) -> Finding:
    run = subprocess.run(
        [TIDY, "--quiet", "-p", str(commands), str(source.path)],
        check=False,
        capture_output=True,
        text=True,
    )
    noise = ("warnings generated.", "warning generated.", "Suppressed ", "Use -header-filter")
    errors = [line for line in run.stderr.splitlines() if not any(word in line for word in noise)]
    return Finding(source, key, run.returncode == 0, "\n".join([run.stdout.strip(), *errors]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--build", type=Path, required=True, help="a build that is configured for clang"
    )
    parser.add_argument("--stamps", type=Path, required=True, help="where clean sources are noted")
    parser.add_argument("--all", action="store_true", help="every source that has no stamp")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument(
        "--seconds", type=float, help="begin no further source after that; the next run does"
    )
    arguments = parser.parse_args()
    build: Path = arguments.build.resolve()
    stamps: Path = arguments.stamps
    stamps.mkdir(parents=True, exist_ok=True)

    commands = write_commands(build)
    sources = own_sources(build, commands, arguments.jobs)
    if not sources:
        print(f"no source of {TOP} is built in {build}")
        return 1
    for source in sources:
        if source.includes is None:
            print(f"left out: {source.path.relative_to(TOP)}: it includes what a build generates")
    sources = [source for source in sources if source.includes is not None]
    keys = [key_of(source, build) for source in sources]
    due = [
        (source, key)
        for source, key in zip(sources, keys, strict=True)
        if key is None or not (stamps / key).exists()
    ]
    without_stamp = len(due)
    if not arguments.all:
        due = chosen(due)
    failures = 0
    analysed = 0
    ends = time.monotonic() + arguments.seconds if arguments.seconds is not None else math.inf

    def in_time(source: Source, key: str | None) -> Finding | None:
        return analyse(source, key, commands) if time.monotonic() < ends else None

    with ThreadPoolExecutor(arguments.jobs) as pool:
        pending = [pool.submit(in_time, source, key) for source, key in due]
        for count, future in enumerate(as_completed(pending), 1):
            finding = future.result()
            if finding is None:
                continue
            analysed += 1
            print(f"[{count}/{len(due)}] {finding.source.path.relative_to(TOP)}", flush=True)
            if not finding.clean:
                failures += 1
                print(finding.output, flush=True)
            elif finding.key:
                (stamps / finding.key).touch()
    if analysed < len(due):
        print(f"left out: tidy: {len(due) - analysed} sources of this run's, for want of time")
    clean = len(sources) - without_stamp
    print(
        f"{len(sources)} sources, {clean} known to be clean, {analysed} analysed, "
        f"{without_stamp - analysed} left to another commit, {failures} with findings"
    )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
