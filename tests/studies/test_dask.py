"""Runs carried by dask.distributed, on 127.0.0.1: a scheduler, two workers, and kill -9 of each."""

import os
import shlex
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from studies.carry import carry_out
from studies.carry_dask import DaskCarrier
from studies.errors import FAILED, StudyError
from studies.point import Point
from studies.program import Program
from studies.record import Record
from studies.session import Session
from studies.store import Store

TOP = Path(__file__).resolve().parents[2]
POINTS = 24
LIMIT_S = 40
ENVIRONMENT = os.environ | {
    "PYTHONPATH": str(TOP),
    "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5s",
    "DASK_DISTRIBUTED__WORKER__MEMORY__TERMINATE": "False",
}


def free_port() -> int:
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        port: int = bound.getsockname()[1]
        return port


def until(holds: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + LIMIT_S
    while not holds():
        assert time.monotonic() < end, f"{what}: not within {LIMIT_S} s"
        time.sleep(0.02)


@dataclass
class Cluster:
    """Processes of Dask, which die with the test."""

    folder: Path
    port: int = field(default_factory=free_port)
    environment: Mapping[str, str] = field(default_factory=lambda: ENVIRONMENT)
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def address(self) -> str:
        return f"tcp://127.0.0.1:{self.port}"

    def start(self, what: str, *words: str) -> subprocess.Popen[bytes]:
        with (self.folder / f"dask-{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-B", "-m", f"distributed.cli.dask_{what}", *words],
                stdout=log,
                stderr=log,
                env=self.environment,
                cwd=self.folder,
            )
        self.processes.append(process)
        return process

    def scheduler(self) -> subprocess.Popen[bytes]:
        process = self.start(
            "scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard"
        )

        def listens() -> bool:
            with socket.socket() as probe:
                return probe.connect_ex(("127.0.0.1", self.port)) == 0

        until(listens, "a scheduler that listens")
        return process

    def worker(self) -> subprocess.Popen[bytes]:
        words = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "20"]
        return self.start("worker", self.address, *words)

    def end(self) -> None:
        for process in self.processes:
            process.kill()
        for process in self.processes:
            process.wait(10)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    made = Cluster(tmp_path)
    try:
        yield made
    finally:
        made.end()


@dataclass
class Counted:
    """A program that takes its time and says when it runs something, and with which settings."""

    program: Program
    log: Path

    def executions(self) -> list[str]:
        """The settings of each run, in the order in which they began."""
        return self.log.read_text().splitlines() if self.log.exists() else []


@pytest.fixture
def counted(program: Program, tmp_path: Path) -> Counted:
    path, log = tmp_path / "counted-hvp", tmp_path / "executions"
    path.write_text(
        f"""#!/bin/bash
if [[ $1 == run ]]; then
  for word; do [[ $word != wall.stiffness=* ]] || echo "$word" >> {shlex.quote(str(log))}; done
  sleep 0.1
fi
exec {shlex.quote(str(program.path))} "$@"
"""
    )
    path.chmod(0o755)
    return Counted(Program(path), log)


@pytest.fixture
def settings() -> list[str]:
    return [f"wall.stiffness={100 + 10 * n} N/m" for n in range(POINTS)]


def bare(record: Record) -> str:
    return replace(record, wall_s=0.0).to_json()


