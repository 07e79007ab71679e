"""A proxy or a patch is pressed into the top of a box, slides to and fro twice, and is lifted off:
what its force obeys whoever solves, at any rate, friction, encoder and latency."""

import itertools
import math
import random
from collections.abc import Iterator

from laws import Law
from run_files import Frame, Run
from scenario import Scenario, quantity, vector

STROKES = 4  # to and fro, twice
REST = 0.15  # s, between them
PRESS = 0.15  # s
PRESSING = 2  # of its segments: the press, and a rest
SPEED = (10e-3, 50e-3)  # m/s, at most in a stroke; docs/collision.md measures at 50 mm/s
HALF = 0.5
# Of half the top's width. On these meshes a patch is half of that wide itself.
REACH = {"proxy": 0.35, "patch": 0.15}
WITH_ENCODER = 0.3


def solved_by(rng: random.Random, scenario: Scenario) -> None:
    """The board, with or without refinement, or the host in double precision."""
    for name in ("host.solver", "solver", "refinement"):
        scenario.take_out(name)
    if rng.random() < HALF:
        scenario.values["host.solver"] = '"cholesky"'
        return
    scenario.values |= {
        "solver.method": rng.choice(('"cg"', '"jacobi-pcg"')),
        "solver.iterations": str(rng.randint(20, 60)),
        "solver.matrix_bits": "18",
        "solver.vector_bits": "24",
        "solver.displacement_range": '"40 mm"',
        "accelerator.device": '"EP2S180"',
    }
    if rng.random() < HALF:
        scenario.values["refinement.passes"] = str(rng.randint(1, 3))


def to_and_fro(rng: random.Random, _: Scenario) -> Scenario:
    """In the middle of the top, away from its rims."""
    half = [rng.uniform(25e-3, 50e-3) for _ in range(2)] + [rng.uniform(12e-3, 25e-3)]
    deep = rng.uniform(0.03, 0.12) * half[2]
    turn = rng.uniform(0, 2 * math.pi)
    kind = rng.choice(("proxy", "proxy", "patch"))
    reach = REACH[kind] * min(half[:2])
    # The fastest of a stroke of minimum jerk is 15/8 of its mean.
    stroke = 15 / 8 * 2 * reach / rng.uniform(*SPEED)
    period = rng.choice((1e-3, 2e-3, 3e-3))
    places = [
        (sign * reach * math.cos(turn) + 1e-3, sign * reach * math.sin(turn) + 0.7e-3)
        for sign in (-1, 1)
    ]
    top, below = half[2], half[2] - deep
    motion = [(places[0], below, PRESS), (places[0], below, REST)]
    for i in range(STROKES):
        motion += [(places[(i + 1) % 2], below, stroke), (places[(i + 1) % 2], below, REST)]
    motion.append((places[0], top + 2e-3, PRESS))
    frames = math.ceil(sum(duration for *_, duration in motion) / period)
    scenario = Scenario(
        {
            "frames": str(frames),
            "budget.period": quantity(period, "time"),
            "object.mesh.shape": '"box"',
            "object.mesh.size": vector(tuple(2 * h for h in half)),
            "object.mesh.nodes": str(rng.randint(120, 300)),
            "object.material.young_modulus": f'"{rng.uniform(5, 50):.4g} kPa"',
            "object.material.poisson_ratio": f"{rng.uniform(0.2, 0.45):.3g}",
            "contact.kind": f'"{kind}"',
            "contact.friction": rng.choice(("0", "0.1", "0.3", "1", "1e6")),
            "probe.start": vector((*places[0], top + 1e-3)),
            "probe.radius": f'"{rng.uniform(1, 5):.3g} mm"',
            "host.sustained_rate": f'"{rng.uniform(0.5, 4):.3g} Gflop/s"',
            "output.pictures": "false",
            "output.remedies": "false",
            "output.trace_frames": "0",
        }
    )
    scenario.effects.add("contact.fresh")
    if rng.random() < HALF:
        scenario.effects.add("dynamics")
    if rng.random() < WITH_ENCODER:
        scenario.values["device.encoder.resolution"] = f'"{rng.uniform(5, 60):.3g} um"'
    bottom = quantity(-0.6 * half[2], "length")
    scenario.lists["object.anchor"] = [
        {"kind": '"half-space"', "point": f'["0 m", "0 m", {bottom}]', "normal": "[0, 0, 1]"}
    ]
    scenario.lists["probe.motion"] = [
        {
            "phase": '"press"' if i < PRESSING else '"slide"',
            "to": vector((*place, depth)),
            "duration": quantity(duration, "time"),
        }
        for i, (place, depth, duration) in enumerate(motion)
    ]
    solved_by(rng, scenario)
    return scenario


