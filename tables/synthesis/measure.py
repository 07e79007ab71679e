"""Synthesises the engines of engines.py for ECP5 and writes measured.csv.

    measure.py BUILD [--areas] [ENGINE…]

A block that measured.csv has already, of the same sources and tools, is left as it is, and so is
one of BUILD/synthesised, which keeps every result.
"""

import argparse
import csv
import json
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from engines import ENGINES, HERE, Block, Engine, blocks_of
from nextpnr_runs import OPTIONS, place_and_route
from yosys_runs import Cells, file_of, fingerprint, read_engine, synthesise, tools

COLUMNS = (
    *("engine", "block", "count", "sources", "luts", "carries", "registers", "memories"),
    *("ram", "multipliers", "clock_mhz", "path", "half_clock_ns", "half_path"),
)
Row = dict[str, str]


def tell(text: str) -> None:
    """Progress, beside the page."""
    print(text, file=sys.stderr, flush=True)


def rows_of(file: Path) -> dict[tuple[str, str], Row]:
    """By engine and block; nothing where there is no file."""
    if not file.exists():
        return {}
    with file.open(newline="") as stream:
        return {(row["engine"], row["block"]): row for row in csv.DictReader(stream)}


def kept(file: Path, make: Callable[[], object]) -> Row:
    """What the file has, or what `make` makes, a dataclass, and the file then has."""
    if file.exists():
        found: Row = json.loads(file.read_text())
        return found
    values = {key: str(value) for key, value in asdict(make()).items()}  # type: ignore[call-overload]
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(values))
    return values


def measure(engine: Engine, block: Block, folder: Path, results: Path, places: bool) -> Row:
    """Its cells and, where it is placed, its clock; `results` has a file each."""
    started = time.monotonic()
    name = file_of(block)
    row = kept(results.with_suffix(".cells"), lambda: synthesise(block, folder))
    cells = Cells(**{key: int(value) for key, value in row.items()})
    if places and block.is_placed(engine):
        if not (folder / f"{name}.json").exists():
            synthesise(block, folder)
        timing = kept(results.with_suffix(".timing"), lambda: place_and_route(name, cells, folder))
        row = row | timing
    tell(f"{engine.name}: {block.name}: {cells.logic} LUTs, {time.monotonic() - started:.0f} s")
    return row


def measured(
    engine: Engine, known: dict[tuple[str, str], Row], build: Path, places: bool
) -> list[Row]:
    """A row a block."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        read_engine(engine, folder)
        for block in blocks_of(engine):
            placed = block.is_placed(engine)
            sources = fingerprint(block, folder, OPTIONS if placed else ())
            before = known.get((engine.name, block.name))
            known_here = before is not None and before["sources"] == sources
            # It has a clock where it should.
            if before is not None and known_here and (not placed or before["clock_mhz"] != ""):
                rows.append(before)
                continue
            values = measure(engine, block, folder, build / "synthesised" / sources, places)
            rows.append(
                {
                    "engine": engine.name,
                    "block": block.name,
                    "count": str(block.count(engine)),
                    "sources": sources,
                    **values,
                }
            )
    return rows


def write(rows: list[Row], file: Path) -> None:
    """In the order of engines and blocks."""
    with file.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    """All engines, or those named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    parser.add_argument("--areas", action="store_true", help="place nothing that is not placed")
    parser.add_argument("engines", nargs="*", help="names; all without")
    arguments = parser.parse_intermixed_args()
    names = [engine.name for engine in ENGINES]
    for name in arguments.engines:
        if name not in names:
            parser.error(f"expected engines of {', '.join(names)}: found {name}")
    file = HERE / "measured.csv"
    known = rows_of(file)
    for engine in ENGINES:
        if arguments.engines and engine.name not in arguments.engines:
            continue
        for row in measured(engine, known, arguments.build, not arguments.areas):
            known[row["engine"], row["block"]] = row
        order = [(e.name, b.name) for e in ENGINES for b in blocks_of(e)]
        write([known[key] for key in order if key in known], file)
    (HERE / "versions.txt").write_text(tools().replace(" yow", "\nyow") + "\n")


if __name__ == "__main__":
    main()
