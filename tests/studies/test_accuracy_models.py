"""What accuracy costs across models: the families, the mesh's own error, and a small run."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from studies.accuracy.families import LAWS, SOLVERS, Member, members
from studies.accuracy.fields import Array, Field, difference
from studies.accuracy.grid import PASSES
from studies.accuracy.measured import Measured, Scene, front, fullest_asked
from studies.accuracy.mesh_error import (
    Limit,
    MeshError,
    Size,
    frames_to_rest,
    limit_of,
    settled,
)
from studies.accuracy.model_answer import words
from studies.cli import main
from studies.commands.accuracy_models import NAMES, SCENES
from studies.errors import HELD, WRONG_INPUT
from studies.program import Program, Resolved
from studies.record import Record
from studies.session import Session

TRUTH = "neo-hookean-log"
COARSE = ("object.mesh.nodes=100", "frames=90")


def measured(
    time_us: float, error: float, law: str = TRUTH, solver: str = "cholesky", state: str = "fits"
) -> Measured:
    metrics: dict[str, float | int | bool | str | None] = {
        "deadline.worst_us": time_us,
        "accuracy.frames": 10,
        "accuracy.force_of_frame.p95": error,
        "accuracy.displacement_of_frame.p95": error / 2,
    }
    record = Record("a", "held", 0, metrics=metrics)
    return Measured(Member(law, solver, {PASSES: 2}), record, record, state)


def sizes_of(limit: float, factor: float, order: float, scatter: float = 0.0) -> list[Size]:
    """Forces with exactly that order in the elements' length."""
    each = []
    for nodes in (250, 500, 1000, 2000):
        force = limit + factor * nodes ** (-order / 3)
        each.append(Size((nodes, nodes + 1, nodes + 2), (force - scatter, force, force + scatter)))
    return each


def test_every_family_is_tried_once() -> None:
    every = members(small=False)
    assert len({member.overrides for member in every}) == len(every)
    assert {member.solver for member in every} == set(SOLVERS)
    assert {m.solver for m in every if m.way.endswith("renewed")} == {"board", "cholesky"}
    for solver in SOLVERS:
        assert set(LAWS) <= {member.law for member in every if member.solver == solver}
    few = members(small=True)
    assert len(few) < 12 and {"board", "cholesky", "explicit"} == {m.solver for m in few}
    single = few[0]
    assert single.family == "linear, board, one solve"
    assert {"object.model=false", "refinement=false"} <= set(single.overrides)


def test_the_scenes_take_every_member(program: Program) -> None:
    """None is refused but for what a board does not hold, which resolving does not ask."""
    overrides = [m.overrides for m in members(small=False)]
    for name in NAMES:
        found = list(program.resolve(SCENES / f"{name}.toml", overrides))
        assert len(found) == len(overrides)
        assert all(isinstance(one, Resolved) for one in found), found


@pytest.mark.parametrize("order", [0.8, 1.0, 2.0])
def test_the_limit_is_extrapolated_with_the_order_that_is_there(order: float) -> None:
    found = limit_of(sizes_of(3.0, 5.0, order))
    assert found is not None and found.order == pytest.approx(order)
    assert found.force == pytest.approx(3.0)
    finest = 3.0 + 5.0 * 2000 ** (-order / 3)
    assert found.doubt == pytest.approx(finest - 3.0)


def test_no_order_is_read_out_of_scatter() -> None:
    sizes = sizes_of(3.0, 5.0, 1.0, scatter=0.2)
    last, before = sizes[-1].mean, sizes[-2].mean
    # The last change is smaller than what lies between meshes of one size.
    assert limit_of(sizes) == Limit(last, max(sizes[-1].scatter, before - last))
    turning = [Size((n,), (force,)) for n, force in ((1, 3.0), (2, 3.5), (4, 3.25))]
    assert limit_of(turning) == Limit(3.25, 0.25)
    growing = [Size((n,), (force,)) for n, force in ((1, 3.0), (2, 3.25), (4, 3.75))]
    assert limit_of(growing) == Limit(3.75, 0.5)
    assert limit_of(sizes[:1]) is None
    assert settled(sizes, 0.5) and not settled(sizes, 1e-3) and not settled(sizes[:1], 1.0)


