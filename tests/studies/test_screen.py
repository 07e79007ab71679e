"""Screening: what is turned over follows the declaration, and what is recommended holds."""

import json
import subprocess
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from studies.cli import main
from studies.commands.screen import read_tolerances
from studies.errors import WRONG_INPUT, InputError
from studies.program import Program
from studies.screening.answers import ANSWERS, Answers, influence
from studies.screening.changes import changes_of, with_needs
from studies.screening.exercise import Exercise, exercise, not_exercised
from studies.screening.found import Screening
from studies.screening.scenario_file import scenario_text
from studies.screening.screen import Screener
from studies.session import Session

WIDE = {"least": 0.01, "most": 0.1}
FRAMES = 400
# Few clocks a solve, as the cycle-accurate level is tried too.
SMALL = ("object.mesh.nodes=60", "solver.iterations=15")


def screen(kept: Session, scenario: Path, *settings: str, tolerances: str = "") -> Screening:
    told = read_tolerances([tolerances] if tolerances else [])
    return Screener(kept, scenario, settings, told).screen(pairs=2)


def verify(kept: Session, scenario: Path, folder: Path, found: Screening, *settings: str) -> None:
    """The recommendation as a file gives the run that was judged, frame by frame."""
    screener = Screener(kept, scenario, settings, {})
    overrides = screener.settings_of(found.recommendation.changes)
    file = folder / "recommended.toml"
    file.write_text(scenario_text(scenario, folder, "as recommended", overrides))
    subprocess.run(
        [
            *(str(kept.program.path), "run", str(file), "--out", str(folder / "run")),
            *("--quiet", "--set", "output.pictures=false"),
        ],
        check=False,
        capture_output=True,
    )
    frames = pd.read_csv(folder / "run" / "frames.csv").set_index("frame")
    pd.testing.assert_frame_equal(frames, found.recommendation.run.frames)
    summary = json.loads((folder / "run" / "summary.json").read_text())
    for change in found.recommendation.changes:
        assert change.key not in summary["effects"]


def test_every_declared_effect_and_level_is_turned_over(program: Program) -> None:
    own = {"accelerator": "loosely-timed", "bus": "loosely-timed", "numbers": "fixed"}
    choices = changes_of(program.reference, ["dynamics", "fault"], own)
    effects = {effect["path"] for effect in program.reference["effects"]}
    tried = {c.key for c in choices.changes if c.kind != "level"}
    assert tried | {name.split()[0] for name in choices.untried} == effects
    values = {c.key: c.value for c in choices.changes if c.kind == "off"}
    assert values == {"dynamics": "false", "fault": "[]"}
    levels = {c.value for c in choices.changes if c.key == "fidelity.accelerator"}
    assert levels == {"untimed", "approximately-timed", "cycle-accurate"}


def test_what_an_effect_needs_comes_and_goes_with_it(program: Program) -> None:
    reference = program.reference
    choices = changes_of(reference, ["device.dynamics", "hand"], {"bus": "approximately-timed"})
    by_name = {change.name: change for change in choices.changes}
    off = with_needs(by_name["device.dynamics off"], reference, ["device.dynamics", "hand"], {})
    assert [c.name for c in off.along] == ["hand off"]
    dac = with_needs(by_name["device.dac on"], reference, [], {})
    assert [c.name for c in dac.along] == ["device.motor on", "device.amplifier on"]
    level = with_needs(by_name["fidelity.bus untimed"], reference, ["bus.traffic"], {})
    assert [c.name for c in level.along] == ["bus.traffic off"]


def test_the_thesis_keeps_all_and_drops_the_reference_when_unasked(
    kept: Session, scenarios: Path, tmp_path: Path
) -> None:
    scenario, settings = scenarios / "thesis.toml", (*SMALL, "frames=250")
    found = screen(kept, scenario, *settings)
    assert found.exercised.contact > 0
    assert found.recommendation.changes == ()
    unasked = screen(kept, scenario, *settings, tolerances="accuracy=any")
    assert [c.name for c in unasked.recommendation.changes] == ["reference off"]
    assert unasked.recommendation.influence.lost == ("accuracy",)
    # Comparing takes no simulated time and touches no word.
    pd.testing.assert_frame_equal(
        found.base.frames.drop(columns="flags"),
        unasked.recommendation.run.frames.drop(columns="flags"),
    )
    verify(kept, scenario, tmp_path, unasked, *settings)


def test_the_shared_bus_loses_its_card_only_for_a_wider_tolerance(
    kept: Session, scenarios: Path, tmp_path: Path
) -> None:
    scenario, settings = (
        scenarios / "shared-bus.toml",
        (*SMALL, "object.mesh.nodes=100", "frames=200"),
    )
    found = screen(kept, scenario, *settings, tolerances="latency=1%")
    assert found.exercised.contact > 0
    assert "bus.traffic off" not in [c.name for c in found.recommendation.changes]
    (card,) = [one for one in found.ones if one.change.name == "bus.traffic off"]
    assert card.influence is not None and card.influence.latency is not None
    assert WIDE["least"] < card.influence.latency < WIDE["most"]
    wide = screen(kept, scenario, *settings, tolerances="latency=10%")
    names = [c.name for c in wide.recommendation.changes]
    assert {"bus.traffic off", "bus.protocol off", "fidelity.bus loosely-timed"} <= set(names)
    assert wide.recommendation.influence.score(read_tolerances(["latency=10%"])) <= 1
    assert "fidelity.accelerator untimed" in wide.recommendation.rejected
    verify(kept, scenario, tmp_path, wide, *settings)


