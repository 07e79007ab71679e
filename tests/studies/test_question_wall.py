"""What the runs of a question cost: beside its figures, and only where something is simulated."""

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from studies.cli import main
from studies.errors import WRONG_INPUT, InputError
from studies.program import Program
from studies.questions.question_file import read_question
from studies.questions.wall import WALL, wall_table
from studies.session import Session


def test_a_ladder_has_its_cost_beside_each_rung(session: Session) -> None:
    whole = read_question("effects-ladder")
    question = replace(whole, points=(whole.points[0], whole.points[-1]))
    records = session.run(question.points)
    columns, rows = wall_table(question, records, session.program, 1)
    names = [column.name for column in columns]
    assert names[:2] == ["up to", "deadline.p50_us"] and WALL.name in names
    frame = pd.DataFrame(rows, columns=names)
    assert frame["up to"].tolist() == [point.columns["up to"] for point in question.points]
    assert frame["deadline.p50_us"].tolist() == [r.metrics["deadline.p50_us"] for r in records]
    assert (frame[WALL.name] > 0).all()
    assert (frame["wall_least_s"] >= frame[WALL.name] * 0.4).all()  # 500 frames are 0.5 s or more


def test_what_simulates_nothing_has_no_cost(session: Session) -> None:
    question = read_question("partitions")
    with pytest.raises(InputError, match="simulates nothing"):
        wall_table(question, [], session.program, 1)


def test_no_run_is_no_cost(
    program: Program,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    command = ["questions", "effects-ladder", "--wall", "0", "--out", str(tmp_path)]
    assert main(command) == WRONG_INPUT
    assert capsys.readouterr().err == "--wall: expected 1 or more, found 0\n"
