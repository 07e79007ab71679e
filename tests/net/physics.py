"""Laws of physics. Powers of two change no digit of a binary number, so that most of them are
exact to the last bit, on the board's words too; where one is not, its tolerance has its reason."""

import math
import random
import re
from collections.abc import Iterator
from pathlib import Path

from deformation_step import array
from drawing import Scenario, quantity, vector
from laws import Law, first_difference, setting
from run_files import Frame, Run


def times(value: str, factor: float) -> str:
    """Each number of the value."""

    def scaled(found: re.Match[str]) -> str:
        return repr(float(found[0]) * factor)

    return re.sub(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?=[ \"\],]|$)", scaled, value)


def scaled(scenario: Scenario, factors: dict[str, tuple[float, str]]) -> Scenario:
    """Each of the keys times its factor; one that is not there gets its default times that."""
    changed = scenario.copy()
    for name, (factor, default) in factors.items():
        value = changed.values.get(name, default)
        if value:
            changed.values[name] = times(value, factor)
    return changed


def in_lists(scenario: Scenario, factors: dict[str, float]) -> None:
    for listed, items in scenario.lists.items():
        for item in items:
            for name in item:
                factor = factors.get(f"{listed}.{name}")
                if factor is not None:
                    item[name] = times(item[name], factor)


# Twice would do, but for solver.matrix_scaling, which takes the root of the diagonal.
STIFFER = 4


def stiffer(_: random.Random, scenario: Scenario, __: Run) -> Scenario | None:
    """As many times E, density and all loads: the same motion under as many times the forces. A
    diagonal of one has no unit and does not grow."""
    if scenario.values.get("contact.diagonal") == '"one"':
        return None
    changed = scaled(
        scenario,
        {
            "object.material.young_modulus": (STIFFER, '"10 kPa"'),
            "object.material.density": (STIFFER, '"1000 kg/m3"'),
            "contact.release_force": (STIFFER, ""),
        },
    )
    in_lists(changed, {"loads.point.force": STIFFER, "loads.pressure.pressure": STIFFER})
    return changed


FORCES = slice(11, 15)  # columns of frames.csv


def as_many_times_the_force(before: Run, after: Run) -> Iterator[str]:
    """To the last bit, and all else the same."""
    one = [line.split(",") for line in before.text("frames.csv").splitlines()]
    other = [line.split(",") for line in after.text("frames.csv").splitlines()]
    if len(one) != len(other):
        yield f"frames.csv has {len(one)} lines, then {len(other)}"
    for a, b in zip(one[1:], other[1:], strict=False):
        if a[: FORCES.start] + a[FORCES.stop :] != b[: FORCES.start] + b[FORCES.stop :]:
            yield first_difference("frames.csv", ",".join(a), ",".join(b))
            return
        for old, new in zip(a[FORCES], b[FORCES], strict=True):
            if old and STIFFER * float(old) != float(new):
                yield f"frame {a[0]}: a force of {old} N became {new} N, not {STIFFER} times that"
                return


# On the host the solution is exact to rounding, and none of these tables belongs to it.
OF_THE_BOARD = ("accelerator", "transfer", "refinement", "fault", "bus.pcie", "solver")


def on_the_host(_: random.Random, scenario: Scenario) -> Scenario:
    changed = scenario.copy()
    for name in (*OF_THE_BOARD, "fidelity.accelerator", "fidelity.numbers", "output.waveform"):
        changed.take_out(name)
    changed.values["host.solver"] = '"cholesky"'
    return changed


LENGTHS = (
    "object.mesh.size",
    "object.mesh.radius",
    "contact.patch_radius",
    "probe.start",
)
PLACED = (
    "object.anchor.",
    "loads.pressure.region.",
    "loads.prescribed.region.",
    "loads.point.",
    "loads.prescribed.",
)
PLACES = ("position", "displacement", "point", "low_corner", "high_corner", "centre", "radius")


def twice_as_large(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    """Twice all lengths at the same E: four times the force. A quarter of the density keeps the
    time in which the body swings; its weight then needs twice the gravity."""
    factors = dict.fromkeys(LENGTHS, (2.0, ""))
    factors["object.material.density"] = (1 / 4, '"1000 kg/m3"')
    factors["contact.release_force"] = (4, "")
    if scenario.values["object.mesh.shape"] == '"surface"':
        factors["object.mesh.surface_unit"] = (2, '"1 mm"')
    if "loads.gravity" in scenario.effects:
        standard = '["0 m/s2", "0 m/s2", "-9.80665 m/s2"]'
        factors["loads.gravity.acceleration"] = (2, standard)
    if "device.encoder" in scenario.effects:
        factors["device.encoder.resolution"] = (2, '"55 um"')
    changed = scaled(scenario, factors)
    lengths = {prefix + name: 2.0 for prefix in PLACED for name in PLACES}
    in_lists(changed, lengths | {"probe.motion.to": 2, "loads.point.force": 4})
    return changed


# The tip is read in whole nanometres, of at least 0.2 mm of a press; in a dynamic body what is
# rounded off it shakes the held nodes.
STATIC_REL = 1e-4
DYNAMIC_REL = 1e-2


def largest(frames: list[Frame]) -> float:
    return max((math.hypot(*frame.force) for frame in frames if frame.force), default=0.0)


def four_times_the_force(before: Run, after: Run) -> Iterator[str]:
    scale = 4 * largest(before.frames)
    tolerance = DYNAMIC_REL if "dynamics" in before.settings else STATIC_REL
    for old, new in zip(before.frames, after.frames, strict=False):
        if old.contact_node != new.contact_node:
            yield f"frame {old.number}: contact {old.contact_node} became {new.contact_node}"
            return
        if old.force is None or new.force is None:
            continue
        off = math.dist([4 * f for f in old.force], new.force)
        if off > tolerance * scale:
            yield f"frame {old.number}: {old.force} N became {new.force} N, not four times that"
            return


# Nothing touches: what the loads alone do.


def untouched(rng: random.Random, scenario: Scenario) -> Scenario:
    """The probe stays away, and there are loads."""
    changed = scenario.copy()
    away = vector((0.0, 0.0, 1.0))
    changed.values["probe.start"] = away
    hold = {"phase": '"hold"', "to": away, "duration": '"1 s"'}
    changed.lists["probe.motion"] = [hold]
    changed.values["output.deformation_every_frames"] = "20"
    down = tuple(round(rng.uniform(-5, 5), 4) for _ in range(3))
    changed.values["loads.gravity.acceleration"] = vector(down, "acceleration")
    changed.effects.add("loads.gravity")
    if changed.values.get("fidelity.numbers") == '"none"':
        changed.take_out("fidelity.numbers")
    # What wraps or starts somewhere else by what it has seen is not the same both ways.
    changed.take_out("solver.overflow")
    changed.take_out("fault")
    return changed


def opposite_loads(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    changed = scaled(scenario, {"loads.gravity.acceleration": (-1, "")})
    keys = ("loads.point.force", "loads.pressure.pressure", "loads.prescribed.displacement")
    in_lists(changed, dict.fromkeys(keys, -1.0))
    return changed


def steps(run: Run) -> list[Path]:
    return sorted(run.folder.glob("deformation_*.vtu"))


def opposite_displacement(before: Run, after: Run) -> Iterator[str]:
    """To the last bit: words have a sign and a magnitude as far as rounding goes."""
    for one, other in zip(steps(before), steps(after), strict=True):
        pairs = zip(array(one, "displacement"), array(other, "displacement"), strict=True)
        for at, (a, b) in enumerate(pairs):
            if a != -b:
                yield f"{one.name}: component {at % 3} of node {at // 3}, {a} m, became {b} m"
                return


# A press that ends in rest: the force is that of the place, however it came to be.


def pressed_and_held(rng: random.Random, scenario: Scenario) -> Scenario:
    """Straight down on the flat top of a box without loads, static, then half of the time still."""
    changed = scenario.copy()
    for name in ("dynamics", "loads", "fault", "device.encoder", "host.pipeline_depth"):
        changed.take_out(name)
    for name in ("contact.release_force", "contact.grip", "object.mesh", "fidelity.numbers"):
        changed.take_out(name)
    half = [rng.uniform(20e-3, 60e-3) for _ in range(3)]
    x, y = (rng.uniform(-0.4, 0.4) * half[axis] for axis in (0, 1))
    deep = rng.uniform(0.02, 0.06) * min(half)
    below = quantity(-half[2] * rng.uniform(0.4, 0.8), "length")
    changed.values |= {
        "object.mesh.shape": '"box"',
        "object.mesh.nodes": str(rng.randint(60, 160)),
        "object.mesh.size": vector(tuple(2 * h for h in half)),
        "budget.period": '"2 ms"',
        "frames": "160",
        "host.graphics.rate": '"100 Hz"',
        "host.graphics.drawing_time": '"1 ms"',
        "contact.hand_over": '"20 ms"',
        "probe.start": vector((x, y, half[2])),
        "output.deformation_every_frames": "150",
    }
    bottom = {"kind": '"half-space"', "point": f'["0 m", "0 m", {below}]', "normal": "[0, 0, 1]"}
    changed.lists["object.anchor"] = [bottom]
    press = {"phase": '"press"', "to": vector((x, y, half[2] - deep)), "duration": '"100 ms"'}
    changed.lists["probe.motion"] = [press]
    return changed


def pressed_on_the_host(rng: random.Random, scenario: Scenario) -> Scenario:
    return on_the_host(rng, pressed_and_held(rng, scenario))


def another_rate(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    changed = setting(scenario, host__graphics__rate=quantity(rng.uniform(25, 1000), "frequency"))
    changed.values["host.graphics.drawing_time"] = quantity(rng.uniform(0, 1e-3), "time")
    return changed


REST_REL = 1e-6  # sums in another order


def same_at_rest(before: Run, after: Run) -> Iterator[str]:
    old, new = before.frames[-1], after.frames[-1]
    if old.force is None or new.force is None:
        return
    if old.contact_node < 0:
        yield "there is no contact at rest"
    once = before.summary["contact"]["changes"] == after.summary["contact"]["changes"] == 1
    if not once:  # where it slides to hangs on what the board had found until there
        return
    if old.contact_node != new.contact_node:
        yield f"at rest the contact is {old.contact_node}, then {new.contact_node}"
    elif math.dist(old.force, new.force) > REST_REL * math.hypot(*old.force):
        yield f"at rest the force is {old.force} N, then {new.force} N"


# What not every level has.
ONE_LEVEL = (
    "bus.protocol",
    "bus.traffic",
    "bus.graphics_traffic",
    "host.jitter",
    "host.wake_up",
    "output.waveform",
    "solver.stop_residual",
)


def pressed_on_the_board(rng: random.Random, scenario: Scenario) -> Scenario:
    """Each solve from zero: the words then know nothing of the frames before."""
    changed = pressed_and_held(rng, scenario)
    for name in ("host.solver", "refinement", "accelerator.several", "solver.method", *ONE_LEVEL):
        changed.take_out(name)
    changed.values["solver.start"] = '"zero"'
    return changed


def another_fidelity(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    """Each job gives the same words at every level."""
    levels = {
        "fidelity.accelerator": ("untimed", "loosely-timed", "approximately-timed"),
        "fidelity.bus": ("untimed", "loosely-timed", "approximately-timed"),
        "fidelity.host": ("untimed", "loosely-timed"),
    }
    changed = scenario.copy()
    changed.values |= {name: f'"{rng.choice(choices)}"' for name, choices in levels.items()}
    return changed


# The board against the host's own solver, in double precision.


GOOD_WORDS = 2 / 3  # the share of scenarios whose words and iterations are enough


def compared_with_the_host(rng: random.Random, scenario: Scenario) -> Scenario:
    """Static, and nothing takes time but the converters, so that both see the same tips."""
    changed = scenario.copy()
    for name in ("dynamics", "fault", "host", "bus", "fidelity", "transfer", "accelerator.several"):
        changed.take_out(name)
    for part in ("accelerator", "bus", "host"):
        changed.values[f"fidelity.{part}"] = '"untimed"'
    for name in ("host.graphics.rate", "host.graphics.drawing_time"):
        if name in scenario.values:
            changed.values[name] = scenario.values[name]
    if rng.random() < GOOD_WORDS:
        changed.take_out("solver")
        changed.take_out("refinement")
        changed.values["solver.method"] = rng.choice(('"cg"', '"jacobi-pcg"'))
        changed.values["solver.vector_bits"] = str(rng.randint(18, 28))
        changed.values["solver.matrix_bits"] = str(rng.randint(14, 24))
        changed.values["solver.matrix_scaling"] = '"diagonal"'
        changed.values["accelerator.device"] = '"AGI027"'
    changed.effects.add("reference")
    changed.values["reference.every_frames"] = "1"
    changed.values["output.deformation_every_frames"] = "1"
    return changed


def solved_by_the_host(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    return on_the_host(rng, scenario)


# The two do the same sums in another order.
REPORT_REL = 1e-6
REPORT_ABS = 1e-12


def distances(pairs: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> tuple[float, float]:
    """Mean and worst of the distance from the second, as `accuracy` counts them: over what is not
    zero, relative to the largest."""
    scale = max((math.hypot(*exact) for _, exact in pairs), default=0.0)
    off = [math.dist(found, exact) for found, exact in pairs if any(found) or any(exact)]
    if not off or scale == 0:
        return 0.0, 0.0
    return sum(off) / len(off) / scale, max(off) / scale


def agrees_with_the_report(before: Run, after: Run) -> Iterator[str]:
    """What the run says of its own error is its distance from the host's solution. That is exact
    as long as no contact begins on a body that is displaced already: the place that it then takes
    hangs on what the board had found until there, and each such contact adds as much again."""
    pairs = list(zip(before.frames, after.frames, strict=True))
    if any((old.contact_node, old.tip) != (new.contact_node, new.tip) for old, new in pairs):
        return
    accuracy, flags = before.summary["accuracy"], before.summary["stability"]["flags"]
    changes = before.summary["contact"]["changes"]
    both = list(zip(steps(before), steps(after), strict=True))
    u = [(array(old, "displacement"), array(new, "displacement")) for old, new in both]
    forces = [(old.force or (), new.force or ()) for old, new in pairs]
    untouched_until = next((f.number for f in before.frames if f.contact_node >= 0), len(u))
    loaded = any(any(found) for found, _ in u[:untouched_until])
    said = {
        name: (accuracy[f"{name}_rel"] or 0.0, accuracy[f"{name}_worst_rel"] or 0.0)
        for name in ("displacement", "force")
    }
    room = (1 + changes) * (said["displacement"][1] + said["force"][1])
    for name, found in (("displacement", distances(u)), ("force", distances(forces))):
        for what, reported, distance in zip(("mean", "worst"), said[name], found, strict=True):
            exact = changes <= 1 and (changes == 0 or not loaded)
            off = abs(distance - reported) > REPORT_REL * distance + REPORT_ABS
            if (exact and off) or (not exact and not flags and distance > room + REPORT_ABS):
                yield f"{what} error of the {name}: reported {reported}, from the host {distance}"


HOST = ("host.solver",)
LEVELS = ("fidelity.accelerator", "fidelity.bus", "fidelity.host")
PHYSICS = (
    Law("stiffness", stiffer, as_many_times_the_force),
    Law("lengths", twice_as_large, four_times_the_force, prepare=on_the_host, keeps=HOST),
    Law("opposite", opposite_loads, opposite_displacement, prepare=untouched),
    Law("rate", another_rate, same_at_rest, prepare=pressed_on_the_host, keeps=HOST),
    Law(
        "fidelity",
        another_fidelity,
        same_at_rest,
        prepare=pressed_on_the_board,
        may_be_refused=True,
        keeps=("solver.start",),
    ),
    Law(
        "host",
        solved_by_the_host,
        agrees_with_the_report,
        prepare=compared_with_the_host,
        keeps=LEVELS,
    ),
)