def test_a_closed_loop_keeps_its_device_and_hand(
    kept: Session, scenarios: Path, tmp_path: Path
) -> None:
    scenario = scenarios / "wall-in-hand.toml"
    settings = ("frames=800", "device.limits=true")
    found = screen(kept, scenario, *settings)
    assert found.base.closed and found.exercised.contact > 0 and found.exercised.reversals > 0
    # A limit that is nowhere reached can go; what the hand and the mass do cannot.
    assert [c.name for c in found.recommendation.changes] == ["device.limits off"]
    assert {"hand off", "device.dynamics off"} <= set(found.recommendation.rejected)
    (delay,) = [one for one in found.ones if one.change.name == "host.delay on"]
    assert delay.influence is not None and "+limit-cycle" in delay.influence.flags
    verify(kept, scenario, tmp_path, found, *settings)


def test_what_a_run_did_not_exercise_is_not_called_idle(kept: Session, scenarios: Path) -> None:
    # Forty frames end before the probe arrives.
    settings = (*SMALL, "frames=40", "reference=false", "contact.fresh=true")
    found = screen(kept, scenarios / "thesis.toml", *settings)
    assert found.exercised.contact == 0
    idle = {one.change.name: one.idle for one in found.ones if one.idle}
    assert idle["contact.fresh off"] == "no frame in contact"
    assert found.recommendation.rejected["contact.fresh off"].startswith("not exercised")
    assert "contact.fresh off" not in [c.name for c in found.recommendation.changes]


def test_what_can_go_alone_but_not_together(kept: Session, scenarios: Path) -> None:
    settings = (
        *("frames=300", "fidelity.host=loosely-timed"),
        *("host.jitter=true", "host.wake_up=true"),
    )
    others = ",".join(f"{answer}=any" for answer in ANSWERS if answer != "latency")
    found = screen(kept, scenarios / "wall-in-hand.toml", *settings, tolerances=others)
    alone = {o.change.name: o.influence for o in found.ones if o.change.kind == "off"}
    tolerance = 0.0
    for name in ("host.jitter off", "host.wake_up off"):
        moved = alone[name]
        assert moved is not None and moved.latency is not None and moved.p99 is not None
        tolerance = max(tolerance, moved.latency, moved.p99)
    # Without both nothing is left of the latency.
    assert tolerance < 1
    told = f"{others},latency={tolerance}"
    best = screen(kept, scenarios / "wall-in-hand.toml", *settings, tolerances=told).recommendation
    gone = {"host.jitter off", "host.wake_up off"} & {c.name for c in best.changes}
    assert len(gone) == 1
    assert best.influence.score(read_tolerances([told])) <= 1


def test_occasions() -> None:
    still = Exercise(frames=10, contact=0, moving=0, reversals=0, struck=0, late=0)
    assert not_exercised("device.friction", (still,)) == "the motion never reversed"
    assert not_exercised("fault", (still,)) == "no fault struck"
    assert not_exercised("bus.traffic", (still,)) == ""
    turned = Exercise(frames=10, contact=0, moving=9, reversals=1, struck=0, late=0)
    assert not_exercised("device.friction", (still, turned)) == ""


def test_influence_of_a_known_difference(kept: Session, scenarios: Path) -> None:
    run = Screener(kept, scenarios / "wall-in-hand.toml", (f"frames={FRAMES}",), {})._base()
    frames = run.frames.astype({"fx_N": float})
    largest = float((run.force**2).sum(axis=1).max() ** 0.5)  # type: ignore[operator]
    frames.loc[[300], "fx_N"] += largest / 4
    other = Answers(run.record, frames, run.effects, run.struck, run.spectral)
    found = influence(run, other)
    assert found.force == pytest.approx(0.25)
    assert found.force_rms == pytest.approx(0.25 / 20)  # one frame of 400
    assert found.latency == 0 and found.flags == () and found.lost == ()
    assert found.score(dict.fromkeys(ANSWERS, 0.25)) == pytest.approx(1)
    assert exercise(run).frames == FRAMES


@pytest.mark.parametrize("text", ["latency", "latency=-1", "speed=1%", "force=x", "force=nan"])
def test_a_tolerance_that_is_none(text: str) -> None:
    with pytest.raises(InputError, match="expected"):
        read_tolerances([text])


def test_the_command_writes_what_it_prints(
    program: Program,
    scenarios: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    command = ["study", "screen", str(scenarios / "wall-in-hand.toml"), "--set", "frames=300"]
    command += ["--store", str(tmp_path / "store"), "--pairs", "0", "--repeats", "1"]
    assert main([*command, "--out", str(tmp_path / "a")]) == 0
    text = capsys.readouterr().out
    # What is as it was is no faster, whatever two runs of it took.
    assert "Recommended: the scenario as it is" in text and "times as fast" not in text
    assert main([*command, "--out", str(tmp_path / "b"), "--repeats", "0"]) == 0
    files = {"results.csv", "results.parquet", "report.html", "recommended.toml"}
    assert {path.name for path in (tmp_path / "b").iterdir()} == files
    for name in files - {"report.html"}:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    tomllib.loads((tmp_path / "a" / "recommended.toml").read_text())


def test_a_scenario_that_is_not_there(
    program: Program,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("HVP_PROGRAM", str(program.path))
    assert (
        main(["study", "screen", str(tmp_path / "no.toml"), "--out", str(tmp_path / "out")])
        == WRONG_INPUT
    )
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "out").exists()
