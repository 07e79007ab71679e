"""The Slurm array, its script run by bash with the indices that Slurm would give its tasks."""

import argparse
import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from studies.carry import LocalPool
from studies.carry_dask import DaskCarrier
from studies.commands.scale_options import add_scale_options, carrier_of, export_array
from studies.errors import InputError
from studies.point import Point
from studies.program import Program
from studies.record import Record
from studies.session import Session
from studies.slurm import read_share, write_array
from studies.store import Store

POINTS = 5
SHARES = 2


@pytest.fixture
def points(tmp_path: Path, scenarios: Path) -> list[Point]:
    """Of a scenario of their own, which can change; the last is the first once more."""
    scenario = tmp_path / "wall.toml"
    scenario.write_text((scenarios / "wall.toml").read_text())
    stiffness = [f"wall.stiffness={100 + 10 * n} N/m" for n in range(POINTS)]
    return [Point(scenario, ("frames=20", one)) for one in [*stiffness, stiffness[0]]]


def run_task(script: Path, index: int) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", str(script)],
        env=os.environ | {"SLURM_ARRAY_TASK_ID": str(index)},
        cwd="/",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


def bare(record: Record) -> str:
    return replace(record, wall_s=0.0).to_json()


def test_tasks_of_the_array_do_what_one_machine_does(
    program: Program, session: Session, points: list[Point], tmp_path: Path
) -> None:
    script = tmp_path / "study.sh"
    tasks = session.missing(points)
    assert len(tasks) == POINTS  # each once
    assert write_array(script, tasks, SHARES) == SHARES
    assert f"#SBATCH --array=0-{SHARES - 1}\n" in script.read_text()
    shares = [read_share(tmp_path / "study.sh.points", share, SHARES) for share in range(SHARES)]
    assert sorted(task.address for share in shares for task in share) == sorted(
        task.address for task in tasks
    )
    assert shares[0][0] == tasks[0]
    first = run_task(script, 0)
    assert (first.returncode, first.stdout) == (0, "3 of 3 runs done\n"), first.stderr
    assert len(session.missing(points)) == POINTS - len(shares[0])
    assert run_task(script, 1).returncode == 0
    assert session.missing(points) == []

    ran: list[int] = []
    records = session.run(points, lambda done, total: ran.append(total - done))
    assert ran == [0], "the study has nothing left to do"
    alone = Session(program, Store(tmp_path / "alone"), workers=1).run(points)
    assert [bare(record) for record in records] == [bare(record) for record in alone]


def test_tasks_refuse_what_has_changed_since(
    session: Session, points: list[Point], tmp_path: Path
) -> None:
    script = tmp_path / "study.sh"
    write_array(script, session.missing(points), 1)
    scenario = points[0].scenario
    scenario.write_text(scenario.read_text().replace("[wall]", '[wall]\ndamping = "1 N s/m"'))
    done = run_task(script, 0)
    assert done.returncode == 3
    assert "has changed since the array was written" in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "store").exists()


def test_one_task_a_run_up_to_what_slurm_takes(session: Session, points: list[Point]) -> None:
    tasks = session.missing(points)
    script = points[0].scenario.with_name("study.sh")
    assert write_array(script, tasks) == POINTS
    assert write_array(script, tasks * 300) == 1000
    assert write_array(script, tasks, 50) == POINTS
    with pytest.raises(InputError, match="nothing is left to run"):
        write_array(script, [])


def test_wrong_shares_and_files_end_with_a_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected I/N with 0 <= I < N"):
        read_share(tmp_path / "x", 2, 2)
    with pytest.raises(InputError, match="x: not there"):
        read_share(tmp_path / "x", 0, 1)
    (tmp_path / "x").write_text("{}\n")
    with pytest.raises(InputError, match="x:1: expected a point as --slurm writes it"):
        read_share(tmp_path / "x", 0, 1)


def test_local_pool_runs_nothing_for_nothing() -> None:
    assert list(LocalPool(1).carry([])) == []


def options(*words: str) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    add_scale_options(parser)
    return parser.parse_args(words)


def test_options_say_who_runs(
    session: Session, points: list[Point], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert carrier_of(options()) is None
    assert carrier_of(options("--scheduler", "tcp://x:1")) == DaskCarrier("tcp://x:1")
    for words, expected in {
        ("--array-size", "3"): "expected --slurm FILE.sh with it",
        ("--slurm", "x.sh", "--array-size", "0"): "expected one task or more",
        ("--slurm", "x.sh", "--scheduler", "tcp://x:1"): "expected without --scheduler",
    }.items():
        with pytest.raises(InputError, match=expected):
            carrier_of(options(*words))
    script = tmp_path / "a.sh"
    chosen = options("--slurm", str(script), "--array-size", "2")
    assert carrier_of(chosen) is None
    assert export_array(chosen, session, points) == 0
    assert capsys.readouterr().out == f"{script}: {POINTS} runs in 2 tasks; sbatch {script}\n"
    session.run(points)
    script.unlink()
    assert export_array(chosen, session, points) == 0
    assert capsys.readouterr().out == "Nothing is left to run: the store has every point\n"
    assert not script.exists()
