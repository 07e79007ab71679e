"""Sizes of the RTL engine for its tests: thirty with the thesis' own.

    python3 tests/rtl/rtl_sizes.py                write them into tests/vp/engine/rtl_sizes.cmake
    python3 tests/rtl/rtl_sizes.py --turn 7       which two have the turn of commit 7, for CMake

The thesis' size and five whose reason stands beside them are in CMakeLists.txt; the others are
drawn here, within what engine.sv is built for, by a fixed seed.
"""

import argparse
import math
import random
import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
LISTED = TOP / "tests/vp/engine/CMakeLists.txt"
DRAWN = TOP / "tests/vp/engine/rtl_sizes.cmake"
COUNT = 24
SEED = 29
# How many each run translates beside the thesis' size.
SHARE = 2
# What the random systems of the tests have at most.
NODES = 80
BLOCKS = 15
COMPONENTS = 3
# engine.sv: of the scalars, and what an exact sum of products has beside its node's bits.
SCALAR_BITS = 64
PRODUCT_BITS = 32
HEADER = "# Made by tests/rtl/rtl_sizes.py: sizes of the RTL engine, within what it is built for.\n"


def drawn(draw: random.Random) -> dict[str, int]:
    """One size; each of its parameters is one of engine.sv."""
    node_bits = draw.randint(6, 10)
    # Eleven columns and more touch five nodes, for which a package waits.
    package = draw.randint(3, 10)
    partitions = draw.choice([1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 13, 16])
    coefficient_bits = draw.randint(8, 24)
    rows = math.ceil(min(NODES, 2**node_bits) / partitions)
    packages = rows * (math.ceil(COMPONENTS * BLOCKS / package) + 1)
    shortest = max((SCALAR_BITS - 1) // 8 + coefficient_bits + 41, 36 + 2 * coefficient_bits)
    return {
        # The right-hand side drops a bit less, of which 15 fit into StaticBits.
        "MatrixBits": draw.randint(8, 16),
        "VectorBits": draw.randint(12, SCALAR_BITS - PRODUCT_BITS - 1 - node_bits),
        "CoefficientBits": coefficient_bits,
        "Package": package,
        "Partitions": partitions,
        # No more than nodes of a package: the memory of d has as many reads.
        "Lanes": 1 if package <= COMPONENTS else draw.randint(1, 2),
        "NodeBits": node_bits,
        # Partitions are not equally full.
        "PackageBits": max(6, math.ceil(math.log2(1.6 * packages))) + draw.randint(0, 1),
        "QueueBits": draw.randint(1, 5),
        "PhaseClocks": draw.choice([19, 20, 21, 22, 24, 27, 31, 40]),
        "DivisionClocks": shortest + draw.choice([0, 0, 1, 14, 15, 20]),
        "StaticBits": 4,
    }


def cmake() -> str:
    draw = random.Random(SEED)
    lines = []
    for number in range(1, COUNT + 1):
        arguments = " ".join(f"{name} {value}" for name, value in drawn(draw).items())
        lines.append(f"hvp_tested_size(drawn{number} {arguments})\n")
    return HEADER + "".join(lines)


def names() -> list[str]:
    """Of all but the thesis' size, in an order that a share of them runs through."""
    text = LISTED.read_text() + DRAWN.read_text()
    return re.findall(r"^ *hvp_tested_size\((\w+) Matrix", text, re.MULTILINE)


def turn(number: int) -> list[str]:
    """Which have the turn with that number: after a round of turns each has had one."""
    every = names()
    return [every[(SHARE * number + i) % len(every)] for i in range(SHARE)]


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--turn", type=int)
    parser.add_argument("--check", action="store_true", help="whether the file is what is drawn")
    options = parser.parse_args()
    if options.turn is not None:
        print(";".join(turn(options.turn)))
    elif options.check:
        if DRAWN.read_text() != cmake():
            print("renew it: python3 tests/rtl/rtl_sizes.py")
            return 1
    else:
        DRAWN.write_text(cmake())
    return 0


if __name__ == "__main__":
    sys.exit(main())
