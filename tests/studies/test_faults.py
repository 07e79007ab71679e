"""What ends a study early: kill -9, Ctrl-C twice, a full disk, a store to be read only."""

import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from study_process import StudyProcess, counting, runs, wait_until

from studies.program import Program
from studies.scratch import scratch_folder, sweep_once


def _alive(file: Path) -> bool:
    stat = Path(f"/proc/{file.read_text().strip()}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def _slow(program: Program, folder: Path) -> Program:
    """Runs that last for a minute, in a process that they start, while there is a file `slow`."""
    (folder / "slow").touch()
    lasting = f'sleep 60 & echo $! > "{folder}/child"; wait'
    return counting(program, folder, f'if [ -e "{folder}/slow" ]; then {lasting}; fi')


def test_runs_and_their_folders_end_with_a_killed_study(
    program: Program, scenarios: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = StudyProcess(tmp_path, _slow(program, tmp_path), scenarios / "wall.toml", points=2)
    driver = study.start()
    child = tmp_path / "child"
    wait_until(lambda: runs(tmp_path) == 2 and child.exists() and child.read_text() != "")
    assert _alive(child)
    driver.kill()
    driver.communicate()
    wait_until(lambda: not _alive(child))
    assert study.kept() == 0
    left = list(study.temporary.glob("hvp-study-*"))
    assert len(left) == 2
    # The next study removes them, but not the folder of one that lives.
    monkeypatch.setattr("tempfile.tempdir", str(study.temporary))
    (tmp_path / "slow").unlink()
    with scratch_folder() as mine:
        sweep_once.cache_clear()
        study.finish()
        assert list(study.temporary.glob("hvp-study-*")) == [mine.parent]
    assert list(study.temporary.glob("hvp-study-*")) == []
    assert study.kept() == 2


def test_a_second_interruption_drops_what_is_under_way(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    study = StudyProcess(tmp_path, _slow(program, tmp_path), scenarios / "wall.toml", points=3)
    driver = study.start()
    child = tmp_path / "child"
    wait_until(lambda: runs(tmp_path) == 2 and child.exists() and child.read_text() != "")
    driver.send_signal(signal.SIGINT)
    assert driver.stderr is not None
    said = ""
    while "Ctrl-C once more" not in said:
        said = driver.stderr.readline()
        assert said, "it ended at the first one"
    assert said.startswith("finishing 2 under way")
    driver.send_signal(signal.SIGINT)
    out, error = driver.communicate(timeout=30)  # the runs would have gone on for longer
    assert driver.returncode == -signal.SIGINT  # 130, as a shell says it
    assert out == "0 of 3 runs are kept; the same command goes on\n"
    assert error == ""
    assert not _alive(child)
    assert runs(tmp_path) == 2  # not tried again, as one that crashes is
    assert [path for path in study.store.rglob("*") if path.is_file() and path.stat().st_size] == []
    (tmp_path / "slow").unlink()
    study.finish()
    assert study.kept() == 3


def _mounting() -> list[str]:
    """A command that runs another one where it may mount; skips where nobody may."""
    refused = "no unshare"
    if shutil.which("unshare"):
        for command in (["unshare", "-m"], ["unshare", "-rm"]):
            mount = [*command, "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
            done = subprocess.run(mount, capture_output=True, text=True, check=False)
            if done.returncode == 0:
                return command
            refused = done.stderr.strip()
    pytest.skip(f"a file system of its own for the test: {refused}")


def test_a_full_and_a_read_only_store_lose_nothing(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    counted = counting(program, tmp_path)
    study = StudyProcess(tmp_path, counted, scenarios / "wall.toml", points=24)
    study.store.mkdir()
    script = """
        folder=$1 store=$1/store
        shift
        step() { # name command…
          "${@:2}" >"$folder/$1.out" 2>"$folder/$1.err"
          echo $? >"$folder/$1.exit"
          find "$store" -name '*.json' -size +0 | wc -l >"$folder/$1.kept"
          wc -l <"$folder/runs" >"$folder/$1.runs"
          find "$store" -name '*.part' >"$folder/$1.parts"
        }
        mount -t tmpfs -o size=20k tmpfs "$store"
        step full "$@"
        mount -o remount,bind,ro "$store"
        step read-only "$@"
        mount -o remount,bind,rw "$store" && mount -o remount,size=10m "$store"
        step roomy "$@"
        mount -o remount,bind,ro "$store"
        step complete "$@"
    """
    command = [*_mounting(), "bash", "-c", script, "-", str(tmp_path), *study.command]
    subprocess.run(command, env=study.environment, check=True, timeout=240)

    def of(name: str) -> str:
        return (tmp_path / name).read_text().strip()

    full = int(of("full.kept"))
    assert 0 < full < 24
    assert of("full.exit") == of("read-only.exit") == "3"
    assert of("full.err").startswith(f"hvp: {study.store}/")
    assert of("full.err").endswith(": No space left on device")
    assert of("read-only.err").startswith(f"hvp: {study.store}")
    assert of("read-only.err").endswith(": Read-only file system")
    for name in ("full", "read-only"):
        assert of(f"{name}.err").count("\n") == 0
        assert of(f"{name}.out") == of(f"{name}.parts") == ""
        assert of(f"{name}.kept") == str(full)
    # What was kept is not run again, and what is there whole is only read.
    assert of("read-only.runs") == of("full.runs")
    assert of("roomy.exit") == of("complete.exit") == "0"
    assert int(of("roomy.runs")) - int(of("full.runs")) == 24 - full
    assert of("complete.runs") == of("roomy.runs")
    assert of("complete.out") == of("roomy.out")


def test_no_room_for_what_a_run_writes_is_no_crash_of_the_run(
    program: Program, scenarios: Path, tmp_path: Path
) -> None:
    study = StudyProcess(tmp_path, program, scenarios / "wall.toml", points=2)
    script = 'mount -t tmpfs -o size=20k tmpfs "$1" && shift && exec "$@"'
    command = [*_mounting(), "bash", "-c", script, "-", str(study.temporary), *study.command]
    done = subprocess.run(
        command, env=study.environment, capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1
    assert "cannot write" in done.stderr
    assert "disk full" in done.stderr or "No space left" in done.stderr
    assert study.kept() == 0
