"""The axes of a sweep as they are written, its table and its picture."""

import csv
from itertools import pairwise
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq  # type: ignore[import-untyped]
import pytest

from studies.axis import parse_axis
from studies.cli import main
from studies.errors import WRONG_INPUT, InputError
from studies.plot import COLOURS, draw_chart
from studies.program import Figure, Program
from studies.record import Record
from studies.report.plots import Plot, figure
from studies.sweep import Sweep, chart

QUICK = ("--set", "frames=20", "--jobs", "2")


@pytest.mark.parametrize(
    ("argument", "texts"),
    [
        ("a.b=1,2,3", ("1", "2", "3")),
        ("a.b=pci-32/33, pci-64/66", ("pci-32/33", "pci-64/66")),
        ("a=[1, 2],[3, 4]", ("[1, 2]", "[3, 4]")),
        ("a=\"x,y\",'['", ('"x,y"', "'['")),
        ("a=1:3:3", ("1", "2", "3")),
        ("a=1:1000:4:log", ("1", "10", "100", "1000")),
        ("a=0.5:2ms:4", ("0.5 ms", "1 ms", "1.5 ms", "2 ms")),
        ("a=0.5 ms:1 ms:2", ("0.5 ms", "1 ms")),
    ],
)
def test_values_are_split_and_ranges_counted(argument: str, texts: tuple[str, ...]) -> None:
    assert parse_axis(argument).texts == texts


def test_a_range_of_whole_numbers_has_none_twice() -> None:
    assert parse_axis("a=1:3:5", whole_numbers=True).texts == ("1", "2", "3")


def test_values_are_numbers_where_they_can_be() -> None:
    assert parse_axis("a=1,2.5,true,EP2S60").values == (1, 2.5, True, "EP2S60")
    axis = parse_axis("a=1 ms,2 ms")
    assert (axis.places, axis.unit) == ((1.0, 2.0), "ms")
    assert parse_axis("a=1 ms,2 us").places == ("1 ms", "2 us")


@pytest.mark.parametrize("argument", ["a", "=1", "a=1,,2", "a=[1,2", "a=1 ms:2 s:3", "a=0:1:3:log"])
def test_what_is_no_axis_is_refused(argument: str) -> None:
    with pytest.raises(InputError, match="expected"):
        parse_axis(argument)


def test_a_product_has_every_combination_and_zip_pairs() -> None:
    axes = (parse_axis("a=1,2"), parse_axis("b=3,4"))
    product = [point.overrides for point in Sweep(Path("s"), axes).points()]
    assert product == [("a=1", "b=3"), ("a=1", "b=4"), ("a=2", "b=3"), ("a=2", "b=4")]
    zipped = [point.overrides for point in Sweep(Path("s"), axes, zipped=True).points()]
    assert zipped == [("a=1", "b=3"), ("a=2", "b=4")]
    with pytest.raises(InputError, match="as many values"):
        Sweep(Path("s"), (axes[0], parse_axis("b=1,2,3")), zipped=True).choices()


