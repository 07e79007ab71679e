"""Holds what README.md shows of a run against the run.

A fenced block below a line

    <!-- output of ./hvp run scenarios/thesis.toml -->

has lines of what that command prints: all of them and in order, but where a line "…" stands. The
pictures that such a run draws are those in docs/images, as far as two machines draw alike.
"""

import argparse
import re
import struct
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
README = TOP / "README.md"
SAMPLE = re.compile(r"<!-- output of \./hvp (run [^>]*?) -->\n+```\n(.*?)\n```\n", re.DOTALL)
# The last line of a run has wall-clock times.
PASSING = "Results in "
# Of 255 levels, on average: another driver draws edges and letters a little differently.
DIFFERENCE = 2.0
BYTES_A_PIXEL = 3


@dataclass(frozen=True)
class Picture:
    width: int
    height: int
    rows: list[bytes]  # three bytes a pixel


def chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def paeth(left: int, above: int, corner: int) -> int:
    estimate = left + above - corner
    to_left, to_above, to_corner = (abs(estimate - value) for value in (left, above, corner))
    if to_left <= to_above and to_left <= to_corner:
        return left
    return above if to_above <= to_corner else corner


def unfiltered(kind: int, line: bytearray, above: bytes) -> bytes:
    """PNG specification, section 9."""
    for i in range(len(line)):
        before = i - BYTES_A_PIXEL
        left, corner = (line[before], above[before]) if before >= 0 else (0, 0)
        estimate = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        line[i] = (line[i] + estimate) & 0xFF
    return bytes(line)


def read_picture(path: Path) -> Picture:
    width = height = 0
    packed = b""
    for kind, content in chunks(path.read_bytes()):
        if kind == b"IHDR":
            width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", content)
            if (depth, colour, interlaced) != (8, 2, 0):
                raise ValueError(f"{path}: expected 8-bit RGB that is not interlaced")
        elif kind == b"IDAT":
            packed += content
    data = zlib.decompress(packed)
    rows: list[bytes] = []
    above = bytes(BYTES_A_PIXEL * width)
    for row in range(height):
        at = row * (BYTES_A_PIXEL * width + 1)
        above = unfiltered(
            data[at], bytearray(data[at + 1 : at + 1 + BYTES_A_PIXEL * width]), above
        )
        rows.append(above)
    return Picture(width, height, rows)


def difference(one: Picture, other: Picture) -> float:
    if (one.width, one.height) != (other.width, other.height):
        return 255.0
    total = 0
    for a, b in zip(one.rows, other.rows, strict=True):
        if a != b:
            total += sum(abs(x - y) for x, y in zip(a, b, strict=True))
    return total / (BYTES_A_PIXEL * one.width * one.height)


def unlike(sample: list[str], printed: list[str]) -> str | None:
    """The first line of the sample that is not where it should be."""
    at = 0
    skipping = False
    for line in sample:
        if line.strip() == "…":
            skipping = True
            continue
        while skipping and at < len(printed) and printed[at] != line:
            at += 1
        if at >= len(printed) or printed[at] != line:
            found = printed[at] if at < len(printed) else "the end"
            return f"README.md shows\n  {line}\nthe run prints\n  {found}"
        at += 1
        skipping = False
    left = [line for line in printed[at:] if line and not line.startswith(PASSING)]
    return f"README.md leaves out\n  {left[0]}" if left and not skipping else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True, help="the built hvp")
    program = parser.parse_args().program.resolve()
    samples = SAMPLE.findall(README.read_text(encoding="utf-8"))
    if not samples:
        print("README.md has no sample of a run")
        return 1
    faults = 0
    for command, text in samples:
        with tempfile.TemporaryDirectory(prefix="hvp-readme-") as scratch:
            out = Path(scratch) / "out"
            run = subprocess.run(
                [program, *command.split(), "--out", out],
                check=False,
                cwd=TOP,
                stdout=subprocess.PIPE,
                text=True,
            )
            fault = unlike(text.splitlines(), run.stdout.splitlines())
            if fault:
                faults += 1
                print(fault)
            name = Path(command.split()[1]).stem
            for picture in sorted((TOP / "docs" / "images").glob(f"{name}-*.png")):
                drawn = out / picture.name.removeprefix(f"{name}-")
                if not drawn.exists():
                    continue
                apart = difference(read_picture(picture), read_picture(drawn))
                print(f"{picture.name}: {apart:.2f} of 255 apart")
                if apart > DIFFERENCE:
                    faults += 1
                    print(f"renew it: ./hvp {command}, then copy {drawn.name} there")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