def test_the_band_is_of_meshes_of_that_size() -> None:
    """One that hits the limit by chance does not make its size exact."""
    own = Size((450, 500, 550), (2.2, 2.0, 1.9))
    mesh = MeshError((own, own), 2.0, own, Limit(2.0, 0.02), 0.3)
    assert mesh.force == 0 and mesh.band == pytest.approx((0.0, 0.11))
    assert "not extrapolated, as they show no order, from meshes of about 500, 500" in mesh.words
    assert "displacement 0.3, against the finest mesh" in mesh.words
    unknown = MeshError(message="no hold")
    assert unknown.band is None and unknown.words.endswith("is not known: no hold.")


def test_a_scene_rests_at_the_end_of_its_first_hold() -> None:
    strokes = [("approach", "20 ms"), ("hold", "1 s"), ("press", "0.1 s"), ("hold", "50 ms")]
    motion = [{"phase": phase, "duration": time} for phase, time in (*strokes, ("hold", "1 s"))]
    scenario = {"budget": {"period": "2 ms"}, "probe": {"motion": motion}}
    assert frames_to_rest(scenario) == 585
    assert frames_to_rest({**scenario, "probe": {"motion": motion[:3]}}) is None
    assert frames_to_rest({"wall": {}}) is None


def quadratic(corners: Array, elements: Array) -> tuple[Array, Array]:
    """With a node of its own in the middle of each element's edges, in VTK's order."""
    points, ten = list(corners), []
    for element in elements:
        middles = []
        for a, b in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)):
            middles.append(len(points))
            points.append((corners[element[a]] + corners[element[b]]) / 2)
        ten.append([*element, *middles])
    return np.array(points), np.array(ten)


def test_fields_on_two_meshes_are_held_against_each_other() -> None:
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    six = np.array(
        [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]]
    )
    five = np.array([[0, 1, 2, 4], [1, 2, 3, 7], [1, 4, 5, 7], [2, 4, 6, 7], [1, 2, 4, 7]])
    gradient = np.array([[1.0, 2.0, 0.0], [0.0, -1.0, 1.0], [3.0, 0.0, 1.0]])
    field = Field(corners, six, corners @ gradient)
    other = Field(corners, five, corners @ gradient)
    # A linear field is the same on any mesh of linear elements.
    assert difference(field, other) == pytest.approx(0.0, abs=1e-12)
    assert field.volumes.sum() == pytest.approx(1.0) == other.volumes.sum()
    # A quadratic one is the same on any mesh of quadratic elements, but not on linear ones.
    ten, more = quadratic(corners, six)
    fewer, less = quadratic(corners, five)
    curved = Field(ten, more, ten @ gradient * ten)
    also = Field(fewer, less, fewer @ gradient * fewer)
    assert difference(curved, also) == pytest.approx(0.0, abs=1e-12)
    assert curved.volumes.sum() == pytest.approx(1.0)
    assert difference(Field(corners, six, corners @ gradient * corners), curved) > 0.1
    larger = Field(corners, five, 1.25 * corners @ gradient)
    assert difference(field, larger) == pytest.approx(0.2)


def test_the_words_say_what_an_error_costs() -> None:
    found = [
        measured(100, 0.2, law="linear"),
        measured(300, 0.05),
        measured(200, 0.06, state="late"),
        measured(900, 0.005, solver="explicit"),
        measured(50, 0.001, state="breaks down"),
    ]
    seven, one, linear, mesh = words("body", found, MeshError(message="why"), TRUTH)
    assert "7 % in 95 % of the frames costs at least 0.3 ms: neo-hookean-log, host chol" in seven
    assert "1 % in 95 % of the frames costs at least 0.9 ms" in one
    assert "the linear law's force is 20 % off at best, its displacement 10 %" in linear
    assert mesh == "body: The mesh's own error is not known: why."
    nothing = words("body", found[:1], MeshError(), TRUTH)
    assert "no member reaches a force error of 7 %" in nothing[0]
    assert front(found, "force_p95") == [found[0], found[2], found[1], found[3]]


def test_a_refusal_says_how_full_the_board_would_be() -> None:
    assert fullest_asked("hold: 324 M4K of 255, 258 multipliers of 144; fits") == 324 / 255
    assert fullest_asked("hold: 258 multipliers of 144") is None


