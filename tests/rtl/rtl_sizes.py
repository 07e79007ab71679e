"""Sizes of the RTL engine for its tests: thirty with the thesis' own.

    python3 tests/rtl/rtl_sizes.py            write them into tests/vp/engine/rtl_sizes.cmake
    python3 tests/rtl/rtl_sizes.py --turn 7   which two have the turn of commit 7, for CMake
    python3 tests/rtl/rtl_sizes.py --pairs    which pairs of values some size has, and which none

Nine have their reasons here. The others are drawn by a fixed seed within what engine.sv is built
for, each the one of many that has most pairs of values that none before it has: a fault of the
hardware seldom needs more than two parameters to show.
"""

import argparse
import itertools
import math
import random
import re
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
LEVEL = TOP / "vp/fpga/rtl/CMakeLists.txt"
LISTED = TOP / "tests/vp/engine/rtl_sizes.cmake"
COUNT = 20
SEED = 29
CANDIDATES = 2000
# By which pairs that are possible are told from those that are not.
DRAWS = 40_000
# How many each run translates beside the thesis' size.
SHARE = 2
# What the random systems of the tests have at most.
NODES = 80
BLOCKS = 15
COMPONENTS = 3
# engine.sv: the blocks of a row; the bits of the scalars, and of the wide words that a
# preconditioner needs; the largest static shift; the last rank of z.r.
ROW_BLOCKS = 64
SCALAR_BITS = 64
WIDE_BITS = 32
MOST_SHIFT = 15
LAST_RANK = 24
MEMORIES = ("double_pumped", "two_copies", "stall")
# What hvp_engine_size takes for what a size does not name.
USUAL = {"RowsInParallel": "3", "DirectionBanks": "1", "DirectionMemory": "double_pumped"}
HEADER = """\
# Made by tests/rtl/rtl_sizes.py: sizes of the RTL engine, within what it is built for.
"""

Size = dict[str, str]


def size(text: str) -> Size:
    words = text.split()
    return dict(zip(words[::2], words[1::2], strict=True))


REASONED = {
    "narrow": (
        "One lane, and queues of two rows.",
        """MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 4 Partitions 3 Lanes 1 NodeBits 7
        PackageBits 10 QueueBits 1 PhaseClocks 23 DivisionClocks 71 StaticBits 4
        Preconditioner 0""",
    ),
    "wide": (
        "Products that drop bits, and a preconditioner with the shortest pass.",
        """MatrixBits 16 VectorBits 20 CoefficientBits 18 Package 9 Partitions 7 Lanes 2 NodeBits 8
        PackageBits 9 QueueBits 3 PhaseClocks 19 DivisionClocks 86 StaticBits 4
        Preconditioner 1""",
    ),
    "least": (
        "The least latencies, the shortest words and one partition.",
        """MatrixBits 8 VectorBits 12 CoefficientBits 8 Package 3 Partitions 1 Lanes 1 NodeBits 6
        PackageBits 11 QueueBits 2 PhaseClocks 19 DivisionClocks 66 StaticBits 4
        Preconditioner 1""",
    ),
    "many": (
        "As many partitions as there can be.",
        """MatrixBits 12 VectorBits 16 CoefficientBits 16 Package 8 Partitions 16 Lanes 2 NodeBits
        8 PackageBits 8 QueueBits 1 PhaseClocks 20 DivisionClocks 68 StaticBits 4
        Preconditioner 0""",
    ),
    "long": (
        "Long divisions and passes, and the longest coefficients.",
        """MatrixBits 14 VectorBits 18 CoefficientBits 24 Package 10 Partitions 4 Lanes 2 NodeBits
        9 PackageBits 8 QueueBits 3 PhaseClocks 33 DivisionClocks 98 StaticBits 4
        Preconditioner 1""",
    ),
    "stall": (
        "Packages and groups that wait for the banks of d.",
        """MatrixBits 10 VectorBits 14 CoefficientBits 12 Package 8 Partitions 2 Lanes 2 NodeBits 7
        PackageBits 9 QueueBits 1 PhaseClocks 19 DivisionClocks 67 StaticBits 4
        Preconditioner 0 DirectionMemory stall""",
    ),
    "banks": (
        "Two words of a group in each bank, and packages of six nodes.",
        """MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 16 Partitions 2 Lanes 4 NodeBits 7
        PackageBits 9 QueueBits 2 PhaseClocks 20 DivisionClocks 68 StaticBits 4
        Preconditioner 0 DirectionMemory two_copies DirectionBanks 2""",
    ),
    "rows": (
        "Rows one at a time, and groups that lie in some of the banks.",
        """MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 7 Partitions 3 Lanes 2 NodeBits 7
        PackageBits 10 QueueBits 2 PhaseClocks 21 DivisionClocks 68 StaticBits 4
        Preconditioner 0 RowsInParallel 1 DirectionBanks 8""",
    ),
    "pairs": (
        "Rows two at a time.",
        """MatrixBits 9 VectorBits 13 CoefficientBits 10 Package 4 Partitions 3 Lanes 4 NodeBits 7
        PackageBits 10 QueueBits 2 PhaseClocks 20 DivisionClocks 68 StaticBits 4
        Preconditioner 0 RowsInParallel 2 DirectionMemory stall DirectionBanks 4""",
    ),
}

