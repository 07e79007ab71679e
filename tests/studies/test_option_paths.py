"""Folders and files that options name are looked at before anything is run."""

from pathlib import Path

import pytest

from studies.cli import main
from studies.errors import WRONG_INPUT
from studies.option_paths import folder_name
from studies.program import Program

STUDY = """
scenario = "{scenario}"
[[axis]]
key = "solver.iterations"
values = [20]
"""
SEARCH = """
[search]
[[search.objective]]
metric = "deadline.worst_us"
"""


@pytest.fixture
def scenario(
    tmp_path: Path, scenarios: Path, program: Program, monkeypatch: pytest.MonkeyPatch
) -> str:
    """A scenario's file; the current folder has a file, a study and a search."""
    path = str(scenarios / "thesis-static.toml")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    Path("file").touch()
    study = STUDY.format(scenario=path)
    Path("study.toml").write_text(study, encoding="utf-8")
    Path("search.toml").write_text(study + SEARCH, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "words",
    [
        "sweep SCENARIO solver.iterations=20 --out file",
        "sweep SCENARIO solver.iterations=20 --store file",
        "sweep SCENARIO solver.iterations=20 --plot no/such/folder.png",
        "study study.toml --out file/in",
        "study study.toml --store file",
        "study study.toml --slurm no/such/array.sh",
        "study search.toml --out file",
        "study search.toml --store file/in",
        "study screen SCENARIO --out file",
        "study screen SCENARIO --store file",
        "study accuracy SCENARIO --out file",
        "study accuracy SCENARIO --store file",
        "report . --out no/such/page.html",
        "report . --out file/page.html",
        "questions --store file",
        "questions --wall 1 --out file",
    ],
)
def test_what_cannot_be_written_is_refused_before_anything_runs(
    scenario: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    option = next(word for word in reversed(words.split()) if word.startswith("--"))
    before = sorted(Path.cwd().rglob("*"))
    assert main([scenario if word == "SCENARIO" else word for word in words.split()]) == WRONG_INPUT
    said = capsys.readouterr()
    assert said.err.startswith(f"{option} ")
    assert "expected a f" in said.err
    assert said.err.count("\n") == 1 and not said.out
    assert sorted(Path.cwd().rglob("*")) == before


def test_two_sweeps_of_a_scenario_have_a_folder_each(scenario: str) -> None:
    small = ["--set", "object.mesh.nodes=60", "--set", "frames=20"]
    for axis in ("solver.iterations=10", "solver.matrix_bits=10,12"):
        assert main(["sweep", scenario, axis, *small]) == 0
    made = "sweep-thesis-static+object.mesh.nodes=60+frames=20+solver."
    folders = {path.name for path in Path("studies-out").glob("sweep-*")}
    assert folders == {f"{made}iterations", f"{made}matrix_bits"}


def test_a_folder_is_named_by_what_was_asked_for() -> None:
    assert folder_name(["a", "budget.period=1 ms", "x/y"]) == "a+budget.period=1ms+x-y"
    assert len(folder_name(["k=" + "1" * 300])) <= 120


def test_a_sweep_that_is_refused_everywhere_writes_nothing(
    scenario: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["sweep", scenario, "solver.iterations=0,10", "object.mesh.nodes=3,1000000"]
    assert main([*words, "--out", "out"]) == WRONG_INPUT
    error = capsys.readouterr().err
    assert error.startswith("each of 4 points was refused, the first: ")
    assert error.count("\n") == 1
    assert not Path("out").exists()


def test_equal_values_are_refused_unless_side_by_side(
    scenario: str, capsys: pytest.CaptureFixture[str]
) -> None:
    axes = ["solver.iterations=20,20", "solver.matrix_bits=8,12"]
    assert main(["sweep", scenario, *axes]) == WRONG_INPUT
    assert capsys.readouterr().err == (
        "solver.iterations: 20 stands there twice; with --zip it may\n"
    )
    small = ["--set", "object.mesh.nodes=60", "--set", "frames=20"]
    assert main(["sweep", scenario, *axes, "--zip", *small]) == 0
