"""The package on a board in Python: what arrives at the registers, and how failures come back."""

from __future__ import annotations

import re
import signal
from pathlib import Path
from types import FrameType

import hvp_board
import numpy as np
import pytest
from hvp_board import Interrupt, Matrix, Settings, Status

# docs/registers.md
ID, VERSION, NODES_CAN, BLOCKS_CAN, FORMAT_CAN = 0x00, 0x04, 0x08, 0x0C, 0x10
CLOCK, SOLVER_CAN, DMA_CAN, CONTROL, STATUS = 0x14, 0x18, 0x1C, 0x20, 0x24
INTERRUPT_STATUS, ERROR_DETAIL, JOB, METHOD, RESULT_JOB = 0x28, 0x34, 0x38, 0x40, 0xA0
STOP_LOW, UPDATE_NODE = 0x48, 0x80
B, U, ROW_BEGIN, COLUMN, VALUE = 0x20000, 0x40000, 0x60000, 0x200000, 0x1000000
DONE, ERROR, LOADED = 2, 4, 8


class ScriptedBoard:
    """The commands' effects and no arithmetic: U is twice b."""

    def __init__(self) -> None:
        self.words: dict[int, int] = {
            ID: 0x48565031,
            VERSION: 0x00020003,
            NODES_CAN: 0x00400010,
            BLOCKS_CAN: 64,
            FORMAT_CAN: 0x20202020,
            CLOCK: 100_000,
            SOLVER_CAN: 0x8000071F,
        }
        self.now = 0
        self.ends = True
        self.waits: list[int] = []
        self.error = 0

    def read32(self, offset: int) -> int:
        return self.words.get(offset, 0)

    def write32(self, offset: int, value: int) -> None:
        if offset == CONTROL:
            self.command(value)
        elif offset == INTERRUPT_STATUS:
            self.words[STATUS] = self.read32(STATUS) & ~(value << 1)
        else:
            self.words[offset] = value

    def command(self, value: int) -> None:
        if value & 0x80000000:
            self.words[STATUS] = 0
        elif self.error:
            self.words[STATUS] = ERROR | LOADED | self.error << 8
            self.words[ERROR_DETAIL] = METHOD
        elif value & 0x14:
            self.words[STATUS] = DONE | LOADED
        elif value & 1 and self.ends:
            self.words[STATUS] = DONE | LOADED
            self.words[RESULT_JOB] = self.words.get(RESULT_JOB, 0) + 1
            for offset in range(0, 0x1000, 4):
                packed = np.array([self.read32(B + offset)], dtype="<u4").view("<i2")
                self.words[U + offset] = int((2 * packed).astype("<i2").view("<u4")[0])

    def read_block(self, offset: int, count: int) -> np.typing.NDArray[np.uint32]:
        return np.array([self.read32(offset + 4 * k) for k in range(count)], dtype=np.uint32)

    def write_block(self, offset: int, words: np.typing.NDArray[np.uint32]) -> None:
        for k, word in enumerate(words):
            self.write32(offset + 4 * k, int(word))

    def wait_interrupt(self, timeout_ns: int) -> Interrupt:
        self.waits.append(timeout_ns)
        if self.words.get(STATUS, 0) & (DONE | ERROR):
            return Interrupt.RAISED
        self.now += timeout_ns
        return Interrupt.TIMED_OUT

    def now_ns(self) -> int:
        return self.now


SETTINGS = Settings(iterations=60, matrix_bits=12, vector_bits=16, stop_residual=0.5)
MATRIX = Matrix(
    np.array([0, 2, 4]), np.array([0, 1, 0, 1]), np.arange(36, dtype=np.int64).reshape(4, 3, 3)
)


@pytest.fixture
def scripted() -> ScriptedBoard:
    return ScriptedBoard()


def loaded(scripted: ScriptedBoard) -> hvp_board.Board:
    board = hvp_board.open_bus(scripted)
    board.configure(SETTINGS)
    board.load(MATRIX)
    return board


def test_says_what_the_board_can_do(scripted: ScriptedBoard) -> None:
    with hvp_board.open_bus(scripted) as board:
        assert board.capability.max_nodes == 16
        assert board.capability.clock_khz == 100_000
        assert board.info == hvp_board.Info(
            dma=False, interrupts=True, messages=False, longest_wait_ms=0
        )


def test_sends_settings_and_matrix(scripted: ScriptedBoard) -> None:
    with loaded(scripted):
        # The bits of 0.5.
        assert (scripted.read32(STOP_LOW), scripted.read32(STOP_LOW + 4)) == (0, 0x3FE00000)
        assert [scripted.read32(ROW_BEGIN + 4 * k) for k in range(3)] == [0, 2, 4]
        assert [scripted.read32(COLUMN + 4 * k) for k in range(4)] == [0, 1, 0, 1]
        # Two words of 16 bits each.
        assert scripted.read32(VALUE + 4) == 2 | 3 << 16


def test_takes_a_sparse_matrix_of_scipy(scripted: ScriptedBoard) -> None:
    sparse = pytest.importorskip("scipy.sparse")
    with hvp_board.open_bus(scripted) as board:
        board.configure(SETTINGS)
        board.load(sparse.bsr_array((MATRIX.value, MATRIX.column, MATRIX.row_begin), shape=(6, 6)))
        assert scripted.read32(VALUE + 4) == 2 | 3 << 16


