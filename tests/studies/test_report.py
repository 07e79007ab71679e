"""Pages in a real browser: no complaint, no network, the table's figures, filters that filter."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browser import Browser, start
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from studies.errors import InputError
from studies.program import Program
from studies.report.body import boundary
from studies.report.run_page import write_run_report
from studies.report.study_page import Plot, write_study_report

TITLE = "<script>document.title = 'taken'</script> & more"
LARGEST_BYTES = 5_000_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One for the module."""
    yield from start()


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    """Of a study: a row of each end."""
    return pd.DataFrame(
        {
            "solver.iterations": [5, 10, 20, 40, 80],
            "deadline.worst_us": [100.123456789012, 150.25, 1 / 3, 1800.5, None],
            "accuracy.displacement_rel": [0.5, 0.1, 0.01, 0.001, None],
            "status": ["held", "held", "held", "not held", "refused"],
            "message": ["", "", "", "", "x.toml: solver: <b>expected</b> less"],
        }
    )


@pytest.fixture(scope="module")
def study(table: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study's page."""
    folder = tmp_path_factory.mktemp("study")
    table.to_csv(folder / "results.csv", index=False)
    plot = Plot(
        "deadline.worst_us", "accuracy.displacement_rel", log_y=True, front=[0, 1, 3], mark=1
    )
    return write_study_report(
        folder,
        title=TITLE,
        frame=table,
        units={"deadline.worst_us": "µs"},
        helps={"deadline.worst_us": "of `all` frames"},
        plots=[plot],
        words=["1e-2 costs at least 0.33 µs."],
        commands=["./hvp study x.toml"],
        versions={"hvp": "0"},
    )


@pytest.fixture(scope="module")
def run(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Frames of the thesis' scene in which the body is touched, with words of a bad user."""
    folder = tmp_path_factory.mktemp("run") / "run"
    scenario = Path(__file__).resolve().parents[2] / "scenarios/thesis.toml"
    command = [str(program.path), "run", str(scenario), "--out", str(folder), "--set", "frames=250"]
    title = TITLE.replace("'", "")
    subprocess.run(
        [*command, "--set", f'title="{title}"'], check=False, capture_output=True, timeout=120
    )
    write_run_report(folder, folder / "report.html", program)
    return folder / "report.html"


def test_a_study_has_the_figures_of_its_csv(browser: Browser, study: Path) -> None:
    browser.open(study)
    assert browser.complaints() == []
    assert browser.requests() == []
    assert browser.driver.title == TITLE
    csv = pd.read_csv(study.with_name("results.csv"))
    there = csv[csv["status"] != "refused"]
    points = browser.run(
        "const t = document.getElementById('plot-1').data; return [t[0].x, t[0].y]"
    )
    assert points == [
        there["deadline.worst_us"].tolist(),
        there["accuracy.displacement_rel"].tolist(),
    ]
    assert "1 refused" in browser.run(
        "return document.getElementById('plots').parentNode.textContent"
    )


def test_rows_are_sorted_and_filtered(browser: Browser, study: Path) -> None:
    browser.open(study)
    shown = (
        "return [...document.querySelectorAll('#rows tbody tr')].filter(r => !r.hidden)"
        ".map(r => r.cells[0].textContent)"
    )
    heading = browser.driver.find_elements(By.CSS_SELECTOR, "#rows th button")[1]
    heading.send_keys(Keys.ENTER)
    assert browser.run(shown) == ["20", "5", "10", "40", "80"]
    heading.click()
    assert browser.run(shown) == ["40", "10", "5", "20", "80"]
    head = "return document.querySelectorAll('#rows th')[1].getAttribute('aria-sort')"
    assert browser.run(head) == "descending"
    browser.driver.find_element(By.ID, "rows-filter").send_keys("expected x.toml")
    assert browser.run(shown) == ["80"]
    assert browser.run("return document.getElementById('rows-count').textContent") == "1 of 5 rows"


def test_colours_follow_the_system_and_the_button(browser: Browser, study: Path) -> None:
    paper = "return document.getElementById('plot-1').layout.paper_bgcolor"
    browser.open(study, "dark")
    assert browser.run(paper) == "#14171b"
    browser.driver.find_element(By.ID, "theme").click()
    assert browser.run(paper) == "#ffffff"


def test_a_run_loads_and_zooms_by_keys(browser: Browser, run: Path) -> None:
    browser.open(run)
    assert browser.run("return document.documentElement.dataset.ready") == "yes"
    assert browser.complaints() == []
    assert browser.requests() == []
    assert TITLE.replace("'", "") in browser.driver.title
    latency = browser.run("return document.getElementById('frames-plot').data[0].y")
    frames = pd.read_csv(run.with_name("frames.csv"))
    assert latency == frames["latency_us"].tolist()
    extent = (
        "const [a, b] = document.getElementById('frames-plot').layout.xaxis.range; return b - a"
    )
    before = browser.run(extent)
    browser.driver.find_element(By.ID, "frames-plot").send_keys("+")
    assert browser.run(extent) == pytest.approx(before / 2)


def test_the_same_run_is_the_same_bytes(run: Path, program: Program, tmp_path: Path) -> None:
    again = tmp_path / "elsewhere"
    shutil.copytree(run.parent, again)
    write_run_report(again, tmp_path / "again.html", program)
    data = run.read_bytes()
    assert (tmp_path / "again.html").read_bytes() == data
    assert len(data) < LARGEST_BYTES
    assert str(run.parent).encode() not in data


def test_no_run_is_refused(program: Program, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a folder that hvp run has written"):
        write_run_report(tmp_path, tmp_path / "report.html", program)
    assert list(tmp_path.iterdir()) == []


def test_a_boundary_leaves_shared_faces_out() -> None:
    faces = boundary(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
    assert len(faces) == 6
    assert not any(set(face) == {1, 2, 3} for face in faces)