# What is drawn has Jacobi's preconditioner or none.
BLOCKED = {
    "blocks": (
        "A preconditioner of blocks, whose words take nearly as long as six divisions.",
        """MatrixBits 12 VectorBits 16 CoefficientBits 16 Package 8 Partitions 5 Lanes 2 NodeBits 9
        PackageBits 10 QueueBits 4 PhaseClocks 20 DivisionClocks 68 StaticBits 4
        Preconditioner 2""",
    ),
    "shortblocks": (
        "The same with the shortest words, where a row of P⁻¹ is longest beside its scale.",
        """MatrixBits 8 VectorBits 12 CoefficientBits 8 Package 3 Partitions 1 Lanes 1 NodeBits 6
        PackageBits 11 QueueBits 2 PhaseClocks 19 DivisionClocks 62 StaticBits 4
        Preconditioner 2""",
    ),
    "wideblocks": (
        "The same with long words, four lanes and rows two at a time.",
        """MatrixBits 16 VectorBits 18 CoefficientBits 12 Package 12 Partitions 7 Lanes 4 NodeBits 8
        PackageBits 8 QueueBits 3 PhaseClocks 24 DivisionClocks 78 StaticBits 4
        Preconditioner 2 RowsInParallel 2 DirectionMemory two_copies DirectionBanks 4""",
    ),
}

# From which value on a parameter counts as another one; the others count by themselves.
LEVELS = {
    "MatrixBits": (8, 9, 12, 15),
    "VectorBits": (12, 13, 17, 22, 27),
    "CoefficientBits": (8, 9, 15, 20),
    "Package": (3, 4, 7, 11, 13),
    "Partitions": (1, 2, 5, 9),
    "NodeBits": (6, 7, 9),
    "QueueBits": (1, 2, 4),
    # With a preconditioner z.r is late up to the last rank.
    "PhaseClocks": (19, 20, LAST_RANK),
}
COUNTED = ("Lanes", "DirectionBanks", "DirectionMemory", "RowsInParallel", "Preconditioner")
Value = tuple[str, str]


def nodes_of(package: int) -> int:
    return package // 3 if package % 3 == 0 else (package + 1) // 3 + 1


