"""hvp compare: what it finds between runs that are known to differ in one thing, and in none."""

import json
import shutil
import subprocess
from pathlib import Path

import pandas as pd
import pytest

from studies import errors
from studies.cli import main
from studies.comparison import compare
from studies.comparison_text import comparison_text
from studies.errors import InputError
from studies.program import Program
from studies.run_folder import RunFolder, read_run

FRAMES = 120


def make_run(program: Program, scenario: Path, out: Path, *overrides: str) -> RunFolder:
    command = [str(program.path), "run", str(scenario), "--out", str(out), "--quiet"]
    lean = ("output.pictures=false", "output.remedies=false", "output.trace_frames=0")
    for override in (*lean, "output.deformation_every_frames=0", *overrides):
        command += ["--set", override]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode in (errors.HELD, errors.NOT_HELD), done.stderr
    return read_run(out)


@pytest.fixture(scope="module")
def runs(
    program: Program, scenarios: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, RunFolder]:
    """The thesis' scene, pressed at once: as it is, again, with other iterations, and shorter."""
    folder = tmp_path_factory.mktemp("runs")
    scene = scenarios / "thesis.toml"
    press = '[{phase = "press", to = ["0 m", "0 m", "45 mm"], duration = "200 ms"}]'
    start = 'probe.start=["0 m", "0 m", "50 mm"]'
    near = (start, f"probe.motion={press}", f"frames={FRAMES}", "reference=false")
    return {
        name: make_run(program, scene, folder / name, *near, *overrides)
        for name, overrides in {
            "base": (),
            "again": (),
            "fewer": ("solver.iterations=10",),
            "short": ("frames=60",),
            "slow": ("budget.period=4 ms",),
            "untold": ("fidelity.numbers=none",),
        }.items()
    }


def test_equal_runs_are_the_same(runs: dict[str, RunFolder]) -> None:
    comparison = compare([runs["base"], runs["again"]])
    assert comparison.same
    text = comparison_text(comparison, 80)
    assert "The same: settings, figures, flags and every frame." in text
    assert "deadline.worst_us" not in text
    assert "deadline.worst_us" in comparison_text(comparison, 80, everything=True)


def test_finds_the_one_setting_and_what_came_of_it(runs: dict[str, RunFolder]) -> None:
    base, fewer = runs["base"], runs["fewer"]
    comparison = compare([base, fewer])
    differing = [row for row in comparison.settings if row.differs]
    assert [(row.key, row.values) for row in differing] == [("solver.iterations", (60, 10))]
    assert differing[0].changes == (0.0, (10 - 60) / 60)
    figures = {row.key: row for row in comparison.figures}
    worst = figures["deadline.worst_us"]
    expected = (base.summary["deadline"]["worst_us"], fewer.summary["deadline"]["worst_us"])
    assert worst.values == expected
    assert worst.changes[1] == pytest.approx((expected[1] - expected[0]) / expected[0])
    # 50 iterations of 1070 clocks at 100 MHz are the whole difference.
    path = {row.key: row for row in comparison.attribution}
    took = [{key: float(row.values[run] or 0) for key, row in path.items()} for run in (0, 1)]
    assert took[0]["fpga solve"] - took[1]["fpga solve"] == pytest.approx(535.0)
    assert [sum(times.values()) for times in took] == pytest.approx(expected)


def test_frames_differ_first_and_most_where_the_files_say(runs: dict[str, RunFolder]) -> None:
    base, fewer = runs["base"], runs["fewer"]
    (frames,) = compare([base, fewer]).frames
    here, there = (pd.read_csv(run.path / "frames.csv") for run in (base, fewer))
    components = ["fx_N", "fy_N", "fz_N"]
    apart = ((here[components] - there[components]) ** 2).sum(axis=1) ** 0.5
    assert apart.max() > 0, "the scene has to touch the body"
    assert frames.first_force is not None and frames.largest_force is not None
    assert frames.first_force.frame == (apart > 0).idxmax()
    assert frames.largest_force.frame == apart.idxmax()
    assert frames.largest_force.difference == pytest.approx(apart.max())
    later = (here["latency_us"] - there["latency_us"]).abs()
    assert frames.largest_latency is not None
    assert frames.largest_latency.difference == pytest.approx(later.max())
    assert frames.common == FRAMES


def test_flags_and_effects_by_who_has_them(
    program: Program, scenarios: Path, runs: dict[str, RunFolder], tmp_path: Path
) -> None:
    other = make_run(
        program,
        scenarios / "thesis.toml",
        tmp_path / "delayed",
        "frames=20",
        "solver.matrix_scaling=diagonal",
    )
    comparison = compare([runs["base"], other])
    assert comparison.effects.of_run == (("dynamics",), ("dynamics", "reference"))
    assert "  reference  only B" in comparison_text(comparison, 80)
    assert comparison.flags.of_run == (tuple(runs["base"].flags), tuple(other.flags))


