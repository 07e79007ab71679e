"""Draws closed loops before a wall and forms every check of a run again, from the run's own files
at every frame: the verdict has to be the same. Of linear loops `hvp stability` has to find what the
eigenvalues say.

Force, edge of stability and margin are computed here in another way than in the program: the wall's
law from the positions that were read, the loop's map by a matrix exponential.

    python3 tests/net/loops.py build/release/app/hvp --count 40 --seed 7
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from run_files import Run
from scipy.linalg import expm

STILL_M = 1e-4  # peak to peak, at rest by its size
MARGIN_TOLERANCE = 1e-3
STABILITY_TOLERANCE = 0.02
NO_FORCE_N = 4e-4
STIFFEST = 1e8  # N/m; beyond it nothing is a wall


def log_uniform(rng: random.Random, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


@dataclass(frozen=True)
class Loop:
    period_s: float
    mass_kg: float
    damping: float
    stiffness: float
    delay_s: float
    hand: tuple[float, float] | None  # N/m, N s/m
    friction: float  # N
    encoder_m: float
    limit: float  # N
    hold_s: float
    deep_m: float

    @property
    def linear(self) -> bool:
        return not (self.friction or self.encoder_m or self.limit)

    @property
    def frames(self) -> int:
        return math.ceil((0.6 + self.hold_s) / self.period_s)

    def text(self, base: Path) -> str:
        lines = [
            f'base = "{base}"',
            f"frames = {self.frames}",
            f'[budget]\nperiod = "{self.period_s * 1e3:.9g} ms"',
            f'[wall]\nstiffness = "{self.stiffness:.9g} N/m"\nsides = "one"',
            f'[device.dynamics]\nmass = "{self.mass_kg * 1e3:.9g} g"',
            f'damping = "{self.damping:.9g} N s/m"',
        ]
        if self.delay_s:
            lines.append(f'[host.delay]\ntime = "{self.delay_s * 1e3:.9g} ms"')
        if self.friction:
            lines.append(f'[device.friction]\nforce = "{self.friction:.9g} N"')
        if self.encoder_m:
            lines.append(f'[device.encoder]\nresolution = "{self.encoder_m * 1e3:.9g} mm"')
        if self.limit:
            lines.append(f'[device.limits]\nforce = "{self.limit:.9g} N"')
        if self.hand:
            stiffness, damping = self.hand
            lines.append('[hand]\nmodel = "custom"')
            lines.append(f'stiffness = "{stiffness:.9g} N/m"\ndamping = "{damping:.9g} N s/m"')
        to = f'["0 mm", "0 mm", "{-1e3 * self.deep_m:.9g} mm"]'
        lines.append('[probe]\nstart = ["0 mm", "0 mm", "10 mm"]')
        for phase, seconds in (("press", 0.6), ("hold", self.hold_s)):
            lines.append("[[probe.motion]]")
            lines.append(f'phase = "{phase}"\nto = {to}\nduration = "{seconds:.9g} s"')
        lines.append("[output]\npictures = false\nremedies = false\ntrace_frames = 0")
        return "\n".join(lines) + "\n"


def draw(rng: random.Random) -> Loop:
    period = rng.choice((0.25e-3, 0.5e-3, 1e-3, 2e-3, 4e-3))
    return Loop(
        period_s=period,
        mass_kg=log_uniform(rng, 0.05, 1.5),
        damping=log_uniform(rng, 0.3, 5),
        stiffness=log_uniform(rng, 100, 20000),
        delay_s=rng.choice((0.0, rng.uniform(0, 4 * period))),
        hand=(log_uniform(rng, 30, 1000), log_uniform(rng, 0.3, 10)),
        friction=rng.choice((0.0, 0.0, log_uniform(rng, 0.02, 0.5))),
        encoder_m=rng.choice((0.0, 0.0, log_uniform(rng, 5e-6, 1e-4))),
        limit=rng.choice((0.0, 0.0, 0.0, log_uniform(rng, 1, 10))),
        hold_s=rng.choice((0.3, 0.8, 1.6, 3.4)),
        deep_m=log_uniform(rng, 1e-3, 20e-3),
    )


@lru_cache(maxsize=4)  # of one loop at one delay: no stiffness changes it
def response(loop: Loop, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Of position and velocity after so many seconds, and to a constant force."""
    k, b = loop.hand or (0.0, 0.0)
    augmented = np.zeros((3, 3))
    augmented[0, 1] = 1
    augmented[1] = np.array([-k, -(loop.damping + b), 1]) / loop.mass_kg
    e = expm(augmented * seconds)
    return e[:2, :2], e[:2, 2]


