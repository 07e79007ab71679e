"""What a study says while it runs."""

import time

import pytest

from studies.progress import ProgressLine


class _Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def test_a_log_has_a_line_now_and_then_with_the_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = _Clock()
    monkeypatch.setattr(time, "monotonic", clock)
    progress = ProgressLine()
    for done in range(61):
        clock.now = 100.0 + done  # a run a second
        progress(done, 60)
    progress.end()
    assert capsys.readouterr().err.splitlines() == [
        "30 of 60 runs, about 30 s left",
        "60 of 60 runs",
    ]


def test_a_quiet_one_says_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = _Clock()
    monkeypatch.setattr(time, "monotonic", clock)
    progress = ProgressLine(quiet=True)
    clock.now = 1000.0
    progress(3, 60)
    assert capsys.readouterr().err == ""
