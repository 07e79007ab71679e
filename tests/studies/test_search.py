"""Searches against the whole of small spaces, and their files."""

import dataclasses
from itertools import pairwise
from pathlib import Path

import pytest

from studies.cli import main
from studies.device_size import size
from studies.errors import InputError
from studies.program import Figure, Program
from studies.record import Record
from studies.search import Choice, Found, UnmeasuredError, find, judge, neighbours
from studies.search_picture import axes_of, chart
from studies.search_space import Dimension, Search, check_metrics, place_of, search_of
from studies.search_tables import Bound
from studies.search_text import words
from studies.session import Session
from studies.study_file import load

KNOWN = {
    name: Figure(name, "", "") for name in ("deadline.worst_us", "deadline.misses", "cost", "time")
} | {"device.logic_cells": Figure("device.logic_cells", "", "")}

FILE = """
scenario = "{scenario}"
[[set]]
key = "frames"
value = 20
[[axis]]
key = "accelerator.device"
values = ["LFE5U-25F", "EP2S60", "EP2S180"]
[[axis]]
key = "solver.iterations"
values = [60, 120, 240, 280]
[search]
trials = {trials}
seed = 3
[[search.objective]]
metric = "device.logic_cells"
[[search.objective]]
metric = "deadline.worst_us"
direction = "maximise"
[[search.constraint]]
metric = "deadline.misses"
at_most = 0
"""


def _read(folder: Path, text: str) -> Search:
    file = folder / "search.toml"
    file.write_text(text, encoding="utf-8")
    search = search_of(load(file), file)
    check_metrics(search, file, KNOWN)
    return search


def _choices(found: Found) -> list[Choice]:
    return [one.choice for one in found.best]


def test_the_smallest_device_that_holds(session: Session, scenarios: Path, tmp_path: Path) -> None:
    scenario = scenarios / "thesis-static.toml"
    whole = find(_read(tmp_path, FILE.format(scenario=scenario, trials=12)), session)
    assert whole.complete
    assert whole.proposals == 0
    # 1070 clocks an iteration at 100 MHz: 120 are within 2 ms, 240 are not; the LFE5U-25F is
    # refused, and the EP2S180 no better than the EP2S60.
    assert _choices(whole) == [(1, 1)]
    assert "that is all there are" in words(whole, KNOWN)

    searched = find(_read(tmp_path, FILE.format(scenario=scenario, trials=6)), session)
    assert searched.proposals == 6
    assert _choices(searched) == _choices(whole)


class _Model(Session):
    """Answers by a formula in place of runs, with a corner that is refused."""

    runs = 0

    def run(self, points, progress=None):  # type: ignore[no-untyped-def]  # noqa: ARG002
        self.runs += len(points)
        return [self.answer(point) for point in points]

    @staticmethod
    def answer(point) -> Record:  # type: ignore[no-untyped-def]
        x, y = point.columns["x"], point.columns["y"]
        if x + y < 4:
            return Record("", "refused", 2, "too small")
        return Record("", "held", 0, metrics={"cost": 3.0 * x + y, "time": 100.0 / (x + 0.5 * y)})


SPACE = """
scenario = "s.toml"
[[axis]]
key = "x"
values = {values}
[[axis]]
key = "y"
values = {values}
[search]
trials = {trials}
{objectives}
[[search.constraint]]
metric = "time"
at_most = 10
"""
COST = '[[search.objective]]\nmetric = "cost"\n'
TIME = '[[search.objective]]\nmetric = "time"\n'


@pytest.mark.parametrize("objectives", [COST, COST + TIME])
def test_a_search_ends_where_no_step_is_better_and_as_the_whole_space(
    objectives: str, session: Session, tmp_path: Path
) -> None:
    model = _Model(session.program, session.store)
    values = list(range(12))
    text = SPACE.format(values=values, trials=40, objectives=objectives)
    search = _read(tmp_path, text)
    found = find(search, model)
    assert model.runs == len(found.tried) < 144
    whole = find(_read(tmp_path, text.replace("trials = 40", "trials = 144")), model)
    if objectives == COST:
        assert found.best[0].objectives == whole.best[0].objectives
    for best in found.best:
        for step in neighbours(search, best.choice):
            assert not (found.tried[step].feasible and found.tried[step].dominates(best))
    again = find(search, model)
    assert list(again.tried) == list(found.tried)


def test_a_bound_is_violated_by_how_far_off_it_is() -> None:
    assert Bound(metric="a", at_most=10).violation(15) == 0.5
    assert Bound(metric="a", at_most=10).violation(10) == 0
    assert Bound(metric="a", at_least=10).violation(5) == 0.5
    assert Bound(metric="a", at_most=0).violation(3) == 3