def another_solver(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    changed = scenario.copy()
    solved_by(rng, changed)
    return changed


CONE_REL = 1e-9
# Of what was pressed in: the work is a sum of trapezia, and a body's mass has motion of its own.
MADE_REL = 0.01
CLOSED_REL = 0.02
SPAN_S = 0.03
FELT_REL = 0.10
NO_FORCE_N = 4e-4
GLIDES_REL = 1e-6
LEAST_DISSIPATING = 0.1


def normal(frame: Frame) -> float:
    """The top is flat, and away from its rims its normal is z."""
    assert frame.force is not None
    return frame.force[2]


def drag(frame: Frame) -> float:
    assert frame.force is not None
    return math.hypot(frame.force[0], frame.force[1])


def outside_of_cone(frames: list[Frame], friction: float) -> Iterator[str]:
    for frame in frames:
        over = drag(frame) - friction * normal(frame)
        if over > CONE_REL * max(normal(frame), NO_FORCE_N):
            yield f"frame {frame.number}: {drag(frame)} N of drag on {normal(frame)} N"
            return


def energy_made(frames: list[Frame]) -> Iterator[str]:
    """The hand's work on the body over the whole of it, which begins and ends without contact."""
    work = largest = 0.0
    for one, other in itertools.pairwise(frames):
        assert one.force is not None
        assert other.force is not None
        step = [b - a for a, b in zip(one.tip, other.tip, strict=True)]
        mean = [-(a + b) / 2 for a, b in zip(one.force, other.force, strict=True)]
        work += sum(f * d for f, d in zip(mean, step, strict=True))
        largest = max(largest, work)
    if work < -MADE_REL * largest:
        yield f"{-work} J were made, {largest} J pressed in"


def steps_on_the_way(frames: list[Frame], friction: float, period: float) -> Iterator[str]:
    """While it glides: without friction, in every frame."""
    span = round(SPAN_S / period)
    glides = [
        normal(f) > NO_FORCE_N and drag(f) >= (1 - GLIDES_REL) * friction * normal(f)
        for f in frames
    ]
    since = 0
    for i, frame in enumerate(frames):
        if not glides[i]:
            since = i + 1
        if i - since < span:
            continue
        some = [normal(f) for f in frames[i - span : i + 1]]
        if max(some) - min(some) > FELT_REL * max(some):
            yield f"frame {frame.number}: {min(some)} to {max(some)} N within 30 ms of gliding"
            return


def seconds(text: str) -> float:
    value, unit = text.split()
    return float(value) * {"s": 1.0, "ms": 1e-3, "us": 1e-6}[unit]


def obeyed(run: Run) -> Iterator[str]:
    settings = run.settings
    flags = run.summary["stability"]["flags"]
    period = seconds(settings["budget"]["period"])
    friction = float(settings["contact"]["friction"])
    frames = [frame for frame in run.frames if frame.status == "HVP_OK"]
    if len(frames) < int(settings["frames"]) or not any(
        frame.contact_node >= 0 for frame in frames
    ):
        yield f"{len(frames)} of {settings['frames']} frames, or no contact"
        return
    if "proxy-at-rim" in flags:
        yield "a slide in the middle came to a rim"
    yield from outside_of_cone(frames, friction)
    if friction >= LEAST_DISSIPATING:
        yield from energy_made(frames)
    if "encoder" in settings["device"]:
        return
    if friction <= 1 and "dynamics" not in settings:
        slide = frames[round((PRESS + REST) / period) : -round(PRESS / period)]
        yield from steps_on_the_way(slide, friction, period)
    probe = settings["probe"]
    motion = (probe[0] if isinstance(probe, list) else probe)["motion"]
    ends = [*itertools.accumulate(seconds(segment["duration"]) for segment in motion)]
    # The rest at the same place after the first and after the second time to and fro.
    first, second = (frames[round(ends[i] / period) - 2] for i in (5, 9))
    assert first.force is not None
    assert second.force is not None
    if math.dist(first.force, second.force) > CLOSED_REL * math.hypot(*second.force):
        yield f"after one lap the force is {first.force} N, after two {second.force} N"


def slides(before: Run, after: Run) -> Iterator[str]:
    yield from obeyed(before)
    yield from obeyed(after)
    if "dynamics" in before.settings:
        return
    # A static body's force knows nothing of who solves.
    for one, other in zip(before.frames, after.frames, strict=True):
        if one.force != other.force:
            yield f"frame {one.number}: {one.force} N, by another solver {other.force} N"
            return


SLIDES = (Law("slides", another_solver, slides, prepare=to_and_fro),)
