"""Runs the commands that the documents show and follows the links between them.

Every ```sh block of README.md, CONTRIBUTING.md and docs/*.md is run by bash, block after block,
in one scratch directory a document, where the checkout's files are at hand; documents run side by
side. A block must exit 0 unless the line before it says otherwise:

    <!-- exit 2 -->                 it shows an error and exits with that status
    <!-- not run: takes an hour --> it is only read, for the reason given
    <!-- in the step linux: takes a kernel --> it is run with --step linux, as all blocks are of
                                    a document that has such a one; else it is only read, and with
                                    --without linux so is the whole document
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
LONGEST_BLOCK_S = 900
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)[^)]*\)")
EXIT = re.compile(r"<!-- exit (\d+) -->")
NOT_RUN = re.compile(r"<!-- not run: .+ -->")
IN_STEP = re.compile(r"<!-- in the step (\w+): .+ -->")


@dataclass(frozen=True)
class Block:
    line: int
    script: str
    status: int | None  # None: not run
    step: str  # the one that it is run in; empty: in any


def documents() -> list[Path]:
    named = [TOP / "README.md", TOP / "CONTRIBUTING.md"]
    return [path for path in named if path.exists()] + sorted((TOP / "docs").rglob("*.md"))


def expected_status(marker: str) -> int | None:
    if NOT_RUN.fullmatch(marker):
        return None
    match = EXIT.fullmatch(marker)
    return int(match.group(1)) if match else 0


def shell_blocks(text: str) -> Iterator[Block]:
    marker = ""
    language: str | None = None  # of the block that is open
    start, script = 0, [""]
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if language is None:
            if stripped.startswith("```"):
                language, start, script = stripped[3:].strip(), number, []
            elif stripped:
                marker = stripped
        elif stripped == "```":
            if language == "sh":
                in_step = IN_STEP.fullmatch(marker)
                yield Block(
                    start,
                    "\n".join(script) + "\n",
                    expected_status(marker),
                    in_step.group(1) if in_step else "",
                )
            language, marker = None, ""
        else:
            script.append(line)


def prose(text: str) -> str:
    """The text without its fenced blocks and code spans."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"```.*?```", "", text, flags=re.DOTALL))


def broken_links(document: Path) -> Iterator[str]:
    for match in LINK.finditer(prose(document.read_text())):
        target = match.group(1).partition("#")[0]
        if not target or re.match(r"[a-z]+:", target):
            continue
        if not (document.parent / target).exists():
            yield match.group(1)


def lay_out(scratch: Path, build: Path) -> None:
    """The checkout as the reader has it, with results landing in the scratch directory."""
    for entry in TOP.iterdir():
        if entry.name not in {".git", "build", "runs"}:
            (scratch / entry.name).symlink_to(entry)
    (scratch / "build").symlink_to(build)


def run_block(block: Block, directory: Path) -> str | None:
    """What went wrong, if anything did."""
    try:
        run = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block.script],
            check=False,
            cwd=directory,
            env=os.environ | {"PWD": str(directory)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=LONGEST_BLOCK_S,
        )
    except subprocess.TimeoutExpired:
        return f"still running after {LONGEST_BLOCK_S} s\n{block.script}"
    if run.returncode == block.status:
        return None
    return f"exit {run.returncode}, expected {block.status}\n{block.script}{run.stdout}"


def has_block_of(step: str, document: Path) -> bool:
    return any(block.step == step for block in shell_blocks(document.read_text()))


def check(build: Path, step: str, without: list[str], document: Path) -> int:
    """The number of faults; what is printed of a document stands together."""
    failures = 0
    lines: list[str] = []
    name = document.relative_to(TOP)
    for link in broken_links(document):
        failures += 1
        lines.append(f"{name}: the link to {link} leads nowhere")
    with tempfile.TemporaryDirectory(prefix="hvp-documents-") as scratch:
        directory = Path(scratch)
        lay_out(directory, build)
        runs = not any(has_block_of(other, document) for other in without)
        for block in shell_blocks(document.read_text()) if runs else []:
            if block.status is None or block.step not in ("", step):
                continue
            started = time.monotonic()
            fault = run_block(block, directory)
            lines.append(f"{name}:{block.line}: {time.monotonic() - started:.1f} s")
            if fault:
                failures += 1
                lines.append(fault)
    print("\n".join(lines), flush=True)
    return failures


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help="stands in for build/")
    parser.add_argument("document", type=Path, nargs="*", help="default: all of them")
    parser.add_argument("--step", default="", help="documents with blocks of this step alone")
    parser.add_argument(
        "--without",
        action="append",
        default=[],
        metavar="STEP",
        help="of documents with blocks of this step only links, as the step runs them",
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="documents at once")
    arguments = parser.parse_args()
    chosen = [path.resolve() for path in arguments.document] or documents()
    step = arguments.step
    if step:
        chosen = [path for path in chosen if has_block_of(step, path)]
        if not chosen:
            parser.error(f"--step {step}: no document has a block of that step")
    # The longest pages first, so that none of them is left for the end.
    chosen.sort(key=lambda path: -path.stat().st_size)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        work = partial(check, arguments.build.resolve(), step, arguments.without)
        failures = sum(pool.map(work, chosen))
    print(f"{len(chosen)} documents, {failures} faults")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