@contextmanager
def driver(
    counted: Counted, scenario: Path, store: Path, cluster: Cluster, settings: list[str]
) -> Iterator[subprocess.Popen[str]]:
    program = str(counted.program.path)
    words = [program, str(scenario), str(store), cluster.address, *settings]
    process = subprocess.Popen(
        [sys.executable, "-B", str(TOP / "tests/studies/scale_driver.py"), *words],
        env=ENVIRONMENT,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait(10)


def test_death_of_worker_driver_and_scheduler_costs_no_finished_run(
    counted: Counted, cluster: Cluster, scenarios: Path, tmp_path: Path, settings: list[str]
) -> None:
    scenario, store = scenarios / "wall.toml", tmp_path / "store"
    points = [Point(scenario, ("frames=20", setting)) for setting in settings]
    here = Session(counted.program, Store(store))
    of_address = dict(zip((str(a) for a in here.addresses(points)), settings, strict=True))
    snapshots: list[tuple[set[str], int]] = []

    def finished() -> set[str]:
        return {of_address[p.parent.name + p.stem] for p in store.glob("??/*.json")}

    def kill(process: subprocess.Popen[bytes] | subprocess.Popen[str], after: int) -> None:
        until(lambda: len(finished()) >= after, f"{after} runs finished")
        process.send_signal(signal.SIGKILL)
        process.wait(10)
        snapshots.append((finished(), len(counted.executions())))

    scheduler, worker, _ = cluster.scheduler(), cluster.worker(), cluster.worker()
    with driver(counted, scenario, store, cluster, settings) as first:
        kill(worker, 4)
        kill(first, 8)
    cluster.worker()
    with driver(counted, scenario, store, cluster, settings) as second:
        kill(scheduler, 14)
        _, error = second.communicate(timeout=LIMIT_S)
    assert second.returncode == FAILED
    assert error.startswith(f"hvp: the scheduler at {cluster.address} is gone; ")
    assert error.count("\n") == 1
    cluster.end()
    cluster.scheduler(), cluster.worker(), cluster.worker()
    with driver(counted, scenario, store, cluster, settings) as third:
        assert third.wait(LIMIT_S) == 0

    assert finished() == set(settings)
    for done, began in snapshots:
        assert done, "something was finished before the kill"
        assert not done & set(counted.executions()[began:]), "run again although it was finished"
    # A kill costs at most what both workers had at hand.
    assert len(counted.executions()) <= POINTS + 2 * len(snapshots)

    before = len(counted.executions())
    records = here.run(points)
    assert len(counted.executions()) == before
    alone = Session(counted.program, Store(tmp_path / "alone"), workers=1).run(points)
    assert [bare(record) for record in records] == [bare(record) for record in alone]


def test_a_task_that_is_handed_out_again_finds_its_record(
    counted: Counted, scenarios: Path, tmp_path: Path
) -> None:
    """As Dask does with those of a worker that died before anybody had fetched the result."""
    point = Point(scenarios / "wall.toml", ("frames=20", "wall.stiffness=100 N/m"))
    (task,) = Session(counted.program, Store(tmp_path / "store")).missing([point])
    assert carry_out(task) == carry_out(task)
    assert len(counted.executions()) == 1


def test_workers_that_would_do_something_else_are_found(
    program: Program, cluster: Cluster, scenarios: Path, tmp_path: Path
) -> None:
    """Another program under the same name, as after an update on one machine of two."""
    path = tmp_path / "hvp"
    path.write_text(f'#!/bin/bash\nexec {shlex.quote(str(program.path))} "$@"\n')
    path.chmod(0o755)
    cluster.scheduler(), cluster.worker()
    point = Point(scenarios / "wall.toml", ("frames=20",))
    carrier = DaskCarrier(cluster.address, connect_s=5)
    session = Session(Program(path), Store(tmp_path / "store"), carrier=carrier)
    tasks = session.missing([point])
    path.write_text(path.read_text() + "# newer\n")
    with pytest.raises(StudyError, match="a worker has another program at"):
        list(carrier.carry(tasks))
    assert not list((tmp_path / "store").rglob("*.json"))
    # Nothing of it stays behind: as it is now, the program is run.
    (record,) = Session(Program(path), session.store, carrier=carrier).run([point])
    assert record.status == "held"


def test_a_cluster_that_knows_nothing_of_studies_is_told_what_it_needs(
    cluster: Cluster, session: Session, scenarios: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cluster.environment = {key: value for key, value in ENVIRONMENT.items() if key != "PYTHONPATH"}
    cluster.scheduler()
    session.carrier = DaskCarrier(cluster.address, connect_s=5)
    with pytest.raises(StudyError, match="have to be started with PYTHONPATH="):
        session.run([Point(scenarios / "wall.toml", ("frames=20",))])
    assert capsys.readouterr().err == f"{cluster.address} has no workers yet: waiting for one\n"


def test_no_scheduler_is_one_line(session: Session, scenarios: Path) -> None:
    point = Point(scenarios / "wall.toml", ("frames=20",))
    session.carrier = DaskCarrier(f"tcp://127.0.0.1:{free_port()}", connect_s=0.5)
    with pytest.raises(StudyError, match=r"no scheduler at tcp://127.0.0.1:\d+ within 0.5 s"):
        session.run([point])
    session.carrier = DaskCarrier("nonsense")
    with pytest.raises(StudyError, match="expected an address, tcp://HOST:PORT"):
        session.run([point])
