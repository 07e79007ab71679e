"""A press that ends in rest: the force is that of the place, however it came to be."""

import math
import random
from collections.abc import Iterator

from laws import Law, glides, setting
from physics import HOST, on_the_host
from run_files import Run
from scenario import Scenario, quantity, vector


def pressed_and_held(rng: random.Random, scenario: Scenario) -> Scenario:
    """Straight down on the flat top of a box without loads, static, then half of the time still."""
    changed = scenario.copy()
    for name in ("dynamics", "loads", "fault", "device.encoder", "host.pipeline_depth"):
        changed.take_out(name)
    for name in ("contact.release_force", "contact.grip", "object.mesh", "object.region"):
        changed.take_out(name)
    changed.take_out("fidelity.numbers")
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
        "probe.start": vector((x, y, half[2])),
        "output.deformation_every_frames": "150",
    }
    if not glides(changed):
        changed.values["contact.hand_over"] = '"20 ms"'
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


# A grip keeps the sideways distance of the moment in which contact was found, and that moves.
REST_REL = 1e-3
LEAST_FRAMES = 80  # of 160


def same_at_rest(before: Run, after: Run) -> Iterator[str]:
    old, new = before.frames[-1], after.frames[-1]
    if old.force is None or new.force is None:
        return
    if len(before.frames) < LEAST_FRAMES:  # a link so slow that a frame takes many periods
        return
    if old.contact_node < 0:
        # A collision process that never gets the core finds nothing, and the run says so.
        if "contact-missed" not in before.summary["stability"]["flags"]:
            yield "there is no contact at rest"
        return
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


REST = (
    Law("rate", another_rate, same_at_rest, prepare=pressed_on_the_host, keeps=HOST),
    Law(
        "fidelity",
        another_fidelity,
        same_at_rest,
        prepare=pressed_on_the_board,
        may_be_refused=True,
        keeps=("solver.start",),
    ),
)