def spectral_radius(loop: Loop, stiffness: float, delay_s: float) -> float:
    """Of the map from one sample to the next: the mass with its damper and the hand's, and the
    positions that forces still to come were made from."""
    whole = math.floor(delay_s / loop.period_s + 1e-12)
    rest = max(0.0, delay_s - whole * loop.period_s)

    before, force_before = response(loop, rest)
    after, force_after = response(loop, loop.period_s - rest)
    size = 2 + whole + 1
    step = np.zeros((size, size))
    step[:2, :2] = after @ before

    def read(age: int) -> int:
        return 0 if age == 0 else 1 + age

    step[:2, read(whole + 1)] -= stiffness * (after @ force_before)
    step[:2, read(whole)] -= stiffness * force_after
    step[2, 0] = 1
    for i in range(3, size):
        step[i, i - 1] = 1
    return float(np.abs(np.linalg.eigvals(step)).max())


def edge_of(loop: Loop, delay_s: float) -> float:
    """The stiffness up to which every loop is stable."""
    stable, at = 0.0, 1e-2
    while spectral_radius(loop, at, delay_s) < 1 + 1e-12:
        stable, at = at, at * 1.05
        if at > STIFFEST:
            return at
    while at - stable > 1e-6 * at:
        middle = 0.5 * (stable + at)
        if spectral_radius(loop, middle, delay_s) < 1 + 1e-12:
            stable = middle
        else:
            at = middle
    return stable


@dataclass(frozen=True)
class Seen:
    """What every frame of a run says."""

    force: np.ndarray  # N, as commanded, normal to the wall
    tip: np.ndarray  # m, likewise
    latency: np.ndarray  # s
    in_contact: np.ndarray
    fed_in: np.ndarray
    port: np.ndarray
    motor: np.ndarray  # N, the norm
    intended: np.ndarray  # m


def seen(run: Run) -> Seen:
    def column(name: str) -> np.ndarray:
        return np.array([float(row[name]) for row in run.rows])

    motor = np.stack([column(f"motor_{axis}_N") for axis in "xyz"])
    return Seen(
        force=column("fz_N"),
        tip=column("tip_z_m"),
        latency=1e-6 * column("latency_us"),
        in_contact=column("contact_node") >= 0,
        fed_in=column("fed_in") == 1,
        port=column("port_J"),
        motor=np.linalg.norm(motor, axis=0),
        intended=column("intended_z_m"),
    )


def same(what: str, said: object, found: object) -> Iterator[str]:
    if said != found:
        yield f"{what} is said to be {said}, and by all frames is {found}"


def near(what: str, said: float | None, found: float, tolerance: float) -> Iterator[str]:
    if said is None or abs(said - found) > tolerance * abs(found):
        yield f"{what} is said to be {said}, and by all frames is {found}"


def forces(loop: Loop, run: Run, s: Seen) -> Iterator[str]:
    read = np.array([float(row["z_m"]) for row in run.rows])
    wall = loop.stiffness * np.maximum(0.0, -read)
    off = np.abs(s.force - wall)
    worst = int(off.argmax())
    if off[worst] > 1e-8 * abs(wall[worst]) + 1e-9 * loop.stiffness:
        yield f"frame {worst} has {s.force[worst]} N where the wall gives {wall[worst]}"
    yield from same("contact.share", run.summary["contact"]["share"], float(s.in_contact.mean()))
    if loop.limit and s.motor.max() > loop.limit * (1 + 1e-8):
        yield f"the motors gave {s.motor.max()} N, and the maker's limit is {loop.limit} N"


def delays(s: Seen) -> np.ndarray:
    """Of the frames in contact in which the force changes."""
    before = np.concatenate([[np.nan], s.force[:-1]])
    moving = s.in_contact & (s.force != before)
    late: np.ndarray = s.latency[moving]
    return late


def margins(loop: Loop, run: Run, s: Seen) -> Iterator[str]:
    late = delays(s)
    stiffness = run.summary["stiffness"]
    if late.size == 0:
        yield from same("stiffness.margin", stiffness["margin"], None)
        return
    edge = edge_of(loop, float(late.max()))
    yield from near("stiffness.edge_N_m", stiffness["edge_N_m"], edge, MARGIN_TOLERANCE)
    yield from near(
        "stiffness.margin", stiffness["margin"], edge / loop.stiffness, MARGIN_TOLERANCE
    )


