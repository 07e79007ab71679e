"""Element delays of ECP5: least squares over half of `measured.csv`, checked on the rest.

Prints the error of each design; `--write` renews `elements.csv`, what devices/LFE5U-*.toml have.
Logic and nets are fitted apart, since the reports tell them apart; nets of full devices give the
crowding.
"""

import argparse
import csv
import statistics
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from designs import Counts, all_designs

HERE = Path(__file__).parent
LOGIC = (
    "registers",
    "luts",
    "chains",
    "chain_bits",
    "multipliers",
    "block_registers",
    "memory_reads",
    "memory_outputs",
    "memory_writes",
)
NETS = ("hops", "block_hops")
# Fuller devices tell how nets grow.
CROWDED = 0.1
# With these fitted on the slower speed grade, one factor makes those of the faster one.
SLOW, FAST = 6, 8


@dataclass(frozen=True)
class Measured:
    """A design on a device: medians over the seeds."""

    name: str
    device: str
    grade: int
    fits: bool
    path: float
    logic: float
    routing: float
    fill: float
    counts: Counts


def read() -> list[Measured]:
    """`measured.csv`."""
    counts = {design.name: design.counts for design in all_designs()}
    groups: defaultdict[tuple[str, str, int], list[dict[str, str]]] = defaultdict(list)
    with (HERE / "measured.csv").open(newline="") as stream:
        for row in csv.DictReader(stream):
            groups[row["design"], row["device"], int(row["grade"])].append(row)
    return [
        Measured(
            name,
            device,
            grade,
            rows[0]["set"] == "fit",
            statistics.median(float(row["path_ns"]) for row in rows),
            statistics.median(float(row["logic_ns"]) for row in rows),
            statistics.median(float(row["routing_ns"]) for row in rows),
            float(rows[0]["multipliers_used"]),
            counts[name],
        )
        for (name, device, grade), rows in groups.items()
    ]


def least_squares(rows: list[list[float]], values: list[float]) -> list[float]:
    """The normal equations, by Gauss elimination with pivots."""
    n = len(rows[0])
    matrix = [
        [sum(row[i] * row[j] for row in rows) for j in range(n)]
        + [sum(row[i] * value for row, value in zip(rows, values, strict=True))]
        for i in range(n)
    ]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(matrix[k][i]))
        matrix[i], matrix[pivot] = matrix[pivot], matrix[i]
        for k in range(n):
            if k != i:
                factor = matrix[k][i] / matrix[i][i]
                matrix[k] = [a - factor * b for a, b in zip(matrix[k], matrix[i], strict=True)]
    return [matrix[i][n] / matrix[i][i] for i in range(n)]


def terms(counts: Counts, names: tuple[str, ...]) -> list[float]:
    """How often each element is there."""
    return [float(getattr(counts, name)) for name in names]


def fit(measured: list[Measured]) -> dict[str, float]:
    """ns of each element, and the crowding."""
    used = [m for m in measured if m.fits and m.grade == SLOW and m.device == "25k"]
    logic = least_squares([terms(m.counts, LOGIC) for m in used], [m.logic for m in used])
    loose = [m for m in used if m.fill < CROWDED]
    nets = least_squares([terms(m.counts, NETS) for m in loose], [m.routing for m in loose])
    elements = dict(zip(LOGIC + NETS, logic + nets, strict=True))
    crowded = [m for m in used if m.fill >= CROWDED]
    loose_nets = [routing(elements, m.counts) for m in crowded]
    elements["crowding"] = sum(
        m.fill * net * (m.routing - net) for m, net in zip(crowded, loose_nets, strict=True)
    ) / sum((m.fill * net) ** 2 for m, net in zip(crowded, loose_nets, strict=True))
    return elements


def routing(elements: dict[str, float], counts: Counts) -> float:
    """All nets of a path in an empty device."""
    return sum(elements[name] * n for name, n in zip(NETS, terms(counts, NETS), strict=True))


def predict(elements: dict[str, float], m: Measured) -> float:
    """The path's delay."""
    logic = sum(elements[name] * n for name, n in zip(LOGIC, terms(m.counts, LOGIC), strict=True))
    return logic + routing(elements, m.counts) * (1 + elements["crowding"] * m.fill)


def main() -> None:
    """Fits, checks, writes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help="write elements.csv")
    write = parser.parse_args().write
    measured = read()
    elements = fit(measured)
    fast = [(m.path, predict(elements, m)) for m in measured if m.fits and m.grade == FAST]
    factor = statistics.mean(path / predicted for path, predicted in fast)
    for name, value in elements.items():
        print(f"{name:<16} {value:8.4f}")
    print(f"{'grade 8':<16} {factor:8.4f}")
    errors: dict[str, list[float]] = {"fit": [], "check": []}
    for m in sorted(measured, key=lambda m: (not m.fits, m.name, m.device, m.grade)):
        predicted = predict(elements, m) * (factor if m.grade == FAST else 1)
        error = 100 * (predicted / m.path - 1)
        kind = "fit" if m.fits else "check"
        errors[kind].append(error)
        print(
            f"{kind:<6} {m.name:<34} {m.device} grade {m.grade}"
            f" {m.path:7.3f} ns {predicted:7.3f} ns {error:+6.1f} %"
        )
    for kind, values in errors.items():
        mean = statistics.mean(abs(value) for value in values)
        print(f"{kind}: mean {mean:.1f} %, largest {max(values, key=abs):+.1f} %")
    if not write:
        return
    with (HERE / "elements.csv").open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["element", "ns"])
        writer.writerows((name, f"{value:.4f}") for name, value in elements.items())
        writer.writerow(("grade_8_factor", f"{factor:.4f}"))


if __name__ == "__main__":
    main()