@pytest.fixture
def folder(tmp_path: Path, program: Program, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A current folder of the test's own, with the program to be found."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    return tmp_path


def test_time_grows_by_the_clocks_of_an_iteration(
    folder: Path, scenarios: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scenario = str(scenarios / "thesis-static.toml")
    words = ["sweep", scenario, "solver.iterations=20,40,60", "accelerator.device=EP2S60,LFE5U-25F"]
    assert main([*words, *QUICK, "--out", "out"]) == 0
    shown = capsys.readouterr().out
    assert "deadline.worst_us [µs]" in shown
    assert "3 without figures: " in shown
    with (folder / "out/results.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["held", "refused"] * 3
    worst = [float(row["deadline.worst_us"]) for row in rows if row["status"] == "held"]
    # 1070 clocks an iteration at 100 MHz.
    assert [b - a for a, b in pairwise(worst)] == pytest.approx([214, 214])
    schema = pq.read_schema(folder / "out/results.parquet")
    assert schema.field("deadline.worst_us").metadata[b"unit"].decode() == "µs"
    assert (folder / "out/sweep.png").read_bytes().startswith(b"\x89PNG")

    before = {path: path.read_bytes() for path in (folder / "out").iterdir()}
    assert main([*words, *QUICK, "--out", "out"]) == 0
    assert {path: path.read_bytes() for path in (folder / "out").iterdir()} == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["solver.iteratons=1,2"], 'did you mean "iterations"'),
        (
            ["solver.iterations=20", "--metrics", "deadline.wrst_us"],
            "did you mean 'deadline.worst_us'",
        ),
        (["solver.iterations=20", "--plot", "x.xyz"], "expected a name that ends in .png"),
        (["solver.iterations=20", "solver.iterations=30"], "expected one axis a key"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_wrong_input_is_one_line(
    scenarios: Path, words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", str(scenarios / "thesis-static.toml"), *words, *QUICK]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not Path("studies-out/sweep-thesis-static").exists()


def test_what_a_design_takes_is_a_figure_by_its_type(
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    where = ["--store", str(tmp_path / "store"), "--out", str(tmp_path / "out"), *QUICK]
    command = ["sweep", str(scenarios / "thesis-static.toml"), "solver.matrix_bits=8,12", *where]
    assert main([*command, "--metrics", "resources[M4K].used"]) == 0
    with (tmp_path / "out" / "results.csv").open(encoding="utf-8") as file:
        used = [int(row["resources[M4K].used"]) for row in csv.DictReader(file)]
    # 8 bits leave more words in a block than 12.
    assert 0 < used[0] < used[1]
    capsys.readouterr()
    for name in ("resources[].used", "latency.by_part[fpga].worst_us"):
        assert main([*command, "--metrics", name]) == WRONG_INPUT
        assert f"{name}: is a list" in capsys.readouterr().err


def _records(loads: list[float], budgets: list[float]) -> list[Record]:
    return [
        Record("", "held", 0, metrics={"load.worst_us": load, "deadline.period_us": budget})
        for load, budget in zip(loads, budgets, strict=True)
    ]


def test_every_time_that_has_a_budget_is_drawn_with_it(tmp_path: Path) -> None:
    sweep = Sweep(Path("s.toml"), (parse_axis("bus.kind=a,b,c"),))
    known = {"load.worst_us": Figure("load.worst_us", "us", "")}
    loads = [1.0, 20.0, 3.0]
    drawn = chart("", sweep, _records(loads, [2000.0] * 3), ["load.worst_us"], known)
    assert [(limit.at, limit.name) for limit in drawn.panels[0].limits] == [(2000.0, "budget")]
    # Of a budget that the sweep changes, each place has its own.
    drawn = chart("", sweep, _records(loads, [1.0, 2.0, 3.0]), ["load.worst_us"], known)
    assert [line.level for line in drawn.panels[0].lines] == [False, True]
    # Names are choices: a bar each, and no line between what has no order.
    draw_chart(tmp_path / "bars.svg", drawn)
    bars = (tmp_path / "bars.svg").read_text(encoding="utf-8")
    numbers = Sweep(Path("s.toml"), (parse_axis("solver.iterations=1,2,3"),))
    drawn = chart("", numbers, _records(loads, [2000.0] * 3), ["load.worst_us"], known)
    draw_chart(tmp_path / "lines.svg", drawn)
    lines = (tmp_path / "lines.svg").read_text(encoding="utf-8")
    assert bars.count(f"fill: {COLOURS[0].lower()}") >= len(loads)
    assert f"stroke: {COLOURS[0].lower()}" in lines
    assert f"stroke: {COLOURS[0].lower()}" not in bars


def test_a_report_has_bars_over_names_and_hatches_what_did_not_hold() -> None:
    frame = pd.DataFrame(
        {"who": ["a", "b"], "n": [1, 2], "t": [3.0, 4.0], "status": ["held", "not held"]}
    )
    (bars,) = figure(frame, Plot("who", "t"), {}, "plot-1")["data"]
    assert (bars["type"], bars["marker"]["pattern"]["shape"]) == ("bar", ["", "/"])
    assert "mode" not in bars
    # Numbers have an order, and two of a name have no bar.
    assert figure(frame, Plot("n", "t"), {}, "plot-1")["data"][0]["type"] == "scatter"
    twice = pd.concat([frame, frame])
    assert figure(twice, Plot("who", "t"), {}, "plot-1")["data"][0]["type"] == "scatter"


def test_a_study_may_ask_for_the_probability_of_a_miss(
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Of `hvp misses`: the wider the wake-ups spread, the more probable it is."""
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    study = tmp_path / "misses.toml"
    study.write_text(
        f"""scenario = "{scenarios / "jittery-host.toml"}"
command = "misses"
[[set]]
key = "frames"
value = 200
[[axis]]
key = "host.wake_up.spread"
values = [2.5, 4]
"""
    )
    out = tmp_path / "out"
    assert main(["study", str(study), "--store", str(tmp_path / "s"), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "answered" in said and "Of 2 points 2 have an answer." in said
    with (out / "results.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    few, many = (float(row["share"]) for row in rows)
    assert 0 < few < many < 1
    assert all(float(r["low"]) < float(r["share"]) < float(r["high"]) for r in rows)