def drawn(draw: random.Random) -> Size | None:
    """One size; none where engine.sv refuses what has come about."""
    lanes, banks = draw.choice([1, 2, 4]), draw.choice([1, 2, 4, 8])
    memory, rows = draw.choice(MEMORIES), draw.choice([1, 2, 3])
    package, node_bits = draw.randint(3, 16), draw.randint(6, 10)
    matrix_bits, vector_bits = draw.randint(8, 16), draw.randint(12, WIDE_BITS - 1)
    preconditioner = draw.randint(0, 1)
    accesses = 2 if memory == "stall" else 4
    # A bank takes two words of a pass at most; the first rows need words that have been read.
    if lanes > 2 * banks or (rows < COMPONENTS and nodes_of(package) > accesses):
        return None
    # With a preconditioner b drops as many bits as the products.
    if preconditioner and matrix_bits + vector_bits + 4 - WIDE_BITS > MOST_SHIFT:
        return None
    partitions = draw.choice([1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 13, 16])
    coefficient_bits = draw.randint(8, 24)
    block_rows = math.ceil(min(NODES, 2**node_bits) / partitions)
    packages = block_rows * (math.ceil(COMPONENTS * BLOCKS / package) + 1)
    phase_clocks = draw.choice([19, 20, 21, 22, 24, 27, 31, 40])
    late = max(0, LAST_RANK - phase_clocks) if preconditioner else 0
    shortest = max((SCALAR_BITS - 1) // 8 + coefficient_bits + 41 + late, 36 + 2 * coefficient_bits)
    if preconditioner:
        row_packages = math.ceil(COMPONENTS * ROW_BLOCKS / package)
        inverse_clocks = 14 + row_packages + COMPONENTS * (matrix_bits + 23)
        shortest = max(shortest, math.ceil(inverse_clocks / COMPONENTS))
    values = {
        # The right-hand side drops a bit less, of which 15 fit into StaticBits.
        "MatrixBits": matrix_bits,
        "VectorBits": vector_bits,
        "CoefficientBits": coefficient_bits,
        "Package": package,
        "Partitions": partitions,
        "Lanes": lanes,
        "NodeBits": node_bits,
        # Partitions are not equally full.
        "PackageBits": max(6, math.ceil(math.log2(1.6 * packages))) + draw.randint(0, 1),
        "QueueBits": draw.randint(1, 5),
        "PhaseClocks": phase_clocks,
        "DivisionClocks": shortest + draw.choice([0, 0, 1, 14, 15, 20]),
        "StaticBits": 4,
        "Preconditioner": preconditioner,
        "RowsInParallel": rows,
        "DirectionBanks": banks,
        "DirectionMemory": memory,
    }
    return {name: str(value) for name, value in values.items()}


def drawings(draw: random.Random, count: int) -> list[Size]:
    found: list[Size] = []
    while len(found) < count:
        one = drawn(draw)
        if one is not None:
            found.append(one)
    return found


def pairs(of: Size) -> set[tuple[Value, Value]]:
    """Of the values of its parameters, each two."""
    one = {**USUAL, **of}
    values = [(name, one[name]) for name in COUNTED]
    for name, levels in LEVELS.items():
        least = max(level for level in levels if level <= int(one[name]))
        values.append((name, str(least)))
    return set(itertools.combinations(sorted(values), 2))


def thesis() -> Size:
    found = re.search(r"hvp_scenario_size\(thesis ([^)]*)\)", LEVEL.read_text())
    if found is None:
        raise ValueError(f"{LEVEL} has no size of the thesis")
    return size(found[1])


def sizes() -> dict[str, Size]:
    """All but the thesis', by name."""
    draw = random.Random(SEED)
    found = {name: size(text) for name, (_, text) in REASONED.items()}
    had = pairs(thesis()).union(*map(pairs, found.values()))
    for number in range(1, COUNT + 1):
        one = max(drawings(draw, CANDIDATES), key=lambda size: len(pairs(size) - had))
        had |= pairs(one)
        found[f"drawn{number}"] = one
    return found | {name: size(text) for name, (_, text) in BLOCKED.items()}


def cmake() -> str:
    lines = [HEADER]
    reasons = REASONED | BLOCKED
    for name, one in sizes().items():
        if name in reasons:
            lines.append(f"# {reasons[name][0]}\n")
        arguments = " ".join(f"{parameter} {value}" for parameter, value in one.items())
        lines.append(f"hvp_tested_size({name} {arguments})\n")
    return "".join(lines)


def names() -> list[str]:
    """Of all but the thesis' size, in an order that a share of them runs through."""
    return re.findall(r"^hvp_tested_size\((\w+) ", LISTED.read_text(), re.MULTILINE)


def turn(number: int) -> list[str]:
    """Which have the turn with that number: after a round of turns each has had one."""
    every = names()
    return [every[(SHARE * number + i) % len(every)] for i in range(SHARE)]


def report_pairs() -> None:
    every = [thesis(), *sizes().values()]
    had = set[tuple[Value, Value]]().union(*map(pairs, every))
    possible = had.union(*map(pairs, drawings(random.Random(SEED), DRAWS)))
    for first, second in sorted(possible - had):
        print(f"in no size: {' '.join(first)} with {' '.join(second)}")
    print(f"{len(every)} sizes have {len(had)} of {len(possible)} pairs of values that can be")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--turn", type=int)
    parser.add_argument("--pairs", action="store_true")
    parser.add_argument("--check", action="store_true", help="whether the file is what is drawn")
    options = parser.parse_args()
    if options.turn is not None:
        print(";".join(turn(options.turn)))
    elif options.pairs:
        report_pairs()
    elif options.check:
        if LISTED.read_text() != cmake():
            print("renew it: python3 tests/rtl/rtl_sizes.py")
            return 1
    else:
        LISTED.write_text(cmake())
    return 0


if __name__ == "__main__":
    sys.exit(main())
