"""What the tests of the RTL engine come to in it: its lines, and what can happen at a clock.

    python tests/rtl/covered.py --build build/release

Translates the engine once more, in the sizes of the build, so that it counts how often each block
and each branch of its SystemVerilog is run (verilator --coverage-line), and what
coverage/observed.sv names; then runs the tests of whole engines. A block counts once, however many
sizes and copies of it there are. Exit status 1 where fewer than 95 % of them are run, where one
that is not has no reason in unreached.toml, where something that can happen has not, or where
fewer than 95 % of the combinations of pass, wait and queue have been seen.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import threading
import tomllib
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from rtl_sizes import nodes_of
from translation import (
    ENGINE,
    NotBuiltError,
    Translation,
    Variant,
    build_program,
    engine_sources,
    translations,
)
from waiting_rows import Queue, can_wait

HERE = Path(__file__).resolve().parent
OBSERVED = HERE / "coverage/observed.sv"
REASONS = HERE / "unreached.toml"
WANTED = 0.95
# accel::DirectionMemory, with two accesses a clock.
STALL = 2
# engine_types.sv, state_t and pass_t.
STATES = [
    "idle",
    "copy",
    "guess",
    "start_product",
    "start_residual",
    "first_direction",
    "product",
    "alpha",
    "update",
    "anew_product",
    "anew_residual",
    "beta",
    "direction",
]
PASSES = [
    "none",
    "copy",
    "guess",
    "product",
    "residual",
    "first_direction",
    "update",
    "direction",
]
PRODUCT = PASSES.index("product")
# A package, where there is one.
WAITS = ["runs", "waits for a turn", "waits for room"]
# What has to have happened, with each of its numbers.
NEEDED = {
    # Not in a copy of x, which the program runs to its end at once.
    "abort in state": range(STATES.index("guess"), len(STATES)),
    "abort of the inverse": (0,),
    "copy of x": (0,),
    "edit that restores": (0, 1),
    "edit with a preconditioner": (0, 1),
    "end by the stop test": (0, 1),
    "end on hold": (0, 1),
    "end with a breakdown": (0, 1),
    "end with residuals formed anew": (0, 1),
    "end with words clamped": (0, 1),
    "extrapolated with a solution before": (0, 1),
    "dynamic scaling": (0, 1),
    "inverse of all nodes": (1,),
    "iteration": (0,),
    "product of an empty partition": (0,),
    "rounding of divisions": (0, 1, 2),
    "rounding of shifts": (0, 1, 2),
    "scaling step": (1, 2, 3),
    "solve of nodes, 3 or more": (0, 1, 2, 3),
    "solve with a preconditioner": (0, 1),
    "start from zero": (0, 1),
}


@dataclass(frozen=True)
class Block:
    """A place that Verilator counts."""

    file: str
    line: int
    kind: str  # block, if, else, case …
    column: int


def read_lines(path: Path, counts: Counter[Block]) -> None:
    """Adds the counts of a file that Verilator wrote; control characters part keys and values."""
    for record in path.read_text().splitlines():
        if not record.startswith("C '"):
            continue
        keys, _, count = record[3:].rpartition("' ")
        fields = dict(part.split("\x02", 1) for part in keys.split("\x01") if "\x02" in part)
        file = Path(fields["f"])
        if file.parent == ENGINE:
            block = Block(file.name, int(fields["l"]), fields["o"], int(fields["n"]))
            counts[block] += int(count)


@dataclass
class Seen:
    """What runs have come to."""

    blocks: Counter[Block]
    events: Counter[tuple[str, int]]
    # By pass, for what a package waits, rows that wait, how many have room, and whether the size
    # has packages that take turns.
    partitions: Counter[tuple[int, int, int, int, int]]

    def read(self, lines: Path, counts: Path) -> None:
        read_lines(lines, self.blocks)
        for row in counts.read_text().splitlines():
            kind, *rest = row.split("\t")
            if kind == "event":
                self.events[(rest[0], int(rest[1]))] += int(rest[2])
            else:
                of_pass, waits, rows, depth, turns, count = map(int, rest)
                self.partitions[(of_pass, waits, rows, depth, turns)] += count


def tests_of(program: Path, wanted: str) -> list[str]:
    """Each in a process of its own, since SystemC elaborates once in one."""
    listed = subprocess.run(
        [str(program), "--gtest_list_tests", f"--gtest_filter={wanted}"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    tests, suite = [], ""
    for line in listed.splitlines():
        if line.startswith("  "):
            tests.append(suite + line.split("#")[0].strip())
        elif line.endswith(".") or ". " in line:
            suite = line.split("#")[0].strip()
    return tests


class FailedError(Exception):
    """A test of the program fails."""


def run(program: Path, folder: Path, wanted: str) -> Seen:
    seen = Seen(Counter(), Counter(), Counter())

    def count(test: str) -> None:
        with tempfile.TemporaryDirectory(dir=folder) as place:
            lines, counts = Path(place) / "lines.dat", Path(place) / "counts.txt"
            done = subprocess.run(
                [str(program), f"--gtest_filter={test}"],
                check=False,
                capture_output=True,
                text=True,
                env={**os.environ, "HVP_LINES": str(lines), "HVP_COUNTS": str(counts)},
            )
            if done.returncode != 0:
                raise FailedError(f"{test} fails:\n{done.stdout[-2000:]}")
            with adds:
                seen.read(lines, counts)
                print(f"ran {test}", flush=True)

    adds = threading.Lock()
    with ThreadPoolExecutor(int(os.environ.get("HVP_JOBS", os.cpu_count() or 1))) as pool:
        try:
            for _ in pool.map(count, tests_of(program, wanted)):
                pass
        except FailedError:
            pool.shutdown(cancel_futures=True)
            raise
    return seen


def report_blocks(blocks: Counter[Block]) -> bool:
    """Whether enough are run, and each that is not has its reason."""
    reasons = tomllib.loads(REASONS.read_text())["unreached"] if REASONS.exists() else []
    texts = {path.name: path.read_text().splitlines() for path in ENGINE.glob("*.sv")}
    run_ones = sum(count > 0 for count in blocks.values())
    unexplained = 0
    for block in sorted((b for b in blocks if blocks[b] == 0), key=lambda b: (b.file, b.line)):
        text = texts[block.file][block.line - 1].strip()
        reason = next(
            (
                entry["reason"]
                for entry in reasons
                if (entry["file"], entry["line"], entry["kind"]) == (block.file, text, block.kind)
            ),
            None,
        )
        unexplained += reason is None
        print(f"not run: {block.file}:{block.line}: {block.kind} of `{text}`")
        print(f"    {reason or 'WITHOUT A REASON'}")
    for file in sorted({block.file for block in blocks}):
        there = [count for block, count in blocks.items() if block.file == file]
        print(f"{file:26} {sum(c > 0 for c in there):4} of {len(there):4} blocks and branches run")
    share = run_ones / max(len(blocks), 1)
    print(
        f"{run_ones} of {len(blocks)} blocks and branches run, {100 * share:.1f} %; "
        f"{unexplained} of the others without a reason"
    )
    return share >= WANTED and unexplained == 0


def report_events(events: Counter[tuple[str, int]]) -> bool:
    """Whether all that can happen has."""
    missing = []
    for what, number in sorted(
        {*events, *((name, number) for name in NEEDED for number in NEEDED[name])}
    ):
        name = f"{what} {STATES[number] if what == 'abort in state' else number}"
        count = events[(what, number)]
        print(f"{count:10} {name}")
        if count == 0:
            missing.append(name)
    for name in missing:
        print(f"has not happened: {name}")
    return not missing


def can_be(engines: Iterable[Translation]) -> set[tuple[int, int, int, int]]:
    """For what a package of a product waits, rows that wait, depth and whether there are turns:
    what an engine of the build can come to."""
    found = set()
    for engine in engines:
        number = engine.parameters
        nodes = nodes_of(number["Package"])
        accesses = 2 if number["DirectionMemory"] == STALL else 4
        of_rows = -(-3 // number["RowsInParallel"])
        turns = nodes > accesses or of_rows > 1
        queue = Queue(
            2 ** number["QueueBits"],
            number["Partitions"],
            of_rows,
            of_rows if of_rows > 1 else -(-nodes // accesses),
        )
        found |= {(waits, rows, queue.depth, int(turns)) for waits, rows in can_wait(queue)}
    return found


def report_partitions(
    seen: Counter[tuple[int, int, int, int, int]], possible: set[tuple[int, int, int, int]]
) -> bool:
    """Prints pass by package that waits by rows that wait, for each depth of the queue."""
    print("clocks of a partition, by pass, for what a package waits, and finished rows that wait")
    wanted = had = 0
    for depth, turns in sorted({key[3:] for key in seen}):
        for number, name in enumerate(PASSES):
            for waits, what in enumerate(WAITS):
                counts = [seen[(number, waits, rows, depth, turns)] for rows in range(depth + 1)]
                # Outside of a product no package and no row waits.
                there = [
                    rows
                    for rows in range(depth + 1)
                    if (
                        (waits, rows, depth, turns) in possible
                        if number == PRODUCT
                        else waits == 0 and rows == 0
                    )
                ]
                holes = [rows for rows in there if counts[rows] == 0]
                wanted += len(there)
                had += len(there) - len(holes)
                if any(counts) or there:
                    kind = "with turns" if turns else ""
                    numbers = " ".join(map(str, counts))
                    print(f"queue of {depth:2} {kind:10}, {name:15} {what:16} {numbers}")
                if holes:
                    print(f"    not seen: {', '.join(map(str, holes))} rows")
    others = [key for key in seen if key[0] != PRODUCT and (key[1] or key[2])]
    wrong = [key for key in seen if key[0] == PRODUCT and key[1:] not in possible]
    for key in wrong:
        print(f"cannot be, and was seen: {WAITS[key[1]]}, {key[2]} rows, a queue of {key[3]}")
    print(
        f"outside of a product {len(others)} combinations with a row or a package that waits: a "
        "product is over when every row was taken"
    )
    share = had / max(wanted, 1)
    print(f"{had} of {wanted} combinations of pass, wait and rows seen, {100 * share:.1f} %")
    return share >= WANTED and not others and not wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--build", type=Path, default=Path("build/release"))
    parser.add_argument("--keep", type=Path, help="folder of the translation")
    parser.add_argument("--tests", default="Engine/*:RtlEngine.Agrees*", help="as GoogleTest's")
    options = parser.parse_args()
    build = options.build.resolve()
    folder = (options.keep or build / "covered").resolve()
    variant = Variant(folder, ("--coverage-line",), HERE / "coverage/counts.cpp")
    translated = translations(build)
    sources = {
        one.name: [*engine_sources(one), *([OBSERVED] if one.is_engine else [])]
        for one in translated
    }
    try:
        program = build_program(build, variant, sources)
    except NotBuiltError as error:
        print(f"the engine could not be translated: {error}", file=sys.stderr)
        return 1
    try:
        seen = run(program, folder, options.tests)
    except FailedError as error:
        print(error, file=sys.stderr)
        return 1
    good = [
        report_blocks(seen.blocks),
        report_events(seen.events),
        report_partitions(seen.partitions, can_be(one for one in translated if one.is_engine)),
    ]
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
