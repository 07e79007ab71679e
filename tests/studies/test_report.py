"""Pages in a real browser: no complaint, no network, the table's figures, filters that filter."""

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browser import Browser
from pages import TITLE
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from studies.errors import InputError
from studies.program import Program
from studies.report.body import boundary
from studies.report.run_page import write_run_report

LARGEST_BYTES = 5_000_000


def test_a_study_has_the_figures_of_its_csv(browser: Browser, study_page: Path) -> None:
    browser.open(study_page)
    assert browser.complaints() == []
    assert browser.requests() == []
    assert browser.driver.title == TITLE
    csv = pd.read_csv(study_page.with_name("results.csv"))
    there = csv[csv["status"] != "refused"]
    points = browser.run(
        "const t = document.getElementById('plot-1').data; return [t[0].x, t[0].y]"
    )
    assert points == [
        there["deadline.worst_us"].tolist(),
        there["accuracy.displacement_of_frame.p95"].tolist(),
    ]
    assert "1 refused" in browser.run(
        "return document.getElementById('plots').parentNode.textContent"
    )


def test_rows_are_sorted_and_filtered(browser: Browser, study_page: Path) -> None:
    browser.open(study_page)
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


def test_colours_follow_the_system_and_the_button(browser: Browser, study_page: Path) -> None:
    paper = "return document.getElementById('plot-1').layout.paper_bgcolor"
    browser.open(study_page, "dark")
    assert browser.run(paper) == "#14171b"
    browser.driver.find_element(By.ID, "theme").click()
    assert browser.run(paper) == "#ffffff"


def test_a_run_loads_and_zooms_by_keys(browser: Browser, run_page: Path) -> None:
    browser.open(run_page)
    assert browser.run("return document.documentElement.dataset.ready") == "yes"
    assert browser.complaints() == []
    assert browser.requests() == []
    assert TITLE.replace("'", "") in browser.driver.title
    latency = browser.run("return document.getElementById('frames-plot').data[0].y")
    frames = pd.read_csv(run_page.with_name("frames.csv"))
    assert latency == frames["latency_us"].tolist()
    extent = (
        "const [a, b] = document.getElementById('frames-plot').layout.xaxis.range; return b - a"
    )
    before = browser.run(extent)
    browser.driver.find_element(By.ID, "frames-plot").send_keys("+")
    assert browser.run(extent) == pytest.approx(before / 2)


def test_the_same_run_is_the_same_bytes(run_page: Path, program: Program, tmp_path: Path) -> None:
    again = tmp_path / "elsewhere"
    shutil.copytree(run_page.parent, again)
    write_run_report(again, tmp_path / "again.html", program)
    data = run_page.read_bytes()
    # All that names the folder is the command, which runs as it stands.
    command = f"run {run_page.parent}/scenario.resolved.toml".encode()
    assert data.count(command) == 1
    moved = data.replace(command, f"run {again}/scenario.resolved.toml".encode())
    assert (tmp_path / "again.html").read_bytes() == moved
    assert len(data) < LARGEST_BYTES


def test_a_guests_run_says_what_it_is_without(
    run_page: Path, program: Program, tmp_path: Path
) -> None:
    run = tmp_path / "guest"
    shutil.copytree(run_page.parent, run)
    summary = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    of_a_guest = (
        "title",
        "held",
        "verdict",
        "deadline",
        "latency",
        "jitter",
        "load",
        "attribution",
    )
    kept = {key: summary[key] for key in of_a_guest} | {"guest": {"not_counted": "its processor"}}
    (run / "summary.json").write_text(json.dumps(kept), encoding="utf-8")
    page = write_run_report(run, tmp_path / "report.html", program).read_text(encoding="utf-8")
    for words in ("Not counted: its processor.", "hvp linux ", "Not looked for"):
        assert words in page, words
    assert "None was raised" not in page


def test_no_run_is_refused(program: Program, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a folder that hvp run --out has written"):
        write_run_report(tmp_path, tmp_path / "report.html", program)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "damage",
    [
        ("frames.csv", None, "frames.csv: expected a file of a run"),
        ("frames.csv", "born_us,latency_us\n0,1\n", "frames.csv: damaged: 'frame'"),
        ("summary.json", "{", "summary.json:1: expected JSON, whole"),
        ("scenario.resolved.toml", None, "nothing says what was run"),
        ("trace.json", '"ph":"X","pid":1,"frame":157}', "trace.json: damaged"),
    ],
)
def test_a_damaged_run_is_refused_by_the_name_of_its_file(
    run_page: Path, program: Program, tmp_path: Path, damage: tuple[str, str | None, str]
) -> None:
    name, text, expected = damage
    run = tmp_path / "run"
    shutil.copytree(run_page.parent, run)
    (run / name).unlink()
    if text is not None:
        (run / name).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=expected):
        write_run_report(run, tmp_path / "report.html", program)
    assert not (tmp_path / "report.html").exists()


def test_a_boundary_leaves_shared_faces_out() -> None:
    faces = boundary(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]))
    assert len(faces) == 6
    assert not any(set(face) == {1, 2, 3} for face in faces)
