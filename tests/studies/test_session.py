"""What has been run is not run again; what cannot be run is said."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from study_process import StudyProcess, counting, runs, wait_until

from studies.errors import StudyError
from studies.point import Point
from studies.program import Program
from studies.record import Record
from studies.session import Session
from studies.store import Store

FEW = ("frames=20",)


def _points(scenarios: Path, *stiffness: int) -> list[Point]:
    wall = scenarios / "wall.toml"
    return [Point(wall, (*FEW, f'wall.stiffness="{k} N/m"'), {"K": k}) for k in stiffness]


def test_a_point_is_run_once(program: Program, scenarios: Path, tmp_path: Path) -> None:
    counted = counting(program, tmp_path)
    session = Session(counted, Store(tmp_path / "store"), workers=2)
    # Two of the three are the same run, written in another way.
    points = [
        *_points(scenarios, 100, 200),
        Point(scenarios / "wall.toml", ('wall.stiffness="0.1 N/mm"', *FEW)),
    ]
    records = session.run(points)
    assert [record.status for record in records] == ["held", "held", "held"]
    assert records[0] == records[2] != records[1]
    assert runs(tmp_path) == 2
    assert session.run(points) == records
    assert runs(tmp_path) == 2
    assert records[0].metrics["deadline.frames"] == 20


def test_another_program_is_another_run(program: Program, scenarios: Path, tmp_path: Path) -> None:
    store = Store(tmp_path / "store")
    first = Session(program, store).addresses(_points(scenarios, 100))
    assert Session(counting(program, tmp_path), store).addresses(_points(scenarios, 100)) != first


def test_a_refused_point_says_why_and_runs_nothing(session: Session, scenarios: Path) -> None:
    records = session.run(_points(scenarios, 100, -1))
    assert [record.status for record in records] == ["held", "refused"]
    assert "wall.stiffness" in records[1].message


def test_a_crash_is_tried_again_then_kept_apart(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    crashing = counting(program, tmp_path, "kill -SEGV $$")
    session = Session(crashing, Store(tmp_path / "store"), retries=2)
    (record,) = session.run(_points(scenarios, 100))
    assert record.status == "crashed"
    assert "signal 11" in record.message
    assert runs(tmp_path) == 3
    assert session.run(_points(scenarios, 100)) == [record]
    assert runs(tmp_path) == 3
    session.again = True
    session.run(_points(scenarios, 100))
    assert runs(tmp_path) == 6


def test_a_run_without_an_end_is_ended_with_what_it_started(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    endless = counting(program, tmp_path, f'sleep 60 & echo $! > "{tmp_path}/child"; wait')
    session = Session(endless, Store(tmp_path / "store"), time_limit_s=0.5)
    (record,) = session.run(_points(scenarios, 100))
    assert (record.status, record.message) == ("timed out", "no end within 0.5 s")
    child = Path(f"/proc/{(tmp_path / 'child').read_text().strip()}/stat")
    deadline = time.monotonic() + 5
    while child.exists() and child.read_text().split()[2] != "Z" and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not child.exists() or child.read_text().split()[2] == "Z"
    # The same limit does not try again, a longer one does.
    assert session.run(_points(scenarios, 100)) == [record]
    assert runs(tmp_path) == 1
    session.time_limit_s = 0.6
    session.run(_points(scenarios, 100))
    assert runs(tmp_path) == 2


def test_two_sessions_on_one_store_share_the_work(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    slow = counting(program, tmp_path, "sleep 0.2")
    code = (
        "import sys; from pathlib import Path; from studies.program import Program\n"
        "from studies.point import Point; from studies.session import Session\n"
        "from studies.store import Store\n"
        f"wall = Path('{scenarios}/wall.toml')\n"
        "points = [Point(wall, ('frames=20', f'wall.stiffness={k!r} N/m')) for k in range(9, 17)]\n"
        f"program, store = Program(Path('{slow.path}')), Store(Path('{tmp_path}/store'))\n"
        "session = Session(program, store, workers=2)\n"
        "print([r.status for r in session.run(points)].count('held'))\n"
    )
    both = [
        subprocess.Popen(
            [sys.executable, "-c", code],
            stdout=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parents[2],
        )
        for _ in range(2)
    ]
    assert [process.communicate(timeout=60)[0] for process in both] == ["8\n", "8\n"]
    assert runs(tmp_path) == 8


def test_a_record_is_what_it_was_and_a_foreign_file_is_named(tmp_path: Path) -> None:
    store = Store(tmp_path)
    record = Record("ab" * 32, "held", 0, metrics={"a.b": 1.5, "c": None}, flags=["x"])
    store.put(record, {"frames.csv": b"1\n"})
    assert store.get(record.address) == record
    assert store.file(record.address, "frames.csv").read_bytes() == b"1\n"
    assert store.get("cd" * 32) is None
    path = tmp_path / "ab" / f"{'ab' * 31}.json"
    for foreign in ("", "{", "[]", '{"address": 1}', "\x00"):
        path.write_text(foreign)
        with pytest.raises(StudyError, match=r"\.json: no record of a run: .*; remove it"):
            store.get(record.address)
    path.write_text(Record("ef" * 32, "held", 0).to_json())
    with pytest.raises(StudyError, match="the record of another run"):
        store.get(record.address)


def test_a_full_disk_leaves_no_half_of_a_record(tmp_path: Path) -> None:
    code = (
        "import resource, sys; from pathlib import Path; from studies.record import Record\n"
        "from studies.store import Store\n"
        # As a full disk does, a file may not grow: nobody needs the right to mount one.
        "import signal; signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))\n"
        f"store = Store(Path('{tmp_path}'))\n"
        "try: store.put(Record('ab' * 32, 'held', 0, message='m' * 1000))\n"
        "except OSError as error: print(error.strerror)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=True,
    )
    assert done.stdout == "File too large\n"
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGKILL])
def test_an_end_in_the_middle_loses_nothing(
    program: Program, scenarios: Path, tmp_path: Path, sent: signal.Signals
) -> None:
    counted = counting(program, tmp_path, "sleep 0.1")
    study = StudyProcess(tmp_path, counted, scenarios / "wall.toml", points=24)
    first = study.start()
    wait_until(lambda: runs(tmp_path) >= 6)
    first.send_signal(sent)
    said, _ = first.communicate(timeout=60)
    assert first.returncode == -sent
    assert not (tmp_path / "out").exists()
    if sent == signal.SIGINT:
        assert "the same command goes on" in said
    kept = study.kept()
    before = runs(tmp_path)
    assert 4 <= kept < 24
    study.finish()
    assert runs(tmp_path) - before == 24 - kept
    # The same files as of a study that nobody touched, by one worker.
    StudyProcess(tmp_path, counted, scenarios / "wall.toml", points=24).finish(
        "--jobs", "1", "--out", str(tmp_path / "alone"), "--store", str(tmp_path / "other")
    )
    for name in ("results.csv", "results.parquet", "plot.png"):
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
    # The page but for its command, which says where.
    pages = [(tmp_path / folder / "report.html").read_text() for folder in ("out", "alone")]
    for folder, store, page in zip(("out", "alone"), ("store", "other"), pages, strict=True):
        where = f"--out {tmp_path}/{folder} --store {tmp_path}/{store}"
        assert page.count(where) == 1
    same = [re.sub("--out .* --store .*", "", page) for page in pages]
    assert same[0] == same[1]
