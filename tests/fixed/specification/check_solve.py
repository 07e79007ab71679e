"""Holds `hvp solve` against its specification in Python: the same doubles, from file to file.

check_solve.py HVP FOLDER: the program, and a folder of Matrix Market files.
"""

import json
import subprocess
import sys
import tempfile
from dataclasses import fields
from itertools import product
from pathlib import Path
from typing import Any

from spec_host import Host, read_system
from spec_solver import Solver
from spec_words import Settings

# Newtons at every unknown: with it all displacements are below the longest range, 1 km.
LOAD = 0.125
# Metres: about twice the largest displacement, and a range that clamps.
RANGES = {
    "nos4": ("625", "0.125"),
    "bcsstk01": ("0.0000875", "0.00000375"),
    "bcsstk03": ("0.0000125", "0.00000025"),
}
CASES: list[dict[str, str]] = [
    {},
    {"method": "cg"},
    {"method": "cg", "static_scale": "matrix-norm", "dynamic_scaling": "false"},
    {"method": "block-jacobi-pcg", "matrix_scaling": "diagonal"},
    {"method": "cg", "matrix_scaling": "diagonal", "iterations": "30"},
    {"coefficient_format": "fixed", "alpha_fraction_bits": "20"},
    {"matrix_scaling": "diagonal", "matrix_bits": "18", "vector_bits": "20"},
    {
        "matrix_bits": "24",
        "vector_bits": "28",
        "scalar_bits": "128",
        "shift_rounding": "truncation",
    },
    {"method": "chronopoulos-gear", "matrix_scaling": "diagonal", "replace_residual_every": "7"},
    {"method": "pipelined-cg", "replace_residual_every": "12", "stop_residual": "0.01"},
    {"headroom_bits": "3", "scaling_threshold": "2", "scaling_step": "3", "overflow": "wrap"},
]


def solve(program: str, matrix: Path, rhs: Path, settings: dict[str, str]) -> dict[str, Any]:
    command = [program, "solve", "--matrix", str(matrix), "--rhs", str(rhs)]
    command += ["--solution", str(rhs.with_name("x.mtx"))]
    for key, value in settings.items():
        command += ["--set", f"solver.{key}={value}"]
    out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    answer: dict[str, Any] = json.loads(out)
    lines = rhs.with_name("x.mtx").read_text(encoding="ascii").splitlines()
    answer["x"] = [float(line) for line in lines[2:]]
    return answer


def difference(matrix: Path, rhs: Path, answer: dict[str, Any], metres: float) -> str:
    given = answer["settings"]["solver"]
    host = Host(read_system(matrix, rhs), given, metres)
    named = {f.name: given[f.name] for f in fields(Settings)}
    if given["static_scale"] == "matrix-norm":
        named["static_shift"] = host.matrix.static_shift()
    settings = Settings(**named)
    b, clamped = host.right_hand_side(settings)
    solver = Solver(settings, host.matrix)
    solver.solve(b, [0] * len(b))
    mine: dict[str, Any] = {
        "x": host.displacements(solver.x),
        "x_unit": host.unit * max(host.scale),
        "iterations": solver.counts.iterations,
        "saturations": solver.counts.saturations,
        "wraps": solver.counts.wraps,
        "breakdowns": solver.counts.breakdowns,
        "clamped_words": clamped,
    }
    for name, value in mine.items():
        if value != answer[name]:
            return f"{name}: {value} and {answer[name]}"
    unexplained = solver.counts.flags - set(answer["flags"])
    return f"flags {unexplained} are not in {answer['flags']}" if unexplained else ""


def main() -> int:
    program, folder = sys.argv[1:]
    failed = solves = clean = clamped = saturated = 0
    with tempfile.TemporaryDirectory() as scratch:
        for name, ranges in RANGES.items():
            matrix = Path(folder) / f"{name}.mtx"
            lines = matrix.read_text(encoding="ascii").splitlines()
            rows = int(next(line for line in lines if not line.startswith("%")).split()[0])
            rhs = Path(scratch) / "b.mtx"
            loads = f"{LOAD}\n" * rows
            rhs.write_text(f"%%MatrixMarket matrix array real general\n{rows} 1\n{loads}")
            for metres, case in product(ranges, CASES):
                answer = solve(program, matrix, rhs, case | {"displacement_range": f"{metres} m"})
                where = difference(matrix, rhs, answer, float(metres))
                solves += 1
                clean += not answer["flags"]
                clamped += answer["clamped_words"] > 0
                saturated += answer["saturations"] > 0
                if where:
                    failed += 1
                    print(f"{name}, {metres} m, {case}: {where} (the page's, the program's)")
    print(f"{solves} solves, {failed} differ; {clean} without a flag", end=", ")
    print(f"{clamped} with clamped words of b, {saturated} with words that saturated")
    return 1 if failed or not (clean and clamped and saturated) else 0


if __name__ == "__main__":
    sys.exit(main())
