"""The errors of the table, formed again: exported K, displacements as drawn, double precision."""

import math
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from studies.accuracy.design import FORCE_ERROR, Design, DesignStudy
from studies.point import Value
from studies.report.vtu import read_vtu
from studies.session import Session

Array = npt.NDArray[np.float64]

SETTINGS = ("object.mesh.nodes=70", "frames=220")


def matrix_market(path: Path) -> Array:
    """A symmetric matrix, dense."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("%")]
    rows, columns, _ = map(int, lines[0].split())
    dense = np.zeros((rows, columns))
    for line in lines[1:]:
        row, column, value = line.split()
        i, j = int(row) - 1, int(column) - 1
        dense[i, j] = dense[j, i] = float(value)
    return dense


def recomputed(design: Design, scenario: Path, program: Path, folder: Path) -> tuple[float, float]:
    """Errors of a frame's own displacement and contact force: 95 % of the frames are within."""
    run = [str(program), "run", str(scenario), "--out", str(folder / "run"), "--quiet"]
    export = [str(program), "export", str(scenario), "--out", str(folder / "system"), "--quiet"]
    drawn = ("output.pictures=false", "output.remedies=false", "output.deformation_every_frames=1")
    for setting in (*design.overrides, *drawn):
        run += ["--set", setting]
        export += ["--set", setting]
    for command in (run, export):
        subprocess.run(command, check=False, capture_output=True, timeout=120)
    stiffness = matrix_market(folder / "system/K.mtx")
    errors: list[tuple[float, float]] = []
    sizes: list[tuple[float, float]] = []
    for path in sorted((folder / "run").glob("deformation_*.vtu")):
        shape: dict[str, Any] = read_vtu(path, {"anchor", "contact", "displacement"})
        free = shape["anchor"] == 0
        moved: Array = shape["displacement"].reshape(-1, 3)[free].ravel()
        held = np.repeat(shape["contact"][free] != 0, 3)
        if not held.any():
            continue
        # The contact prescribes, thesis section 3.7; the force on it is its rows of K times all.
        true = moved.copy()
        given = stiffness[np.ix_(~held, held)] @ moved[held]
        true[~held] = np.linalg.solve(stiffness[np.ix_(~held, ~held)], -given)
        rows = stiffness[held]
        errors.append(
            (float(np.linalg.norm(moved - true)), float(np.linalg.norm(rows @ (moved - true))))
        )
        sizes.append((float(np.linalg.norm(true)), float(np.linalg.norm(rows @ true))))
    own = np.sort(np.array(errors) / np.array(sizes), axis=0)
    displacement, force = own[math.ceil(0.95 * len(own)) - 1]
    return float(displacement), float(force)


@pytest.mark.parametrize("numbers", [(12, 16, 60), (18, 24, 15)])
def test_errors_are_those_of_the_exported_stiffness(
    session: Session, scenarios: Path, tmp_path: Path, numbers: tuple[int, int, int]
) -> None:
    matrix, vectors, iterations = numbers
    scenario = scenarios / "thesis-static.toml"
    columns: Mapping[str, Value] = {
        "solver.method": "cg",
        "solver.iterations": iterations,
        "solver.matrix_bits": matrix,
        "solver.vector_bits": vectors,
        "refinement.passes": 0,
    }
    (design,) = DesignStudy(session, scenario, SETTINGS).run([columns])
    displacement, force = recomputed(design, scenario, session.program.path, tmp_path)
    # The upper end of a bin, one part in 64 wide.
    for of, found in ((displacement, design.error()), (force, design.error(FORCE_ERROR))):
        assert of * (1 - 1e-9) <= (found or 0) <= of * (1 + 1 / 64)
