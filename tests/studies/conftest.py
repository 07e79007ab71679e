"""What every test of studies/ needs: the program, its scenarios, a store of its own."""

import os
import signal
from pathlib import Path

import pytest

from studies.program import Program
from studies.session import Session
from studies.store import Store

TOP = Path(__file__).resolve().parents[2]

# A shell's background job ignores Ctrl-C, and Python then does as well.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def program() -> Program:
    """The program under test, by HVP_PROGRAM."""
    return Program(Path(os.environ.get("HVP_PROGRAM", TOP / "build/release/app/hvp")).resolve())


@pytest.fixture(scope="session")
def scenarios() -> Path:
    """The folder of the scenarios."""
    return TOP / "scenarios"


@pytest.fixture
def session(program: Program, tmp_path: Path) -> Session:
    """A session with an empty store."""
    return Session(program, Store(tmp_path / "store"), workers=2)
