"""Draws the convergence of docs/thesis-tables.md.

hvp-tables thesis --csv | python3 tables/plot_thesis.py docs/images/thesis-tables.png
"""

import argparse
import csv
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

from matplotlib import pyplot as plt


@dataclass
class Series:
    iterations: list[int] = field(default_factory=list)
    rounded: list[float] = field(default_factory=list)
    true: list[float] = field(default_factory=list)


def read(lines: list[str]) -> dict[str, Series]:
    result: dict[str, Series] = defaultdict(Series)
    for row in csv.DictReader(lines):
        series = result[row["series"]]
        series.iterations.append(int(row["iterations"]))
        series.rounded.append(float(row["error_rounded"]))
        if row["error_true"]:
            series.true.append(float(row["error_true"]))
    return result


def draw(series: dict[str, Series], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.2), sharey=True, layout="constrained")
    for panel, method, title in (
        (panels[0], "cg", "Table 4.1: CG"),
        (panels[1], "pcg", "Table 4.2: Jacobi-PCG"),
    ):
        words, double, thesis = (series[method + end] for end in ("", "_double", "_thesis"))
        panel.semilogy(words.iterations, words.rounded, "C0-", label="12/16-bit words")
        panel.semilogy(double.iterations, double.rounded, "k--", lw=1, label="double precision")
        panel.semilogy(thesis.iterations, thesis.rounded, "C3o", ms=5, label="thesis")
        panel.semilogy(words.iterations, words.true, "C1-", label="12/16-bit words, true K")
        panel.set_title(title)
        panel.set_xlabel("iterations")
        panel.grid(which="both", alpha=0.25)
    panels[0].set_ylabel("relative error of x, mean of six meshes")
    panels[0].legend(loc="lower left")
    figure.savefig(target, dpi=110, metadata={"Software": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", type=Path, help="the picture, as PNG")
    draw(read(sys.stdin.read().splitlines()), parser.parse_args().target)


if __name__ == "__main__":
    main()
