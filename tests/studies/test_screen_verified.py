"""A screening's figures by a second way, and what would let a wrong recommendation through."""

import csv
import json
import math
import subprocess
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
from test_screen import FRAMES, SMALL, screen

from studies.commands.screen import read_tolerances
from studies.errors import StudyError
from studies.screening.answers import ANSWERS, influence
from studies.screening.scenario_file import scenario_text
from studies.screening.screen import Screener
from studies.session import Session


def test_an_influence_is_what_two_plain_runs_differ_by(
    kept: Session, scenarios: Path, tmp_path: Path
) -> None:
    scenario = scenarios / "shared-bus.toml"
    settings = (*SMALL, "object.mesh.nodes=100", "frames=200")
    found = screen(kept, scenario, *settings, tolerances="latency=1%")
    (card,) = [one.influence for one in found.ones if one.change.name == "bus.traffic off"]
    assert card is not None
    frames = []
    for name, more in (("with", ()), ("without", ("bus.traffic=false",))):
        told = [word for setting in (*settings, *more) for word in ("--set", setting)]
        command = [str(kept.program.path), "run", str(scenario), *told, "--quiet"]
        command += ["--set", "output.pictures=false", "--out", str(tmp_path / name)]
        subprocess.run(command, check=False, capture_output=True)
        with (tmp_path / name / "frames.csv").open(encoding="utf-8") as file:
            frames.append(list(csv.DictReader(file)))
    less = []
    for column in ("latency_us", "load_us"):
        one, other = (max(float(frame[column]) for frame in run) for run in frames)
        less.append((one - other) / one)
    assert card.latency == pytest.approx(max(less), rel=1e-4)
    forces = [[[float(f[f"f{axis}_N"]) for axis in "xyz"] for f in run] for run in frames]
    apart = max(math.dist(one, other) for one, other in zip(*forces, strict=True))
    largest = max(math.hypot(*force) for force in forces[0])
    assert card.force == pytest.approx(apart / largest, abs=1e-6)


def test_stability_is_what_the_command_of_that_name_finds(kept: Session, scenarios: Path) -> None:
    scenario, settings = scenarios / "wall-in-hand.toml", ("frames=800", "device.limits=true")
    found = screen(kept, scenario, *settings)
    (delay,) = [one for one in found.ones if one.change.name == "host.delay on"]
    assert delay.influence is not None and delay.influence.stability is not None
    stiffest = []
    for more in ((), ("--set", "host.delay=true")):
        command = [str(kept.program.path), "stability", str(scenario), "--json", *more]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        stiffest.append(json.loads(done.stdout)["stiffness_max"])
    lost = (stiffest[0] - stiffest[1]) / stiffest[0]
    # The delay takes a large part of the stiffness, which the screening has to see at the least.
    assert 0.1 < lost <= delay.influence.stability * (1 + 1e-9)
    assert found.base.figure("stiffness.stable_N_m") == pytest.approx(stiffest[0], rel=2e-3)
    assert delay.matters(read_tolerances([f"stability={lost * 0.9}"]))


@pytest.mark.parametrize("tolerance", ["0", "1e-12", "1", "1e300"])
def test_any_tolerance_ends_in_a_set_that_keeps_it(
    kept: Session, scenarios: Path, tolerance: str
) -> None:
    told = ",".join(f"{answer}={tolerance}" for answer in ANSWERS)
    scenario, settings = scenarios / "wall-in-hand.toml", ("frames=300", "device.limits=true")
    found = screen(kept, scenario, *settings, tolerances=told)
    assert found.recommendation.influence.score(read_tolerances([told])) <= 1
    # What takes an answer away is within no tolerance.
    assert found.recommendation.rejected["device.dynamics off"] == "no longer answers stability"


def test_a_file_that_is_not_what_was_judged_is_not_verified(
    kept: Session, scenarios: Path, tmp_path: Path
) -> None:
    scenario = scenarios / "wall-in-hand.toml"
    settings = ("frames=300", "device.limits=true")
    screener = Screener(kept, scenario, settings, read_tolerances([]))
    best = screener.screen(pairs=0).recommendation
    file = tmp_path / "recommended.toml"
    written = screener.settings_of(best.changes)
    file.write_text(scenario_text(scenario, tmp_path, "", written))
    screener.verify(file, best)
    for wrong, expected in (
        ("wall.stiffness=150 N/m", "not the one that was judged"),
        ("frames=299", "not the one that was judged"),
        ("wall.stiffness=-1 N/m", "refused"),
    ):
        file.write_text(scenario_text(scenario, tmp_path, "", [*written, wrong]))
        with pytest.raises(StudyError, match=expected):
            screener.verify(file, best)
    # The run that was judged, but not of the scenario that was asked about.
    other = Screener(kept, scenario, ("frames=300", "host.delay=true"), read_tolerances([]))
    file.write_text(scenario_text(scenario, tmp_path, "", written))
    with pytest.raises(StudyError, match="beyond its tolerance: not verified"):
        other.verify(file, best)


def test_every_probe_is_looked_at(kept: Session, scenarios: Path) -> None:
    run = Screener(kept, scenarios / "wall-in-hand.toml", (f"frames={FRAMES}",), {})._base()
    second = run.frames.filter(regex="^(f._N|tip_._m|port_J)$").add_prefix("probe1_")
    both = replace(run, frames=pd.concat([run.frames, second], axis=1))
    largest = float((run.force**2).sum(axis=1).max() ** 0.5)  # type: ignore[operator]
    way = float((run.tip.max() - run.tip.min()).max())
    energy = float(run.frames["port_J"].abs().max())
    for column, by, answer in (
        ("probe1_fy_N", largest, "force"),
        ("probe1_tip_z_m", way, "displacement"),
        ("probe1_port_J", energy, "stability"),
    ):
        frames = both.frames.astype({column: float})
        frames.loc[[FRAMES - 1], column] += by / 4
        found = influence(both, replace(both, frames=frames))
        assert getattr(found, answer) == pytest.approx(0.25), answer
    # A probe less is no force to be compared.
    assert "force" in influence(both, run).lost


def test_what_no_tolerance_can_be_given_for(kept: Session, scenarios: Path) -> None:
    run = Screener(kept, scenarios / "wall-in-hand.toml", (f"frames={FRAMES}",), {})._base()
    huge = dict.fromkeys(ANSWERS, 1e300)
    late = influence(run, replace(run, record=replace(run.record, status="not held")))
    assert late.score(huge) == math.inf
    assert late.why(huge) == "the budgets are then not held"
    assert late.score({**huge, "misses": None}) == 0
    flags = [*run.record.flags, "divergence"]
    flagged = influence(run, replace(run, record=replace(run.record, flags=flags)))
    assert flagged.score(huge) == math.inf
    assert flagged.why(huge) == "changes flags: +divergence"
    later = influence(run, replace(run, frames=run.frames.rename(index=lambda n: n + FRAMES)))
    assert later.why(huge) == "no longer answers force"
