"""Questions about accuracy: word lengths, and iterations."""

import math
from collections.abc import Sequence

from studies.plot import Chart, Panel
from studies.questions.answer import TIMES, Answer, Row, cross, line, number, values, where

TRUE = "accuracy.displacement_of_frame.median"
ROUNDED = "accuracy.displacement_of_frame_quantised.median"

# Thesis Tables 4.1 and 4.2: about 1000 nodes, from zero, mean over meshes (docs/thesis-tables.md).
THESIS = {
    "CG": {30: 2.6e-2, 40: 2.2e-2, 60: 1.6e-2, 80: 5.1e-3},
    "Jacobi-PCG": {30: 1.7e-2, 40: 1.1e-2, 60: 1.3e-3, 80: 9.0e-4},
}


def word_lengths(rows: Sequence[Row]) -> Answer:
    """The vectors' words are the floor of the solver, the matrix' words that of the model."""
    heading, table = cross(rows, "matrix bits", "vector bits", TRUE, ".1e")
    heading.append("matrix words")
    smallest = min(values(rows, "matrix bits"))
    for cells in table:
        cells.append(f"{TIMES} {int(cells[0]) / smallest:.1f}")
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
    }
    return Answer(heading, table, chart, facts)


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
        cells += [number(THESIS[method].get(count), ".1e") for method in THESIS]
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
    }
    return Answer(heading, table, chart, facts)