def test_solves(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:
        b = np.array([1, -2, 3, -4, 5, -6])
        u = board.solve(b, timeout=1.0)
        assert u.dtype == np.int32
        assert u.shape == (2, 3)
        assert np.array_equal(u.reshape(-1), 2 * b)
        assert board.read_result().job == 1
        assert board.statistics == hvp_board.Statistics(0, 0)
        assert scripted.waits[-1] == 1_000_000_000


def test_updates_values(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:
        board.update_values(MATRIX.value + 5, timeout=0.25)
        assert scripted.read32(VALUE) == 5 | 6 << 16
        assert scripted.waits[-1] == 250_000_000
        with pytest.raises(ValueError, match="blocks of 3 x 3"):
            board.update_values(MATRIX.value.reshape(-1), timeout=0.25)
        with pytest.raises(hvp_board.BoardError) as caught:
            board.update_values(MATRIX.value[1:], timeout=0.25)
        assert caught.value.status == Status.ERROR_ARGUMENT


def test_an_older_board_has_no_update_of_values(scripted: ScriptedBoard) -> None:
    scripted.words[VERSION] = 0x00020002
    with loaded(scripted) as board:
        with pytest.raises(hvp_board.BoardError) as caught:
            board.update_values(MATRIX.value, timeout=0.25)
        assert caught.value.status == Status.ERROR_CAPABILITY


def test_changes_nodes(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:
        board.constrain(1, 7)
        assert [scripted.read32(UPDATE_NODE + 4 * k) for k in range(4)] == [1, 0, 7, 0]
        board.restore(1, MATRIX.value[2:4])
        assert [scripted.read32(UPDATE_NODE + 4 * k) for k in range(4)] == [1, 1, 1, 2]


def test_a_time_out_is_an_error_with_its_status(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:
        scripted.ends = False
        board.write_rhs(np.zeros(6, dtype=np.int32))
        board.start()
        with pytest.raises(hvp_board.BoardError) as caught:
            board.wait(0.001)
        assert caught.value.status == Status.ERROR_TIMEOUT
        assert "busy" in str(caught.value)


@pytest.mark.parametrize("timeout", [-1.0, float("nan"), "1"])
def test_a_wrong_time_begins_no_job(scripted: ScriptedBoard, timeout: float) -> None:
    b = np.ones(6, dtype=np.int32)
    with loaded(scripted) as board:
        with pytest.raises((ValueError, TypeError)):
            board.solve(b, timeout=timeout)
        assert scripted.read32(RESULT_JOB) == 0
        assert np.array_equal(board.solve(b, timeout=float("inf")).reshape(-1), 2 * b)


def test_an_error_of_the_board_has_its_detail(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:
        scripted.error = 3
        with pytest.raises(hvp_board.BoardError) as caught:
            board.solve(np.zeros(6, dtype=np.int32), timeout=1.0)
        assert caught.value.status == Status.ERROR_BAD_SETTING
        assert caught.value.detail == METHOD


def test_what_a_call_back_raises_comes_out_of_the_call(scripted: ScriptedBoard) -> None:
    with loaded(scripted) as board:

        def fail(_timeout_ns: int) -> Interrupt:
            raise ConnectionResetError("gone")

        scripted.wait_interrupt = fail  # type: ignore[assignment, method-assign]
        with pytest.raises(ConnectionResetError, match="gone"):
            board.solve(np.zeros(6, dtype=np.int32), timeout=1.0)


def test_a_signal_runs_its_handler_and_the_wait_goes_on(scripted: ScriptedBoard) -> None:
    waited = scripted.wait_interrupt
    handled: list[int] = []

    def interrupted(timeout_ns: int) -> Interrupt:
        if handled:
            return waited(timeout_ns)
        signal.raise_signal(signal.SIGUSR1)
        raise InterruptedError

    def handler(number: int, _frame: FrameType | None) -> None:
        handled.append(number)

    before = signal.signal(signal.SIGUSR1, handler)
    try:
        with loaded(scripted) as board:
            scripted.wait_interrupt = interrupted  # type: ignore[method-assign]
            board.solve(np.zeros(6, dtype=np.int32), timeout=1.0)
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert handled == [signal.SIGUSR1]


@pytest.mark.parametrize(
    "b", [np.zeros(6), np.full(6, 2**31), [[1, 2, 3]]], ids=["real", "too-large", "too-short"]
)
def test_refuses_vectors_that_are_none(scripted: ScriptedBoard, b: object) -> None:
    with loaded(scripted) as board, pytest.raises((ValueError, hvp_board.BoardError)):
        board.write_rhs(b)  # type: ignore[arg-type]


def test_refuses_matrices_that_would_be_read_beyond_their_end() -> None:
    with pytest.raises(ValueError, match="expected 4 as the last"):
        Matrix(np.array([0, 2, 5]), MATRIX.column, MATRIX.value)
    with pytest.raises(ValueError, match="3 x 3"):
        Matrix(MATRIX.row_begin, MATRIX.column, MATRIX.value[:3])


def test_a_closed_board_says_so(scripted: ScriptedBoard) -> None:
    board = loaded(scripted)
    board.close()
    board.close()
    with pytest.raises(ValueError, match="closed"):
        board.start()


def test_addresses() -> None:
    with pytest.raises(hvp_board.BoardError) as caught:
        hvp_board.open("/dev/null")
    assert caught.value.status == Status.ERROR_NO_DEVICE
    with pytest.raises(ValueError, match="/dev/"):
        hvp_board.open("tcp:somewhere")


def test_the_status_numbers_are_the_headers() -> None:
    header = Path(__file__).parents[3] / "driver" / "hvp_status.h"
    names = re.findall(r"^  HVP_((?:OK|ERROR)\w*)", header.read_text(encoding="utf-8"), re.M)
    assert [status.name for status in Status] == names
    assert [status.value for status in Status] == list(range(len(names)))
