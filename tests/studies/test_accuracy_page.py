"""The page of an accuracy study in a real browser: ticks, colours, symbols, front."""

import re
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest
from browser import Browser, start

from studies.report.study_page import Plot, write_study_report


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One for the module."""
    yield from start()


def test_a_row_without_a_figure_is_not_blamed_on_the_axis(tmp_path: Path) -> None:
    status = ["fits", "not measured: no frame in contact", "refused", "fits"]
    frame = pd.DataFrame(
        {"x": [1.0, 2.0, None, 3.0], "y": [1.0, None, None, 0.0], "status": status}
    )
    page = write_study_report(
        tmp_path,
        title="",
        frame=frame,
        units={},
        helps={},
        plots=[Plot("x", "y", log_x=True, log_y=True)],
        words=[],
        commands=[],
        versions={},
    ).read_text(encoding="utf-8")
    assert (
        "3 of 4 rows have no point here (1 fits, not more than 0 on a logarithmic axis; "
        "1 not measured: no frame in contact; 1 refused); the table has them." in page
    )


def test_errors_are_read_as_powers_and_states_by_symbols(browser: Browser, tmp_path: Path) -> None:
    frame = pd.DataFrame(
        {
            "worst_us": [144.7, 204.5, 657.3, 1200.0, 4097.2],
            "displacement_error": [1.97e-1, 3.48e-3, 1.88e-8, 4.4e-12, 1.9e-8],
            "share": [1.0, 0.96, 0.79, 1.125, 0.9],
            "state": ["fits", "fits", "fits", "does not fit", "late"],
        }
    )
    plot = Plot(
        "worst_us",
        "displacement_error",
        colour="share",
        symbol="state",
        log_x=True,
        log_y=True,
        front=[0, 1, 2],
        mark=0,
        budget_x=2000.0,
    )
    write_study_report(
        tmp_path,
        title="What accuracy costs",
        frame=frame,
        units={"worst_us": "us"},
        helps={},
        plots=[plot],
        words=[],
        commands=[],
        versions={},
    )
    browser.open(tmp_path / "report.html")
    assert browser.complaints() == []
    ticks = "return [...document.querySelectorAll('.%stick text')].map(t => t.textContent)"
    errors, times = (browser.run(ticks % axis) for axis in "yx")
    # One style for all of them: no 10n, no 100\N{MICRO SIGN}, no 0.01 beside 1e-4.
    assert errors and all(re.fullmatch("1e[+\N{MINUS SIGN}]\\d+", tick) for tick in errors)
    assert {"200", "500", "1,000", "2,000"} <= set(times)
    drawn = browser.run(
        "return document.getElementById('plot-1')._fullData.map(t => [t.name, t.marker?.symbol,"
        " t.marker?.coloraxis ?? null, [...t.y], t.line?.shape ?? null])"
    )
    states, front, legend = drawn[:3], drawn[3], drawn[5:]
    # A trace that a scale colours has its line in the legend from one that has a colour.
    assert [trace[:3] for trace in legend] == [[*trace[:2], None] for trace in states]
    assert [trace[0] for trace in states] == ["fits", "does not fit", "late"]
    assert len({trace[1] for trace in states}) == 3
    assert {trace[2] for trace in states} == {"coloraxis"}
    assert front[0] == "Pareto front" and front[3] == [1.97e-1, 3.48e-3, 1.88e-8]
    assert front[4] == "hv"
    bar = browser.run(
        "return document.getElementById('plot-1')._fullLayout.coloraxis.colorbar.title.text"
    )
    assert bar == "share"
