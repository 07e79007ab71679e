"""The driver in Python on a modelled board: faults that the test asks for, and where it stops.

HVP_PROGRAM in the environment is hvp; without it these are left out.
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import hvp_board
import numpy as np
import pytest
from hvp_board import Matrix, Settings, Status
from hvp_board.model import ModelBus
from hvp_board.vfio_user import ModelError, Stop, VfioUser

TOP = Path(__file__).resolve().parents[3]
LIMIT_S = 60
B = np.array([640, 640, 640])
U = [[10, 20, 40]]


@pytest.fixture
def model(tmp_path: Path) -> Iterator[VfioUser]:
    program = os.environ.get("HVP_PROGRAM")
    if program is None:
        pytest.skip("no HVP_PROGRAM")
    socket = tmp_path / "board"
    words = ["serve", str(TOP / "scenarios" / "thesis.toml"), "--once", "--vfio-user", str(socket)]
    with subprocess.Popen([program, *words], stdout=subprocess.PIPE, text=True) as served:
        try:
            assert served.stdout is not None
            assert served.stdout.readline().startswith("listening on ")
            with VfioUser(socket) as client:
                yield client
            assert served.wait(LIMIT_S) == 0
        finally:
            served.kill()


def opened(model: VfioUser) -> hvp_board.Board:
    board = hvp_board.open_bus(ModelBus(model))
    board.configure(
        Settings(
            iterations=4,
            matrix_bits=12,
            vector_bits=16,
            coefficient_bits=16,
            dynamic_scaling=True,
            method=hvp_board.Method.JACOBI_PCG,
        )
    )
    board.load(Matrix(np.array([0, 1]), np.array([0]), np.diag([64, 32, 16]).reshape(1, 3, 3)))
    return board


def test_a_fault_comes_when_it_is_asked_for(model: VfioUser) -> None:
    with opened(model) as board:
        assert board.solve(B, timeout=5.0).tolist() == U
        model.inject("kind=lost-interrupt,count=2")
        for _ in range(3):
            assert board.solve(B, timeout=0.2).tolist() == U
        assert board.statistics.lost_interrupts == 2
        model.inject("kind=stuck-busy,frame=5")
        assert board.solve(B, timeout=5.0).tolist() == U
        with pytest.raises(hvp_board.BoardError) as caught:
            board.solve(B, timeout=0.2)
        assert caught.value.status == Status.ERROR_TIMEOUT


def test_updates_values(model: VfioUser) -> None:
    with opened(model) as board:
        assert board.solve(B, timeout=5.0).tolist() == U
        board.update_values(np.diag([32, 16, 8]).reshape(1, 3, 3), timeout=5.0)
        assert board.solve(B, timeout=5.0).tolist() == (2 * np.array(U)).tolist()


def test_a_wrong_word_changes_nothing(model: VfioUser) -> None:
    with opened(model) as board:
        with pytest.raises(ModelError, match='kind=lost: expected "lost-interrupt"'):
            model.inject("kind=lost")
        with pytest.raises(ModelError, match="did you mean STATUS"):
            model.stop_at("read of STATS", print)
        assert board.solve(B, timeout=5.0).tolist() == U


def test_stops_at_exact_times(model: VfioUser) -> None:
    """On the thesis' bus, whose times are those of the board in the process."""
    seen: list[Stop] = []
    with opened(model) as board:
        model.stop_at("job 1", seen.append)
        model.stop_at("write to CONTROL", seen.append)
        model.stop_at("interrupt 3", seen.append)
        for _ in range(2):
            assert board.solve(B, timeout=5.0).tolist() == U
    # Of the first job its start; then the second's first access, its start and its interrupt.
    assert [(s.job, s.value, s.what.split(" at ")[0]) for s in seen] == [
        (0, 1, "write to CONTROL 0x00000001"),
        (1, 1, "job 1 begins"),
        (1, 1, "write to CONTROL 0x00000001"),
        (1, 3, "interrupt 3 arrives"),
    ]
    began, started, ended = (s.time_ps for s in seen[1:])
    assert started - began == 310_000
    assert ended - started == 8_840_000