@pytest.mark.parametrize("solver", ["board", "cholesky"])
def test_a_late_member_has_the_errors_of_a_host_that_is_not(session: Session, solver: str) -> None:
    """Else its skipped ticks would be errors of its law."""
    settings = (*COARSE, "host.sustained_rate=20 Mflop/s")
    member = Member(TRUTH, solver, {PASSES: 2})
    sphere = SCENES / "sphere.toml"
    (slow,) = Scene(session, sphere, settings, TRUTH).run([member])
    (fast,) = Scene(session, sphere, COARSE, TRUTH).run([member])
    assert (slow.state, fast.state) == ("late", "fits")
    assert slow.record.metrics["deadline.skipped_ticks"]
    assert (slow.worst_us or 0) > 10 * (fast.worst_us or 0)
    assert slow.error("force_mean_rel") == fast.error("force_mean_rel")
    skipped = float(str(slow.record.metrics["accuracy.force_rel"]))
    assert skipped > 2 * (slow.error("force_mean_rel") or 1)


def test_what_does_not_fit_is_measured_elsewhere(session: Session) -> None:
    scene = Scene(session, SCENES / "sphere.toml", (*COARSE, "accelerator.partitions=7"), TRUTH)
    small = members(small=True)
    (found,) = scene.run([next(m for m in small if m.law == TRUTH and m.solver == "board")])
    assert found.state == "does not fit" and found.drawn
    assert "cannot hold" in found.message and found.worst_us


def test_a_small_study_of_models(
    program: Program,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    command = ["study", "accuracy", "--models", "--small", "--most-nodes", "240"]
    command += ["--set", "object.mesh.nodes=100", "--store", str(tmp_path / "store")]
    assert main([*command, "--out", str(tmp_path / "a")]) == HELD
    said = capsys.readouterr().out
    assert "sphere, against neo-hookean-log: a force error of 7 %" in said and "Left out:" in said

    with (tmp_path / "a" / "results.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(members(small=True)) and {row["scene"] for row in rows} == {"sphere"}
    of = {(row["law"], row["solver"], row[PASSES]): row for row in rows}
    board = of[TRUTH, "board", "2"]
    # The law that is taken as true has its solver's error alone; another has its own too.
    assert float(board["force_p95"]) < 0.02 < float(of["linear", "board", "2"]["force_p95"])
    assert float(of["mass-spring", "explicit", ""]["force_p95"]) > 0.1
    assert 0 < float(board["memory_share"]) <= 1 and float(board["set_up_us"]) > 0
    assert not of[TRUTH, "cholesky", "2"]["memory_share"]
    assert float(board["load_median_us"]) <= float(board["load_worst_us"])
    assert float(board["median_us"]) <= float(board["worst_us"])

    with (tmp_path / "a" / "meshes.csv").open(encoding="utf-8") as file:
        meshes = list(csv.DictReader(file))
    assert len(meshes) == 9 and all(math.isfinite(float(row["force_N"])) for row in meshes)
    # The scene's own size, and twice quadratic ones.
    assert [row["elements"] for row in meshes] == ["linear"] * 3 + ["quadratic"] * 6

    # The same command finds every run in the store and writes the same bytes.
    stored = {path: path.stat().st_mtime_ns for path in (tmp_path / "store").rglob("*.json")}
    assert main([*command, "--out", str(tmp_path / "b")]) == HELD
    again = {path: path.stat().st_mtime_ns for path in (tmp_path / "store").rglob("*.json")}
    assert again == stored
    for name in ("results.csv", "meshes.csv", "wall-clock.csv", "models.png"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert (tmp_path / "a" / "sphere" / "report.html").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--truth", "fung", "SCENE"], "--truth: belongs to --models"),
        (["--models", "--full"], "--full: does not go with --models"),
        (["--models", "--repeats", "3"], "--repeats: does not go with --models"),
        (["--models", "--settled", "1"], "--settled: expected a share from 0 to 1"),
        ([], "SCENARIO.toml: expected a scenario, or --models"),
        (["--models", "WALL"], "expected a scenario of a soft body that is touched"),
    ],
)
def test_wrong_input_is_one_line(  # noqa: PLR0913, PLR0917
    arguments: list[str],
    said: str,
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    files = {"SCENE": str(SCENES / "sphere.toml"), "WALL": str(scenarios / "wall.toml")}
    command = ["study", "accuracy", *(files.get(word, word) for word in arguments)]
    command += ["--store", str(tmp_path / "store"), "--out", str(tmp_path / "out")]
    assert main(command) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert len(errors.splitlines()) == 1 and said in errors
    assert not (tmp_path / "out").exists()
