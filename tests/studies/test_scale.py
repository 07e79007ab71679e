"""Ten thousand runs: what stays in memory, what is drawn, what a page has of them."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from browser import Browser, start

from studies.errors import StudyError
from studies.plot import draw_chart
from studies.record import Record
from studies.report.plots import figure
from studies.report.study_page import MOST_DRAWN, Plot, write_study_report
from studies.store import Records, Store
from studies.study_file import Picture
from studies.study_picture import chart

RUNS = 10_000
LARGEST_BYTES = 5_000_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One for the module."""
    yield from start()


def test_records_are_in_the_store_and_not_in_memory(tmp_path: Path) -> None:
    store = Store(tmp_path)
    kept = Record("ab" * 32, "held", 0, metrics={"a": 1.5})
    refused = Record("", "refused", 2, "no")
    store.put(kept)
    records = Records(store, [kept.address, refused, kept.address])
    assert records == [kept, refused, kept]
    assert records[1:] == [refused, kept]
    assert records[0] is not records[0]
    next(tmp_path.rglob("*.json")).unlink()
    with pytest.raises(StudyError, match="was removed meanwhile"):
        list(records)


def _cells(places: list[str]) -> dict[str, list[float | str]]:
    return {"x": [*places], "y": [float(row) for row in range(RUNS)], "status": ["held"] * RUNS}


@pytest.mark.parametrize("unit", ["mm", ""])
def test_a_picture_has_no_tick_a_run(unit: str, tmp_path: Path) -> None:
    names = [f"{row} mm" if unit else f"v{row}" for row in range(RUNS)]
    drawn = chart("", Picture(x="x"), ["y"], _cells(names), {})
    assert drawn.x_label == ("x [mm]" if unit else "x")
    draw_chart(tmp_path / "plot.svg", drawn)
    ticks = re.findall(r'id="xtick_\d+"', (tmp_path / "plot.svg").read_text(encoding="utf-8"))
    assert 2 <= len(ticks) <= 60


def test_more_lines_than_are_told_apart_are_points(tmp_path: Path) -> None:
    cells = _cells([str(row % 7) for row in range(RUNS)]) | {"z": list(range(RUNS))}
    drawn = chart("", Picture(x="x", colour="z"), ["y"], cells, {})
    (line,) = drawn.panels[0].lines
    assert (line.name, line.joined, len(line.x)) == (f"{RUNS} values", False, RUNS)
    draw_chart(tmp_path / "plot.png", drawn)


def _page(frame: pd.DataFrame, plots: list[Plot], folder: Path) -> Path:
    return write_study_report(
        folder,
        title="many",
        frame=frame,
        units={},
        helps={},
        plots=plots,
        words=[],
        commands=["./hvp study many.toml"],
        versions={"hvp": "0"},
    )


def test_a_page_of_ten_thousand_rows_opens(browser: Browser, tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    figures = {f"figure.number_{column}": rng.random(RUNS) for column in range(90)}
    radius = np.linspace(3, 4, RUNS)
    frame = pd.DataFrame({"probe.radius": radius, "status": "held"} | figures)
    plots = [Plot("probe.radius", f"figure.number_{column}") for column in range(3)]
    page = _page(frame, plots, tmp_path)
    assert page.stat().st_size < LARGEST_BYTES
    browser.open(page)
    assert browser.run("return document.documentElement.dataset.ready") == "yes"
    assert browser.complaints() == []
    y = browser.run("return document.getElementById('plot-3').data[0].y")
    assert y == figures["figure.number_2"].tolist()
    rows = browser.run("return document.querySelectorAll('#rows tbody tr').length")
    assert f"The first {rows} rows; results.csv has the other {RUNS - rows} too." in browser.run(
        "return document.getElementById('table').parentNode.textContent"
    )


def test_of_more_points_than_a_page_bears_some_are_drawn(tmp_path: Path) -> None:
    rows = MOST_DRAWN // 2 + 2
    frame = pd.DataFrame({"x": range(rows), "y": range(rows), "status": "held"})
    plot = Plot("x", "y", front=[1, 2], mark=5)
    (trace, front, mark) = figure(frame, plot, {}, "plot-1", every=2)["data"]
    assert trace["x"] == sorted({*range(0, rows, 2), 1, 5})
    assert (front["x"], mark["x"]) == ([1, 2], [5])
    page = _page(frame, [plot, plot], tmp_path).read_text(encoding="utf-8")
    assert page.count(f"One point in 2 is drawn; results.csv has all {rows}.") == 2
    assert "is drawn" not in _page(frame.head(4), [], tmp_path).read_text(encoding="utf-8")