def at_rest(loop: Loop, s: Seen) -> str:
    """What the last quarters of a second of the hold say by the size of the motion."""
    begins = 0.6
    time = loop.period_s * np.arange(s.tip.size)
    tip = s.tip[time >= begins]
    quarter = max(32, math.ceil(0.25 / loop.period_s) + 1)
    if tip.size < 2 * quarter + 2:
        return "short"
    return "still" if np.ptp(tip[-quarter:]) <= STILL_M else "moving"


def flags(loop: Loop, run: Run, s: Seen) -> Iterator[str]:
    raised = run.summary["stability"]["flags"]
    yield from same("active-port", "active-port" in raised, bool(s.fed_in.any()))
    least = run.summary["loop"][0]["energy"]["port"]["least_J"]
    yield from near("the least at the port", least, min(0.0, float(s.port.min())), 1e-6)
    margin = run.summary["stiffness"]["margin"]
    low = margin is not None and margin < 1
    yield from same("low-gain-margin", "low-gain-margin" in raised, low)
    clamped = bool(loop.limit) and bool((np.abs(s.force) > loop.limit).any())
    yield from same("force-saturated", "force-saturated" in raised, clamped)
    begins = bool(s.in_contact[0]) and abs(s.force[0]) > NO_FORCE_N
    yield from same("force-step", "force-step" in raised, begins)
    if run.summary["verdict"] == "PASS" and at_rest(loop, s) != "still":
        yield f"PASS of a device that is {at_rest(loop, s)}"


def verdict(run: Run, s: Seen) -> str:
    summary = run.summary
    loop = summary["loop"][0]
    reasons = {
        "not held": not summary["held"],
        "held, with flags": bool(summary["stability"]["flags"]),
        "held; no contact": not s.in_contact.any(),
        "held; a device moves on": loop["moves_on_m_s"] is not None,
        "held; coming to rest not measured": not loop["oscillation_measured"],
        "held; gain margin not measured": summary["stiffness"]["margin"] is None,
    }
    return next((word for word, holds in reasons.items() if holds), "PASS")


def judged(loop: Loop, run: Run) -> Iterator[str]:
    s = seen(run)
    yield from same("frames", s.tip.size, loop.frames)
    yield from forces(loop, run, s)
    yield from margins(loop, run, s)
    yield from flags(loop, run, s)
    late = int((s.latency > loop.period_s * (1 + 1e-12)).sum())
    yield from same("deadline.misses", run.summary["deadline"]["misses"], late)
    yield from same("the verdict", run.summary["verdict"], verdict(run, s))


@dataclass(frozen=True)
class Asked:
    program: Path
    base: Path
    seed: int
    index: int


def hvp(program: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(program), *arguments], capture_output=True, text=True, check=False, timeout=300
    )


def look_at(asked: Asked) -> list[str]:
    rng = random.Random(f"loops {asked.seed} {asked.index}")
    loop = draw(rng)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "loop.toml"
        file.write_text(loop.text(asked.base), encoding="utf-8")
        out = Path(folder) / "out"
        ended = hvp(asked.program, "run", str(file), "--quiet", "--out", str(out))
        if ended.returncode not in (0, 1):
            return [f"{asked.index}: {ended.stderr.strip()}\n{file.read_text(encoding='utf-8')}"]
        complaints = list(judged(loop, Run(out, ended.returncode, ended.stdout, ended.stderr)))
        if loop.linear:
            found = hvp(asked.program, "stability", str(file), "--quiet", "--json")
            if found.returncode != 0:
                complaints.append(found.stderr.strip())
            else:
                complaints += stability(loop, json.loads(found.stdout))
        return [f"{asked.index}: {complaint}: {loop}" for complaint in complaints]


def stability(loop: Loop, found: dict[str, float | None]) -> Iterator[str]:
    edge = edge_of(loop, loop.delay_s)
    yield from near("stiffness_linear", found["stiffness_linear"], edge, MARGIN_TOLERANCE)
    if found["undecided_N_m"] is None:
        yield from near("stiffness_max", found["stiffness_max"], edge, STABILITY_TOLERANCE)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, help="one of them")
    arguments = parser.parse_args()
    base = Path(__file__).resolve().parents[2] / "scenarios" / "wall.toml"
    program = arguments.program.resolve()
    wanted = range(arguments.count) if arguments.only is None else [arguments.only]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        asked = [Asked(program, base, arguments.seed, index) for index in wanted]
        complaints = [line for found in pool.map(look_at, asked) for line in found]
    for complaint in complaints:
        print(complaint)
    print(f"{len(asked)} loops, {len(complaints)} complaints")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
