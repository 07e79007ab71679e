"""What accuracy costs: the front, the words, what does not fit, and the simulator's ladders."""

from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest

from studies.accuracy.design import (
    BUDGET,
    ERROR,
    FORCE_ERROR,
    TIME,
    Design,
    DesignStudy,
    front,
    grid,
    words,
)
from studies.accuracy.ladder import ladders
from studies.accuracy.picture import draw
from studies.cli import main
from studies.errors import WRONG_INPUT, InputError
from studies.point import Value
from studies.program import Program
from studies.record import Record
from studies.session import Session

MOST_RUNS = 61
COLUMNS: Mapping[str, Value] = {
    "solver.method": "cg",
    "solver.iterations": 30,
    "solver.matrix_bits": 18,
    "solver.vector_bits": 24,
    "refinement.passes": 0,
}


def design(time_us: float, error: float, state: str = "fits") -> Design:
    metrics: dict[str, Value] = {
        TIME: time_us,
        ERROR: error,
        FORCE_ERROR: error / 2,
        BUDGET: 2000.0,
        "accuracy.frames": 10,
    }
    return Design(COLUMNS, (), Record("a", "held", 0, metrics=metrics), state)


def test_the_front_is_what_nothing_beats() -> None:
    a, b, c = design(100, 0.5), design(200, 0.1), design(300, 0.2)
    unfit, late = design(50, 1e-9, "does not fit"), design(3000, 1e-9, "late")
    assert front([c, unfit, b, late, a]) == [a, b]


def test_words_say_the_least_time_and_when_none_reaches_it() -> None:
    designs = [design(900, 0.2), design(1100, 0.009), design(400, 0.0005, "does not fit")]
    tenth, faster, hundredth, again, thousandth, own = words(designs, "EP2S60")
    # Least of what was tried, and not of what there is.
    assert "of 3 sets with the scenario's other keys" in tenth
    assert faster == again
    assert faster.startswith("1 sets would be faster") and "do not fit" in faster
    assert "0.1 costs at least 1.1 ms" in tenth
    assert "0.01 costs at least 1.1 ms on this device (EP2S60)" in hundredth
    assert "cg, 30 iterations, 18/24 bits" in hundredth
    assert "none of these sets reaches it" in thousandth and "does not fit" in thousandth
    assert "0.9 ms, error 0.2" in own
    assert "no set of these reaches it" in words([design(900, 0.2)], "EP2S60")[2]


def test_the_grid_is_short_and_begins_with_the_scenario() -> None:
    points = grid(False, 500)
    assert points[0] == {} and len(points) <= MOST_RUNS
    assert len({tuple(point.items()) for point in points}) == len(points)
    assert len(grid(True, 500)) > len(points)


def test_wider_words_err_less_and_what_does_not_fit_is_shown(
    session: Session, scenarios: Path, tmp_path: Path
) -> None:
    settings = ("object.mesh.nodes=100", "frames=260")
    study = DesignStudy(session, scenarios / "thesis-static.toml", settings)
    # As many iterations as it takes for the words to be what is left of the error.
    middle_words = {**COLUMNS, "solver.iterations": 60}
    wide = {**middle_words, "solver.matrix_bits": 24, "solver.vector_bits": 32}
    points: list[Mapping[str, Value]] = [
        *({}, middle_words, wide, {**COLUMNS, "solver.iterations": 120}),
    ]
    designs = study.run(points, False)
    own, middle, widest, longer = designs
    shares = study.shares(designs)
    errors = [d.error() for d in designs]
    assert all(error is not None for error in errors)
    # 282 multipliers of the 144 that the EP2S60 has.
    assert own.state == "fits" and middle.state == widest.state == "does not fit"
    assert (shares[0] or 2) <= 1 < (shares[1] or 0) < (shares[2] or 0)
    assert (widest.error() or 1) < (middle.error() or 1) < (own.error() or 0)
    assert (longer.time_us or 0) > (middle.time_us or 1)
    draw(tmp_path / "a.png", "title", designs, shares, 2000)
    draw(tmp_path / "b.png", "title", designs, shares, 2000)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_without_contact_there_is_no_error_to_show(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=60", "frames=20")
    with pytest.raises(InputError, match="no frame was compared"):
        DesignStudy(session, scenarios / "thesis.toml", settings).run([{}], False)


def test_ladders_start_at_the_finest_level(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=60", "frames=60", "reference=false")
    rungs = ladders(session, scenarios / "thesis.toml", settings, 1)
    finest = {rung.part: rung.level for rung in rungs if rung.finest}
    assert finest == {
        "accelerator": "cycle-accurate",
        "bus": "approximately-timed",
        "host": "loosely-timed",
        "numbers": "fixed",
    }
    by_level = {(rung.part, rung.level): rung for rung in rungs}
    untimed = by_level["accelerator", "untimed"]
    assert untimed.influence is not None and (untimed.influence.latency or 0) > 1 / 10
    # The closed form of clocks is exact: docs/accelerator.md.
    closed = by_level["accelerator", "loosely-timed"]
    assert closed.influence is not None and closed.influence.latency == 0
    slowest, fastest = (by_level["accelerator", x].cost for x in ("cycle-accurate", "untimed"))
    assert slowest is not None and fastest is not None
    lost = by_level["numbers", "none"].influence
    assert lost is not None and "force" in lost.lost


def test_a_wall_has_the_ladder_alone(
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    command = ["study", "accuracy", str(scenarios / "wall.toml"), "--set", "frames=100"]
    command += ["--store", str(tmp_path / "store"), "--out", str(tmp_path / "out")]
    assert main(command) == WRONG_INPUT
    said = capsys.readouterr()
    assert len(said.err.splitlines()) == 1 and "no board" in said.err
    assert "approximately-timed" in said.out
    ladder = pd.read_csv(tmp_path / "out" / "simulator.csv")
    assert set(ladder["part"]) == {"accelerator", "bus", "host", "numbers"}
