"""What a report says repeats it does."""

import shlex
from pathlib import Path

import pytest

from studies.axis import parse_axis
from studies.cli import main
from studies.command_line import repeating


def test_a_command_is_quoted_and_runs_where_it_was_called(monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["study", "screen", "s p.toml", "--set", 'title="a b"', "--out", "x", "--store=y"]
    monkeypatch.setenv("HVP_COMMAND", "../the checkout/hvp")
    line = repeating([*words, "--jobs", "2", "--quiet"])
    assert shlex.split(line) == ["../the checkout/hvp", *words]
    assert shlex.split(repeating(["sweep", "--jobs=2", "--pairs", "0"]))[1:] == [
        *("sweep", "--pairs", "0")
    ]


def test_a_report_is_not_written_over_something_else(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", "/bin/true")
    victim = tmp_path / "summary.json"
    victim.write_text("{}")
    assert main(["report", str(tmp_path), "--out", str(victim)]) == 2
    assert "expected a name that ends in .html" in capsys.readouterr().err
    assert victim.read_text() == "{}"


def test_commas_in_quoted_text_are_text() -> None:
    assert parse_axis(r'title="a \"b","c,d"').texts == (r'"a \"b"', '"c,d"')


def test_a_study_that_is_refused_everywhere_writes_nothing(
    tmp_path: Path, scenarios: Path, program: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))  # type: ignore[attr-defined]
    study = tmp_path / "study.toml"
    study.write_text(
        f'scenario = "{scenarios}/wall.toml"\n[[axis]]\nkey = "wall.stiffnes"\nvalues = [1, 2]\n'
    )
    out = tmp_path / "out"
    words = ["study", str(study), "--out", str(out), "--store", str(tmp_path / "store")]
    assert main(words) == 2
    assert not out.exists()
