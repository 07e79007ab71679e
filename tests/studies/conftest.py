"""What every test of studies/ needs: the program, its scenarios, a store of its own."""

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Browser, start
from pages import table, write_run_page, write_study_page

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


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """One for all pages."""
    yield from start()


@pytest.fixture(scope="session")
def study_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study's page, beside its results.csv."""
    return write_study_page(tmp_path_factory.mktemp("study"), table())


@pytest.fixture(scope="session")
def run_page(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's page, in the run's folder."""
    return write_run_page(program, tmp_path_factory.mktemp("run") / "run")


@pytest.fixture(scope="session")
def kept(program: Program, tmp_path_factory: pytest.TempPathFactory) -> Session:
    """A session whose runs the tests of screening share."""
    return Session(program, Store(tmp_path_factory.mktemp("screen") / "store"), workers=2)