def test_what_has_no_figure_keeps_no_bound(tmp_path: Path) -> None:
    search = _read(tmp_path, SPACE.format(values=[1], trials=1, objectives=COST))
    refused = judge(search, (0, 0), Record("", "refused", 2, "too small"))
    unmeasured = judge(search, (0, 0), Record("", "held", 0, metrics={"cost": 1.0, "time": None}))
    assert not refused.feasible
    free = dataclasses.replace(search, constraints=())
    assert not judge(free, (0, 0), Record("", "refused", 2, "too small")).feasible
    assert not unmeasured.feasible


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('metric = "cost"', 'metric = "cots"', ":12: .*did you mean 'cost'"),
        ("at_most = 10", "", ":14: .*expected `at_most`, `at_least`"),
        ("trials = 4", "trials = 0", ":10: search.trials: .*greater than or equal to 1"),
        ("trials = 4", "trails = 4", ":10: search.trails: unknown key; did you mean 'trials'"),
        ("values = [1]", "values = []", ":3: axis: expected one value or more"),
        ('scenario = "s.toml"', "", "scenario: is missing"),
        ("[search]", "[search", "line 9"),
        ("[search]", '[[constraint]]\nthat = "x < y"\n[search]', ":9: constraint: has no place"),
        ("[search]", 'metrics = ["cost"]\n[search]', ":9: axis.metrics: unknown key"),
        ('metric = "cost"', 'metric = "cost"\ndirection = "up"', ":13: search.objective.direction"),
        (COST, "", ":9: search.objective: is missing"),
        ("at_most = 10", "at_most = true", ":16: search.constraint.at_most"),
    ],
)
def test_a_wrong_file_is_named_with_its_line(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    text = SPACE.format(values=[1], trials=4, objectives=COST).replace(old, new)
    with pytest.raises(InputError, match=message):
        _read(tmp_path, text)


def test_a_study_with_a_search_is_one(
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    text = FILE.format(scenario=scenarios / "thesis-static.toml", trials=12)
    Path("small.toml").write_text(text, encoding="utf-8")
    assert main(["study", "small.toml", "--jobs", "2"]) == 0
    shown = capsys.readouterr().out
    assert "found       accelerator.device = EP2S60, solver.iterations = 120" in shown
    assert "12 of 12 combinations" in shown
    assert "accelerator.device = LFE5U-25F" in shown  # just below
    assert "cannot hold this system" in shown
    assert (tmp_path / "studies-out/small/results.csv").read_text().count("\n") == 13
    assert (tmp_path / "studies-out/small/plot.png").read_bytes()[1:4] == b"PNG"
    assert '"name": "Pareto front"' in (tmp_path / "studies-out/small/report.html").read_text()
    Path("small.toml").write_text(text.replace("at_most = 0", "at_most = -1"), encoding="utf-8")
    assert main(["study", "small.toml"]) == 1
    assert "nothing that keeps every bound" in capsys.readouterr().out
    assert main(["study", "small.toml", "--dry-run"]) == 0
    shown = capsys.readouterr().out
    assert "all 12 combinations" in shown
    assert "deadline.worst_us, maximised" in shown
    assert "solver.iterations: 60, 120, 240, 280" in shown


def test_after_few_proposals_steps_go_on_to_the_bound(session: Session, tmp_path: Path) -> None:
    model = _Model(session.program, session.store)
    search = _read(tmp_path, SPACE.format(values=list(range(12)), trials=4, objectives=COST))
    assert sorted(neighbours(search, (0, 5))) == [(0, 4), (0, 6), (1, 5)]
    named = Dimension("device", ("a", "b", "c", "d"), (("device=a",),) * 4)
    assert named.named
    assert not Dimension("rate", ("1 kHz", "2 kHz"), (("rate=1 kHz",), ("rate=2 kHz",))).named
    assert neighbours(dataclasses.replace(search, dimensions=(named,)), (0,)) == [(1,), (2,), (3,)]
    found = find(search, model)
    assert found.proposals == 4
    assert found.steps > 0
    x, y = found.best[0].choice
    # Within the bound x + y/2 >= 10, and neither key can be smaller.
    assert x + 0.5 * y >= 10
    assert x - 1 + 0.5 * y < 10
    assert y == 0 or x + 0.5 * (y - 1) < 10


def test_a_picture_has_every_point_with_figures_and_the_front(
    session: Session, tmp_path: Path
) -> None:
    text = SPACE.format(values=list(range(12)), trials=144, objectives=COST + TIME)
    found = find(_read(tmp_path, text), _Model(session.program, session.store))
    pair = axes_of(found)
    assert pair == ("cost", "time")
    drawn = chart(found, pair, KNOWN)
    within, outside, front = drawn.panels[0].lines
    assert len(within.x) + len(outside.x) == 144 - 10  # x + y < 4 is refused
    assert all(y is not None and y <= 10 for y in within.y)
    assert all(y is not None and y > 10 for y in outside.y)
    assert front.joined
    # Of the front more costs are less time, and none of it is alone.
    pairs = list(zip(front.x, front.y, strict=True))
    assert len(pairs) == len(found.best) > 2
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(pairs))  # type: ignore[operator]
    (limit,) = drawn.panels[0].limits
    assert limit.at == 10
    single = find(_read(tmp_path, text.replace(TIME, "")), _Model(session.program, session.store))
    assert axes_of(single) == ("cost", "time")
    assert [line.name for line in chart(single, ("cost", "time"), KNOWN).panels[0].lines] == [
        "within the bounds",
        "outside",
        "found",
    ]


def test_a_search_takes_every_form_of_an_axis(tmp_path: Path) -> None:
    text = (
        'scenario = "s.toml"\ninclude = ["more.toml"]\nset = ["a=1"]\n'
        '[[axis]]\nkey = "k"\nfrom = "1 N/m"\nto = "4 N/m"\nsteps = 4\n'
        '[[axis]]\nname = "way"\n[[axis.choice]]\nname = "one"\nset = ["b=1", "c=2"]\n'
        '[[axis.choice]]\nname = "other"\nset = ["b=3"]\n[search]\n' + COST
    )
    search = _read(tmp_path, text)
    assert search.combinations == 8
    assert [one.named for one in search.dimensions] == [False, True]
    point = search.point((3, 0))
    assert point.overrides == ("a=1", 'k="4.0 N/m"', "b=1", "c=2")
    assert point.columns == {"k": "4.0 N/m", "way": "one"}
    assert point.includes == (tmp_path / "more.toml",)


class _Crashing(_Model):
    """Nothing ends."""

    @staticmethod
    def answer(point) -> Record:  # type: ignore[no-untyped-def]  # noqa: ARG004
        return Record("", "crashed", -11, "signal 11")


@pytest.mark.parametrize("trials", [3, 100])
def test_of_what_was_not_measured_nothing_is_claimed(
    session: Session, tmp_path: Path, trials: int
) -> None:
    text = SPACE.format(values="[0, 1, 2]", trials=trials, objectives=COST)
    nothing = find(_read(tmp_path, text), _Crashing(session.program, session.store))
    said = words(nothing, KNOWN)
    assert "nothing: no point was measured" in said
    assert f"{len(nothing.tried)} crashed: signal 11" in said
    for certain in ("nearest", "nothing else can be better", "is better"):
        assert certain not in said


class _Measuring(Session):
    """Runs that have some figures and lack others."""

    def run(self, points, progress=None):  # type: ignore[no-untyped-def]  # noqa: ARG002
        self.runs = getattr(self, "runs", 0) + len(points)
        return [Record("", "held", 0, metrics={"cost": 1.0, "time": None}) for _ in points]


@pytest.mark.parametrize("trials", [3, 100])
def test_what_no_run_measures_ends_the_search(
    session: Session, tmp_path: Path, trials: int
) -> None:
    """At the first runs, and with the line that asks for it."""
    text = SPACE.format(values=list(range(40)), trials=trials, objectives=COST)
    search = _read(tmp_path, text)
    measuring = _Measuring(session.program, session.store)
    with pytest.raises(UnmeasuredError, match="time: was not measured in any of the first") as met:
        find(search, measuring)
    assert measuring.runs <= 4
    file = tmp_path / "search.toml"
    place = place_of(search, file, met.value.metric)
    line = int(place.split(":")[1])
    assert 'metric = "time"' in file.read_text(encoding="utf-8").splitlines()[line - 1]


def test_the_device_is_what_an_axis_of_several_keys_sets(tmp_path: Path) -> None:
    """And of what is set twice the last."""
    text = """
scenario = "s.toml"
set = ["accelerator.device=EP2S60"]
[[axis]]
name = "board"
keys = ["accelerator.device", "accelerator.clock"]
values = [["LFE5U-85F", "84 MHz"], ["EP3SE110", "100 MHz"]]
[search]
trials = 4
[[search.objective]]
metric = "device.logic_cells"
"""
    search = _read(tmp_path, text)
    refused = Record("", "refused", 2, "does not fit")
    sizes = [judge(search, (i,), refused).figures["device.logic_cells"] for i in range(2)]
    assert sizes == [
        size("LFE5U-85F", tmp_path)["device.logic_cells"],
        size("EP3SE110", tmp_path)["device.logic_cells"],
    ]
    assert len(set(sizes)) == 2
