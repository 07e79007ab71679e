"""Pages that the tests of reports look at: of a study with a row of each end, and of a run."""

import subprocess
from pathlib import Path

import pandas as pd

from studies.program import Program
from studies.report.run_page import write_run_report
from studies.report.study_page import Plot, write_study_report

TOP = Path(__file__).resolve().parents[2]
TITLE = "<script>document.title = 'taken'</script> & more"


def table() -> pd.DataFrame:
    """Of a study: a row of each end."""
    return pd.DataFrame(
        {
            "solver.iterations": [5, 10, 20, 40, 80],
            "deadline.worst_us": [100.123456789012, 150.25, 1 / 3, 1800.5, None],
            "accuracy.displacement_of_frame.p95": [0.5, 0.1, 0.01, 0.001, None],
            "status": ["held", "held", "held", "not held", "refused"],
            "message": ["", "", "", "", "x.toml: solver: <b>expected</b> less"],
        }
    )


def write_study_page(folder: Path, frame: pd.DataFrame) -> Path:
    """report.html of a table, beside its results.csv."""
    frame.to_csv(folder / "results.csv", index=False)
    plot = Plot(
        "deadline.worst_us",
        "accuracy.displacement_of_frame.p95",
        log_y=True,
        front=[0, 1, 3],
        mark=1,
    )
    return write_study_report(
        folder,
        title=TITLE,
        frame=frame,
        units={"deadline.worst_us": "µs"},
        helps={"deadline.worst_us": "of `all` frames"},
        plots=[plot],
        words=["1e-2 costs at least 0.33 µs."],
        commands=["./hvp study x.toml"],
        versions={"hvp": "0"},
    )


def write_run_page(program: Program, folder: Path) -> Path:
    """Of frames of the thesis' scene in which the body is touched, with words of a bad user."""
    scenario = TOP / "scenarios/thesis.toml"
    command = [str(program.path), "run", str(scenario), "--out", str(folder), "--set", "frames=250"]
    title = TITLE.replace("'", "")
    subprocess.run(
        [*command, "--set", f'title="{title}"'], check=False, capture_output=True, timeout=120
    )
    return write_run_report(folder, folder / "report.html", program)
