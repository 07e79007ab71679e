"""What accuracy costs: the front, the words, what does not fit, and the simulator's ladders."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from studies.accuracy.answer import TARGETS, short, words
from studies.accuracy.between import refine
from studies.accuracy.design import (
    BUDGET,
    ERROR,
    FORCE_ERROR,
    TIME,
    Design,
    DesignStudy,
    front,
)
from studies.accuracy.grid import (
    ITERATIONS,
    MATRIX_BITS,
    MEMORY,
    METHOD,
    PASSES,
    SCALING,
    VECTOR_BITS,
    grid,
    overrides_of,
)
from studies.accuracy.ladder import ladders, resolved_settings
from studies.accuracy.partitions import KEY as PARTITIONS
from studies.accuracy.partitions import fastest
from studies.accuracy.picture import draw
from studies.cli import main
from studies.errors import WRONG_INPUT, InputError
from studies.point import Point, Value
from studies.program import Program, Resolved
from studies.record import Record
from studies.session import Session

MOST_RUNS = 67
COLUMNS: Mapping[str, Value] = {
    "solver.method": "cg",
    "solver.iterations": 30,
    "solver.matrix_bits": 18,
    "solver.vector_bits": 24,
    "refinement.passes": 0,
    "accelerator.partitions": 3,
}


def design(
    time_us: float,
    error: float,
    state: str = "fits",
    columns: Mapping[str, Value] = COLUMNS,
) -> Design:
    metrics: dict[str, Value] = {
        TIME: time_us,
        ERROR: error,
        FORCE_ERROR: error / 2,
        BUDGET: 2000.0,
        "accuracy.frames": 10,
    }
    record = Record("a", "held", 0, metrics=metrics)
    return Design(columns, (), record, state, tried=8 if time_us > 1000 else 16)


def words_of(matrix: int, vectors: int, iterations: int, method: str = "cg") -> Mapping[str, Value]:
    return {
        "solver.method": method,
        "solver.iterations": iterations,
        "solver.matrix_bits": matrix,
        "solver.vector_bits": vectors,
        "refinement.passes": 0,
    }


def test_the_front_is_what_nothing_beats() -> None:
    a, b, c = design(100, 0.5), design(200, 0.1), design(300, 0.2)
    unfit, late = design(50, 1e-9, "does not fit"), design(3000, 1e-9, "late")
    coarse = design(50, 1e-9, columns={**COLUMNS, "object.mesh.nodes": 50})
    assert front([c, unfit, b, late, coarse, a]) == [a, b]


def test_words_say_the_least_time_and_when_none_reaches_it() -> None:
    coarse = design(50, 1e-4, columns={**COLUMNS, "object.mesh.nodes": 50})
    designs = [
        design(900, 0.2),
        design(1100, 0.009),
        design(1200, 0.0001),
        design(400, 0.0005, "does not fit"),
        design(300, 0.05, "breaks down"),
        coarse,
    ]
    tenth, hundredth, _, own, tried = words(designs, "EP2S60")
    assert tenth.startswith(
        "A displacement error of 1e-1 (95 % of the frames in contact) costs at least 1.1 ms on "
        "this device (E"
    )
    assert "the cheapest set is cg, 30 iterations, 18/24 bits, 3 partitions: error 0.009" in tenth
    assert "none for this device and budget: 1 does not fit, 1 breaks down." in tenth
    # Another mesh is another body, however close its solver comes to it.
    assert "another mesh, whose distance from the scenario's is not in the error: 0.05 ms" in tenth
    assert "of 1e-2 (95 % of the frames in contact) costs at least 1.1 ms" in hundredth
    assert own.startswith("The scenario itself (fits): 0.9 ms, error 0.2, ")
    assert own.endswith("budget 2 ms.")
    # Least of what was tried, and not of what there is.
    assert tried.startswith("Least of 6 sets, ") and "1 to 8 or 16 tried" in tried
    assert "no set of these reaches it" in words([design(900, 0.2)], "EP2S60")[2]
    elsewhere = words([design(900, 0.2), design(400, 0.0005, "does not fit")], "EP2S60")[1]
    assert "none of these sets reaches it" in elsewhere and "(does not fit): 0.4 ms" in elsewhere
    assert [short(error) for error in (1e-1, 2e-3, 1.0)] == ["1e-1", "2e-3", "1e0"]


def test_the_grid_is_short_and_begins_with_the_scenario() -> None:
    points = grid(False, 500)
    assert points[0] == {} and len(points) <= MOST_RUNS
    assert len({tuple(point.items()) for point in points}) == len(points)
    assert len(grid(True, 500)) > len(points)


def test_every_set_has_the_partitions_that_make_it_fastest(
    session: Session, scenarios: Path, tmp_path: Path
) -> None:
    """Held against every number of partitions as it runs, and not as the closed forms have it."""
    scenario = scenarios / "thesis-static.toml"
    settings = ("object.mesh.nodes=70", "frames=220", "reference=true")
    sets: list[Mapping[str, Value]] = [
        words_of(12, 16, 15),
        words_of(18, 24, 60),
        words_of(24, 32, 60, "jacobi-pcg"),
    ]
    study = DesignStudy(session, scenario, settings)
    own, *designs = study.run([{}, *sets])
    # The scenario's own row says what its settings are, where every other one differs from it.
    assert own.own and own.state == "fits"
    assert own.columns == {
        METHOD: "cg",
        ITERATIONS: 60,
        MATRIX_BITS: 12,
        VECTOR_BITS: 16,
        SCALING: "none",
        PASSES: 0,
        "object.mesh.nodes": 70,
        PARTITIONS: 5,
    }
    numbers = range(1, 7)
    each = [
        Point(scenario, (*settings, *overrides_of(columns, False), f"{PARTITIONS}={number}"))
        for columns in sets
        for number in numbers
    ]
    records = session.run(each)
    for index, found in enumerate(designs):
        held = [
            (float(record.metrics[TIME] or 0), number, record.metrics[ERROR])
            for number, record in zip(numbers, records[index * len(numbers) :], strict=False)
            if record.status == "held"
        ]
        if not held:
            assert found.state == "does not fit" and found.columns[PARTITIONS] == 1
            continue
        assert found.state in ("fits", "breaks down")
        assert (found.time_us, found.columns[PARTITIONS], found.error()) == min(held)
        # A solve has the same words however its rows are shared.
        assert len({error for _, _, error in held}) == 1
        # What the study is for: more would not fit, and not as the scenario has it.
        assert max(number for _, number, _ in held) < max(numbers)
    assert [found.columns[PARTITIONS] for found in designs] == [5, 2, 1]
    assert designs[2].state == "does not fit"

    shares = study.shares([own, *designs])
    assert all((share or 2) <= 1 for share in shares[:3]) and (shares[3] or 0) > 1
    few, middle, many = (found.error() or 0 for found in designs)
    assert many < middle < few
    draw(tmp_path / "a.png", "title", [own, *designs], shares, 2000)
    draw(tmp_path / "b.png", "title", [own, *designs], shares, 2000)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_what_fits_with_another_memory_has_it(session: Session, scenarios: Path) -> None:
    """The thesis' system with words of 18/24 bits: 300 M4K of 255 with one partition."""
    scenario = scenarios / "thesis-static.toml"
    settings = ("frames=190",)
    (found,) = DesignStudy(session, scenario, settings).run([words_of(18, 24, 15)])
    assert found.state == "fits"
    assert found.columns[MEMORY] == "accelerator.vector_memory=M512"
    fixed = (*settings, *overrides_of(words_of(18, 24, 15), False), str(found.columns[MEMORY]))
    points = [
        Point(scenario, (*fixed, f"{PARTITIONS}={number}"), command="device")
        for number in range(1, 7)
    ]
    fitting = {
        number: int(record.metrics["cycles.solve"] or 0)
        for number, record in enumerate(session.run(points), start=1)
        if record.status == "held"
    }
    assert found.columns[PARTITIONS] == min(fitting, key=lambda number: fitting[number])