def test_other_lengths_and_periods_are_held_against_each_other_by_time(
    runs: dict[str, RunFolder],
) -> None:
    comparison = compare([runs["base"], runs["short"], runs["slow"]])
    short, slow = comparison.frames
    assert (short.frames, short.common) == ((FRAMES, 60), 60)
    assert short.first_force is None and short.largest_latency is None and short.differ
    # Ticks of 2 ms and of 4 ms: every second one of the faster run, as long as that lasts.
    assert (slow.frames, slow.common) == ((FRAMES, FRAMES), FRAMES // 2)
    assert slow.largest_force is not None
    assert slow.largest_force.frame == 2 * slow.largest_force.other_frame
    text = comparison_text(comparison, 80)
    assert "A has 120 frames and B 60; 60 are of the same ticks and compared" in text


def test_says_what_cannot_be_compared(runs: dict[str, RunFolder], tmp_path: Path) -> None:
    text = comparison_text(compare([runs["base"], runs["untold"]]), 80)
    assert "no forces in the other run: not compared" in text
    bare = tmp_path / "bare"
    shutil.copytree(runs["base"].path, bare)
    (bare / "frames.csv").unlink()
    (frames,) = compare([runs["base"], read_run(bare)]).frames
    assert frames.left_out == (f"no frames.csv in {bare}",)


def test_partial_run_says_how_far_it_came(runs: dict[str, RunFolder], tmp_path: Path) -> None:
    partial = tmp_path / "partial"
    shutil.copytree(runs["short"].path, partial)
    summary = json.loads((partial / "summary.json").read_text())
    (partial / "summary.json").write_text(
        json.dumps(summary | {"partial": True, "frames_asked": FRAMES})
    )
    comparison = compare([runs["short"], read_run(partial)])
    assert not comparison.same
    assert "interrupted at frame 60 of 120: figures are of those" in comparison_text(comparison, 80)


@pytest.mark.parametrize("width", [80, 120])
def test_tables_fit_the_terminal(runs: dict[str, RunFolder], width: int) -> None:
    comparison = compare(list(runs.values()), lambda _: "µs")
    paths = [len(str(run.path)) for run in runs.values()]
    lines = comparison_text(comparison, width, everything=True).splitlines()
    assert max(len(line) for line in lines[len(paths) :]) <= width


def test_small_differences_are_shown_with_the_digits_that_show_them(
    runs: dict[str, RunFolder], tmp_path: Path
) -> None:
    nearly = tmp_path / "nearly"
    shutil.copytree(runs["base"].path, nearly)
    summary = json.loads((nearly / "summary.json").read_text())
    summary["deadline"]["worst_us"] *= 1 + 1e-9
    (nearly / "summary.json").write_text(json.dumps(summary))
    text = comparison_text(compare([runs["base"], read_run(nearly)]), 80)
    (line,) = [line for line in text.splitlines() if "deadline.worst_us" in line]
    _, here, there, *_ = line.split()
    assert here != there and float(there) == pytest.approx(float(here), rel=1e-8)


def test_json_has_every_figure_with_its_unit(
    runs: dict[str, RunFolder],
    program: Program,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    status = main(["compare", str(runs["base"].path), str(runs["fewer"].path), "--json"])
    document = json.loads(capsys.readouterr().out)
    assert status == errors.HELD  # that runs differ is no failure
    assert document["same"] is False
    assert [row["key"] for row in document["settings"]] == ["solver.iterations"]
    figures = {row["key"]: row for row in document["figures"]}
    assert figures["deadline.worst_us"]["values"][0] == runs["base"].summary["deadline"]["worst_us"]
    if "latency.by_part[].p50_us" in _declared(program):
        assert figures["latency.by_part[fpga].p50_us"]["unit"] == "µs"
        assert figures["force.largest.N"]["unit"] == "N"
    assert document["flags"] == {flag: [0, 1] for flag in runs["base"].flags}


def _declared(program: Program) -> list[str]:
    try:
        return list(program.figures())
    except InputError:
        return []  # of a program that declares none


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("summary.json", None, "no run in it, as summary.json is missing"),
        ("summary.json", "{", "summary.json:1: expected JSON, whole"),
        ("summary.json", "{}", "deadline: expected the summary of a run"),
        ("scenario.resolved.toml", None, "not there, so that nothing says what was run"),
        ("scenario.resolved.toml", "frames = ", "expected a scenario as hvp run writes it"),
        ("frames.csv", "frame,born_us\n0,0\n", "frames.csv:1: latency_us: expected a column"),
        ("frames.csv", "", "frames.csv: expected the frames of a run"),
    ],
)
def test_a_damaged_folder_ends_with_a_line(  # noqa: PLR0913, PLR0917
    runs: dict[str, RunFolder],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    name: str,
    content: str | None,
    expected: str,
) -> None:
    damaged = tmp_path / "damaged"
    shutil.copytree(runs["base"].path, damaged)
    if content is None:
        (damaged / name).unlink()
    else:
        (damaged / name).write_text(content)
    status = main(["compare", str(runs["base"].path), str(damaged)])
    printed = capsys.readouterr()
    assert status == errors.WRONG_INPUT
    assert printed.out == ""
    assert printed.err.count("\n") == 1 and expected in printed.err


def test_one_run_or_none_there_is_wrong_input(
    runs: dict[str, RunFolder], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(runs["base"].path)]) == errors.WRONG_INPUT
    assert "expected two runs or more" in capsys.readouterr().err
    assert main(["compare", str(runs["base"].path), str(tmp_path / "x")]) == errors.WRONG_INPUT
    assert "not there; expected a folder" in capsys.readouterr().err
