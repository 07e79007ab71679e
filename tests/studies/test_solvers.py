"""Who should solve: every solver on every host, and an answer that is its table's."""

from pathlib import Path

import pandas as pd
import pytest

from studies.cli import main
from studies.errors import WRONG_INPUT
from studies.point import Point
from studies.program import Program
from studies.record import Record
from studies.solvers.contest import HOSTS, SOLVERS, Entry, Solver, solvers_of, without_board
from studies.solvers.decision import Outcome, best, row, words

SMALL = ("object.mesh.nodes=80", "frames=300", "solver.iterations=15", "dynamics=false")


def called(label: str) -> Solver:
    return next(solver for solver in SOLVERS if solver.label == label)


def outcome(host: str, solver: str, status: str, load: float, error: float | None) -> Outcome:
    metrics = {
        "deadline.worst_us": load / 2,
        "deadline.budget_us": 2000.0,
        "load.worst_us": load,
        "accuracy.force_of_frame.p95": error,
    }
    record = Record("", status, 0, metrics=metrics)  # type: ignore[arg-type]
    return Outcome(Entry(host, called(solver), Point(Path("s.toml"))), record)


def test_what_needs_a_board_is_left_out(program: Program) -> None:
    scenario = {
        "bus": {"pcie": {"lanes": 1}},
        "transfer": {"method": "dma", "notification": "msi", "packed": False},
        "refinement": {"passes": 2},
        "host": {"pipeline_depth": 0},
    }
    left = without_board(program.reference, scenario)
    assert {"bus.pcie=false", "transfer.method=bursts", "refinement=false"} < set(left)
    assert {"transfer.notification=intx", "transfer.packed=true"} < set(left)
    # A law's passes are the host's own.
    assert "refinement=false" not in without_board(
        program.reference, scenario | {"object": {"model": {"kind": "corotational"}}}
    )
    assert without_board(program.reference, {}) == ()


def test_the_answer_is_the_least_work_that_holds() -> None:
    board = outcome("desktop-2026", "board", "held", 700.0, 0.3)
    late = outcome("desktop-2026", "cg, double", "not held", 50.0, 0.0)
    core = outcome("desktop-2026", "cholesky", "held", 200.0, 0.0)
    assert best([board, late, core]) is core
    first = words([board, late, core])[0]
    assert first.startswith("A core beats the board: a core by cholesky (desktop-2026)")
    assert "0.2 ms" in first
    assert "95 % of its forces are within 30 % of the true model's" in first
    rough = outcome("desktop-2026", "cg, double", "held", 100.0, 0.6)
    assert words([board, rough])[0].startswith(
        "A core beats the board in time, with a force that is 2 times further off"
    )
    slower = outcome("desktop-2026", "cholesky", "held", 900.0, 0.0)
    assert words([board, slower])[0].startswith("The board is faster than a core")
    assert words([board, late])[0].startswith("The board is needed")
    missed = outcome("desktop-2026", "board", "not held", 3000.0, 0.3)
    assert words([missed, core])[0].startswith("A core does what the board does not")
    assert words([missed, late])[0].startswith("Nobody holds every budget")


def test_a_refusal_is_said(program: Program) -> None:
    refused = Record("", "refused", 2, "s.toml:3: host.solver: expected another")
    one = Outcome(
        Entry("thesis-pc", called("superposition, double"), Point(Path("s.toml"))), refused
    )
    core = outcome("thesis-pc", "cholesky", "held", 200.0, 0.0)
    board = outcome("thesis-pc", "board", "held", 700.0, 0.3)
    assert row(one)["message"] == refused.message
    assert "without figures: superposition, double" in words([board, core, one])[1]
    assert program.version


def test_every_solver_runs_on_every_host(
    scenarios: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    settings = [word for setting in SMALL for word in ("--set", setting)]
    scenario = scenarios / "thesis-refined.toml"
    assert main(["study", "solvers", str(scenario), *settings, "--out", str(out),
                 "--store", str(tmp_path / "store"), "--jobs", "2"]) == 0  # fmt: skip
    table = pd.read_csv(out / "results.csv", keep_default_na=False, na_values=[""])
    assert list(zip(table.host, table.solver, strict=True)) == [
        (host, solver.label) for host in HOSTS for solver in solvers_of(host)
    ]
    assert set(table.status) <= {"held", "not held"}, table.message.tolist()
    # The answer's figures are the table's.
    answer = capsys.readouterr().out.splitlines()[0]
    cores = table[(table.solver != "board") & ~table.solver.str.contains("GPU")]
    held = cores[cores.status == "held"]
    least = held.sort_values("load_us").iloc[0]
    assert f"a core by {least.solver} ({least.host})" in answer
    assert f"{least.load_us / 1000:.4g} ms" in answer
    # A force that a proxy makes does not hang on the solve, the displacement does: exact in double
    # precision, to seven digits in single.
    exact = table[table.solver.isin(["cholesky", "inverse, double", "condensed, double"])]
    assert (exact.displacement_error < 1e-9).all()
    single = table[table.solver == "inverse, single"]
    assert single.displacement_error.between(1e-9, 1e-4).all()
    # What is twenty years newer is faster, at everything.
    loads = cores.pivot_table(index="solver", columns="host", values="load_us")
    assert (loads["desktop-2026"] < loads["thesis-pc"]).all()
    assert (out / "report.html").is_file()


def test_what_was_left_out_and_what_wakes_late_is_said() -> None:
    board = outcome("measured", "board", "held", 700.0, 0.3)
    core = outcome("measured", "cholesky", "held", 200.0, 0.0)
    said = words([board, core], ("refinement", "bus.pcie"))
    assert "Without a board there is no refinement, bus.pcie: left out for the hosts." in said
    assert said[-1].startswith("measured wakes as late as its file says")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("thesis-static.toml", "--set", "frames=30"), "no frame in contact was compared"),
        (("wall.toml",), "wall"),
        (("thesis-static.toml", "--set", "host.solver=cg"), "is what is compared"),
        (("thesis-static.toml", "--host", "{scenarios}/slide.toml"), 'host.model = "measured"'),
        (("thesis-static.toml", "--host", "{scenarios}/none.toml"), "none.toml"),
        (("tissue-explicit.toml",), "explicit steps solve nothing"),
    ],
)
def test_where_nothing_can_be_compared_nothing_is_written(
    scenarios: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    said: str,
) -> None:
    words_ = [word.replace("{scenarios}", str(scenarios)) for word in arguments[1:]]
    out = tmp_path / "out"
    scenario = str(scenarios / arguments[0])
    status = main(["study", "solvers", scenario, *words_, "--out", str(out),
                   "--store", str(tmp_path / "store"), "--jobs", "2"])  # fmt: skip
    error = capsys.readouterr().err
    assert status == WRONG_INPUT, error
    assert said in error and error.count("\n") == 1
    assert not out.exists()


def test_wrong_words_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["study", "solvers", str(tmp_path / "none.toml")]) == WRONG_INPUT
    assert main(["study", "solvers", "s.toml", "--jobs", "-1"]) == WRONG_INPUT
    assert "--jobs" in capsys.readouterr().err