def test_a_device_with_room_is_asked_for_more_partitions(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=70", "accelerator.device=U280")
    scenario = scenarios / "thesis-static.toml"
    (choice,) = fastest(session, scenario, [settings], 5)
    points = [
        Point(scenario, (*settings, f"{PARTITIONS}={number}"), command="device")
        for number in range(1, 33)
    ]
    clocks = [int(record.metrics["cycles.solve"] or 0) for record in session.run(points)]
    assert choice.best is not None and choice.best > 5
    assert clocks[choice.best - 1] == min(clocks)
    # And of equally fast ones the smallest.
    assert min(clocks) not in clocks[: choice.best - 1]


class LawOfTwo(DesignStudy):
    """Error halves with an iteration and falls to a fifth with a pass: the least is known."""

    def variants(self, of: Sequence[tuple[Design, Mapping[str, Value]]]) -> list[Design]:
        return [replace(self.made({**d.columns, **change}), between=True) for d, change in of]

    def made(self, columns: Mapping[str, Value]) -> Design:
        iterations, passes = (int(str(columns[key])) for key in (ITERATIONS, PASSES))
        per_iteration = 10 if columns[METHOD] == "cg" else 12
        error = 2.0**-iterations * 5.0**-passes
        return design(100 + per_iteration * iterations * max(passes, 1), error, columns=columns)


def test_the_least_is_that_of_every_number_of_iterations(session: Session) -> None:
    """Held against all of them, with one pass and with two; few of them are tried."""
    study = LawOfTwo(session, Path("none"), ())
    counts = (15, 30, 60, 120)
    points = [
        {**COLUMNS, METHOD: method, ITERATIONS: count, PASSES: passes, PARTITIONS: 1}
        for method in ("cg", "jacobi-pcg")
        for count in counts
        for passes in (0, 2)
    ]
    coarse = study.made({**points[0], "object.mesh.nodes": 40})
    unfit = replace(study.made({**points[0], PARTITIONS: 2}), state="does not fit")
    grid_of = [replace(study.made(point), tried=8) for point in points]
    found = refine(study, [*grid_of, coarse, unfit], TARGETS)
    every = [
        study.made({**points[0], ITERATIONS: count, PASSES: passes})
        for count in range(1, 121)
        for passes in (0, 1, 2)
    ]
    for target in TARGETS:
        least = min(d.time_us or 0 for d in every if d.reaches(target))
        assert min(d.time_us or 0 for d in found if d.reaches(target) and d.own_mesh) == least
    added = [d for d in found if d.between]
    assert found[: len(grid_of)] == grid_of and len(added) < len(every) / 8
    assert {d.columns[PARTITIONS] for d in added} == {1}
    assert not any(d.columns.get("object.mesh.nodes") for d in added)
    tenth, hundredth, *_, tried = words(found, "EP2S60")
    assert "the cheapest set is cg, 1 iteration, 18/24 bits, refined in 1 pass, " in tenth
    assert "With one iteration less it does not reach that: 0.02." in hundredth
    assert f"{len(added)} of them stand between those of the grid" in tried


def test_without_contact_there_is_no_error_to_show(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=60", "frames=20")
    with pytest.raises(InputError, match="no frame was compared"):
        DesignStudy(session, scenarios / "thesis.toml", settings).run([{}])


def test_a_set_without_contact_is_not_one_that_fits(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=70", "frames=220")
    study = DesignStudy(session, scenarios / "thesis-static.toml", settings)
    (own,) = study.run([{}])
    (short_of_it,) = study.variants([(own, {"frames": 20})])
    assert own.usable and short_of_it.record.status == "held"
    assert (short_of_it.state, short_of_it.message) == ("not measured", "no frame in contact")
    assert not short_of_it.usable and short_of_it.error() is None


def test_a_scenario_that_does_not_fit_is_a_design_as_well(
    session: Session, scenarios: Path
) -> None:
    settings = ("object.mesh.nodes=70", "frames=220", "accelerator.partitions=9")
    study = DesignStudy(session, scenarios / "thesis-static.toml", settings)
    own, fewer = study.run([{}, words_of(12, 16, 60)])
    assert own.state == "does not fit" and "cannot hold" in own.message
    assert own.time_us is not None and BUDGET in own.record.metrics
    assert fewer.state == "fits" and fewer.columns[PARTITIONS] == 5 and fewer.tried == 9
    assert fewer.error() == own.error()


def test_ladders_start_at_the_finest_level(session: Session, scenarios: Path) -> None:
    settings = ("object.mesh.nodes=60", "frames=60")
    resolved = resolved_settings(session, scenarios / "thesis.toml", settings)
    assert isinstance(resolved, Resolved)
    has = tomllib.loads(resolved.text)
    rungs = ladders(session, scenarios / "thesis.toml", settings, has, 1)
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
    # Without numbers there is nothing to compare: that part's levels go without the comparison.
    assert [rung.message for rung in rungs if rung.part == "numbers"] == ["without reference"] * 2
    assert not any(rung.message for rung in rungs if rung.part != "numbers")


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


@pytest.fixture
def folder(program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the command runs, with nothing in it."""
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--jobs", "-1"], "--jobs: expected 0 or more, found -1"),
        (["--repeats", "0"], "--repeats: expected 1 or more, found 0"),
        (["--out", __file__], f"--out {__file__}: expected a folder, found the file"),
        (["--store", __file__], f"--store {__file__}: expected a folder, found the file"),
        (["--set", "frames"], "--set frames: expected KEY=VALUE, such as object.mesh.nodes=300"),
        (["--set", "frames=0"], "--set frames=0: out of range: expected from 1 to"),
        (["--set", "fidelity.numbers=none"], "reference: nobody computes numbers: expected"),
    ],
)
def test_what_is_wrong_is_said_in_a_line_before_anything_runs(
    folder: Path,
    scenarios: Path,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    said: str,
) -> None:
    assert main(["study", "accuracy", str(scenarios / "thesis.toml"), *arguments]) == WRONG_INPUT
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not list(folder.rglob("*"))
