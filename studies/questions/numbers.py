"""Questions about accuracy: word lengths, and iterations."""

import itertools
import math
from collections.abc import Sequence

from studies.errors import StudyError
from studies.plot import Chart, Panel
from studies.questions.answer import Answer, Row, cross, line, number, values, where
from studies.questions.thesis_tables import random_load, smooth, thesis

TRUE = "accuracy.displacement_of_frame.median"
ROUNDED = "accuracy.displacement_of_frame_quantised.median"

MEMORY = "resources[M20K].used"
# The median frame of a run that has reached the floor is as far above it.
FLOOR_MARGIN = 1.1


def word_lengths(rows: Sequence[Row]) -> Answer:
    """The vectors' words are the floor of the solver, the matrix' words that of the model."""
    heading, table = cross(rows, "matrix bits", "vector bits", TRUE, ".1e")
    words, memory = cross(rows, "matrix bits", "vector bits", MEMORY, "d")
    heading += [f"M20K, {bits}" for bits in words[1:]]
    table = [errors + blocks[1:] for errors, blocks in zip(table, memory, strict=True)]
    bits = values(rows, "vector bits")
    wide = where(rows, **{"vector bits": bits[-1]})
    lower, upper = (next(row for row in wide if row["matrix bits"] == value) for value in (12, 18))
    narrow = where(rows, **{"vector bits": 16})
    solver = where(rows, **{"matrix bits": 18})
    chart = Chart(
        "Error of the displacement over the matrix' words",
        "bits of the matrix",
        [
            Panel(
                name,
                [
                    line(str(value), where(rows, **{"vector bits": value}), "matrix bits", column)
                    for value in bits
                ],
                log=True,
            )
            for name, column in (("from the true K", TRUE), ("from the rounded K", ROUNDED))
        ],
        legend="vector bits",
    )
    facts = {
        "a_bit": number((lower[TRUE] / upper[TRUE]) ** (1 / 6), ".2f"),
        "floor_16": number(narrow[-1][TRUE], ".1e"),
        "floor_from": str(
            next(r["matrix bits"] for r in narrow if r[TRUE] < 1.2 * narrow[-1][TRUE])
        ),
        "vector_bit": number(
            (solver[0][ROUNDED] / solver[-1][ROUNDED])
            ** (1 / (solver[-1]["vector bits"] - solver[0]["vector bits"])),
            ".2f",
        ),
        "thesis": number(narrow[1][TRUE], ".1e"),
        "thesis_solver": number(narrow[1][ROUNDED], ".1e"),
        "best": number(min(row[TRUE] for row in rows), ".1e"),
        "blocks": number(narrow[1][MEMORY], "d"),
        "best_blocks": number(wide[-1][MEMORY], "d"),
        "same_blocks": _alike(narrow),
    }
    return Answer(heading, table, chart, facts)


def _alike(rows: Sequence[Row]) -> str:
    """The words of the matrix that take as many blocks as the ones before."""
    pairs = [
        f"{before['matrix bits']} and {after['matrix bits']}"
        for before, after in itertools.pairwise(rows)
        if before[MEMORY] == after[MEMORY]
    ]
    return ", ".join(pairs)


def held_to_the_thesis(rows: Sequence[Row]) -> dict[str, str]:
    """How far the runs from zero are from the thesis' tables. Throws StudyError beyond the bounds.

    The load of a probe lies between the thesis' smooth load and one that is random itself; the
    solver's figures for both are those of docs/thesis-tables.md. Below the floor of the words,
    which a warm start has reached, no number of iterations goes.
    """
    facts: dict[str, str] = {}
    for method, short in (("CG", "cg"), ("Jacobi-PCG", "pcg")):
        theirs, least, most = thesis(method), smooth(method), random_load(method)
        runs = {row["iterations"]: row for row in where(rows, method=method, start="zero")}
        floor = min(row[ROUNDED] for row in where(rows, method=method, start="warm"))
        shared = [count for count in theirs if count in runs]
        for count in shared:
            error = runs[count][ROUNDED]
            if not least[count] <= error <= max(most[count], FLOOR_MARGIN * floor):
                raise StudyError(
                    f"questions: iterations: {method}, {count} iterations from zero: {error:.1e}: "
                    f"expected between {least[count]:.1e}, this solver's with the load of the "
                    f"thesis' table, and {most[count]:.1e}, its with a random load"
                )
        facts |= {
            f"{short}_of_thesis": _range([runs[c][ROUNDED] / theirs[c] for c in shared]),
            f"{short}_set_up": _range([least[c] / theirs[c] for c in theirs]),
            f"{short}_double": _range(
                [error / theirs[c] for c, error in smooth(method, "double precision, {}").items()]
            ),
        }
    return facts


def _range(ratios: Sequence[float]) -> str:
    return f"{min(ratios):.1f} to {max(ratios):.1f}"


def iterations(rows: Sequence[Row]) -> Answer:
    """What an iteration buys, from zero and from the frame before."""
    for row in rows:
        row["which"] = f"{row['method']}, {row['start']}"
    names = values(rows, "which")
    heading = ["iterations", *names, "thesis, CG", "thesis, PCG"]
    table = []
    for count in values(rows, "iterations"):
        cells = [str(count)]
        for name in names:
            row = where(rows, which=name, iterations=count)[0]
            cells.append(f"{row[ROUNDED]:.1e} in {row['deadline.p50_us']:.0f} µs")
        cells += [number(thesis(method).get(count), ".1e") for method in ("CG", "Jacobi-PCG")]
        table.append(cells)
    chart = Chart(
        "The solver's error over the frame's time",
        "latency of a frame, µs",
        [
            Panel(
                "from the rounded K",
                [line(name, where(rows, which=name), "deadline.p50_us", ROUNDED) for name in names],
                log=True,
            )
        ],
        legend="method, start",
    )
    cold = where(rows, which="CG, zero")
    warm = where(rows, which="CG, warm")
    pcg = where(rows, which="Jacobi-PCG, zero")
    last = cold[-1]
    cheap = next(row for row in warm if row[ROUNDED] < last[ROUNDED])
    per_iteration = {
        method: (some[-1]["deadline.p50_us"] - some[0]["deadline.p50_us"])
        / (some[-1]["iterations"] - some[0]["iterations"])
        for method, some in (("cg", cold), ("pcg", pcg))
    }
    facts = {
        "cold": number(last[ROUNDED], ".1e"),
        "cold_count": str(last["iterations"]),
        "warm_count": str(cheap["iterations"]),
        "warm_us": number(cheap["deadline.p50_us"], ".0f"),
        "cold_us": number(last["deadline.p50_us"], ".0f"),
        "cg_us": number(per_iteration["cg"], ".2f"),
        "pcg_us": number(per_iteration["pcg"], ".2f"),
        "pcg_cold": number(pcg[-1][ROUNDED], ".1e"),
        "warm_floor": number(warm[-1][ROUNDED], ".1e"),
        "decades": number(math.log10(warm[0][ROUNDED] / warm[-1][ROUNDED]), ".1f"),
        "true": number(warm[-1][TRUE], ".1e"),
    } | held_to_the_thesis(rows)
    return Answer(heading, table, chart, facts)
